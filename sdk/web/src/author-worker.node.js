// The thread of Node.js that fits.

import { parentPort } from "node:worker_threads";

import { serveAuthor } from "./author-serve.js";

serveAuthor(parentPort);
