// The worker of a page that runs fits and imports.

import { serveAuthor } from "./author-serve.js";

serveAuthor(globalThis);
