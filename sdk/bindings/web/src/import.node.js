// Imports and exports in Node.js.

import "./index.node.js";

export * from "./import.js";
