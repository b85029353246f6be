// The worker of a page that fits.

import { serveAuthor } from "./author-serve.js";

serveAuthor(globalThis);
