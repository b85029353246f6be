// Files that callers pass in: their bytes, and their names, whose extensions state the format.

import { HtexError, toBytes } from "./core.js";

/** Makes the error for an invalid argument. */
export function argument(text) {
  return new HtexError(text, "invalid-argument");
}

/** Returns the bytes and the name of a file: `{ name, bytes }`, a File, or a Blob with a name. */
export async function loaded(file) {
  if (typeof Blob !== "undefined" && file instanceof Blob) {
    if (typeof file.name !== "string") throw argument("a Blob has no name, which tells what kind of file it is; give { name, bytes }");
    return { name: file.name, bytes: new Uint8Array(await file.arrayBuffer()), isCopy: true };
  }
  return named(file);
}

/** Returns the bytes and the name of `{ name, bytes }`. */
export function named(file) {
  if (typeof file?.name !== "string" || file.bytes === undefined) {
    throw argument('a file is { name: "felt.csv", bytes }; calls that are awaited take a File or a Blob with a name, too');
  }
  return { name: file.name, bytes: bytesOf(file.bytes) };
}

export function bytesOf(data) {
  try {
    return toBytes(data);
  } catch (error) {
    throw argument(error.message);
  }
}

/** Returns the bytes of a texture's file: of a Texture, or of bytes. */
export function bytesOfTexture(texture) {
  return bytesOf(texture?.bytes ?? texture);
}

/** Returns the buffers of loaded files that nobody else uses, so that a worker may take them. */
export function copiesIn(files) {
  return files.flatMap(({ isCopy, bytes }) => (isCopy ? [bytes.buffer] : []));
}
