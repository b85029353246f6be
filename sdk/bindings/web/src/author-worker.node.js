// The Node.js thread that fits models.

import { parentPort } from "node:worker_threads";

import { serveAuthor } from "./author-serve.js";

serveAuthor(parentPort);
