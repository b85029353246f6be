// Textures of touch in the browser and in Node.js.

export { fit, loadAuthor, setAuthorLibrary } from "./author.js";
export { HtexError } from "./core.js";
export { Texture, Voice } from "./texture.js";
export { open, setLibrary } from "./library.js";
export { Library } from "./htexlib.js";
export { HtexNode, prepare } from "./node.js";
export { GuardedWorker } from "./guarded.js";
export { follow, followPointer } from "./pointer.js";
export { dualRumble, playOnPad } from "./pad.js";
