// Scenes in Node.js.

import "./index.node.js";

export * from "./scene.js";
