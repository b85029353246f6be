// The Node.js thread that runs fits and imports.

import { parentPort } from "node:worker_threads";

import { serveAuthor } from "./author-serve.js";

serveAuthor(parentPort);
