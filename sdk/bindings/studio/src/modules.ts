// Where the WASM modules are, and the scripts of workers: beside the page, or in it.

import { setAuthorLibrary, setLibrary } from "htex";
import { setImportLibrary } from "htex/import";
import { author, importer, library } from "virtual:modules";
import { authorWorker, guardedWorker } from "virtual:workers";

/** Names of the modules, and of the blocks of the page of one file that have them, compressed and as base64. */
const LIBRARY = "htex.wasm";
const AUTHOR = "htex-author.wasm";
const IMPORTER = "htex-import.wasm";

const absolute = (address: string) => new URL(address, location.href).href;

function block(name: string) {
  return document.getElementById(name)?.textContent ?? null;
}

async function inflated(text: string) {
  const bytes = Uint8Array.from(atob(text), (letter) => letter.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const source = async (name: string, address: string | undefined) => {
  const text = block(name);
  return text === null ? absolute(address ?? name) : inflated(text);
};

/** Sets the player's module. */
export async function setPlayer() {
  setLibrary(await source(LIBRARY, library), guardedWorker ? { worker: guardedWorker } : {});
}

const thread = () => {
  const script = authorWorker;
  return script ? { worker: () => new Worker(script, { type: "module" }) } : {};
};

/**
 * Sets the author's module. The single-file page has only the module of imports, which includes the
 * author's.
 */
export async function setAuthor() {
  setAuthorLibrary(await source(block(IMPORTER) === null ? AUTHOR : IMPORTER, author), thread());
}

/** Sets the module of imports. */
export async function setImporter() {
  setImportLibrary(await source(IMPORTER, importer), thread());
}

async function base64(stream: ReadableStream) {
  const all = new Uint8Array(await new Response(stream).arrayBuffer());
  let text = "";
  for (let at = 0; at < all.length; at += 0x8000) text += String.fromCharCode(...all.subarray(at, at + 0x8000));
  return btoa(text);
}

/** The player's module as the single-file page stores it. */
export async function compressedLibrary(): Promise<string> {
  const text = block(LIBRARY);
  if (text !== null) return text;
  const response = await fetch(absolute(library ?? LIBRARY));
  if (!response.ok || !response.body) throw new Error(`the player's module cannot be read: ${response.status}; reload the page`);
  return base64(response.body.pipeThrough(new CompressionStream("gzip")));
}

export const plainBase64 = (bytes: Uint8Array) => base64(new Blob([bytes as Uint8Array<ArrayBuffer>]).stream());
