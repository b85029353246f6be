// The worker of a page that runs fits, imports and exports.

import { serveAuthor } from "./author-serve.js";

serveAuthor(globalThis);
