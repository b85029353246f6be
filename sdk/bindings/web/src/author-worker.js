// The worker of a page that fits models.

import { serveAuthor } from "./author-serve.js";

serveAuthor(globalThis);
