// Where the WASM modules are, and the scripts of workers: beside the page, or in it.

import { setAuthorLibrary, setLibrary } from "htex";
import { setImportLibrary } from "htex/import";
import { author, importer, library } from "virtual:modules";
import { authorWorker, guardedWorker, readingWorker } from "virtual:workers";

/** Names of the modules, and of the blocks of the page of one file that have them, compressed and as text (`base85` of `parts.mjs`). */
const LIBRARY = "htex.wasm";
const AUTHOR = "htex-author.wasm";
const IMPORTER = "htex-import.wasm";

const absolute = (address: string) => new URL(address, location.href).href;

function block(name: string) {
  return document.getElementById(name)?.textContent ?? null;
}

/** The bytes of a block: five letters are four bytes, highest first; fewer letters at the end are one byte less than letters. */
function bytesOf(text: string) {
  const bytes = new Uint8Array(Math.floor((text.length * 4) / 5));
  for (let from = 0, to = 0; from < text.length; from += 5) {
    let group = 0;
    for (let i = from; i < from + 5; i++) {
      const code = i < text.length ? text.charCodeAt(i) : 119;
      group = group * 85 + (code === 122 ? 60 : code) - 35;
    }
    for (let shift = 24; shift >= 0 && to < bytes.length; shift -= 8) bytes[to++] = group >>> shift;
  }
  return bytes;
}

async function inflated(text: string) {
  const bytes = bytesOf(text);
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

const source = async (name: string, address: string | undefined) => {
  const text = block(name);
  return text === null ? absolute(address ?? name) : inflated(text);
};

/** Modules that are compiled here once, since a worker of the page uses them, too. */
const compiling = new Map<string, Promise<WebAssembly.Module>>();

async function compile(name: string, address: string | undefined) {
  const text = block(name);
  if (text !== null) return WebAssembly.compile(await inflated(text));
  const response = await fetch(absolute(address ?? name));
  if (!response.ok) throw new Error(`${name} cannot be read: ${response.status} ${response.statusText}; reload the page`);
  const isTyped = response.headers.get("content-type")?.startsWith("application/wasm");
  return isTyped ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
}

function compiled(name: string, address: string | undefined) {
  const module = compiling.get(name) ?? compile(name, address);
  compiling.set(name, module);
  module.catch(() => compiling.delete(name));
  return module;
}

/** Sets the player's module. */
export async function setPlayer() {
  setLibrary(await source(LIBRARY, library), guardedWorker ? { worker: guardedWorker } : {});
}

const thread = () => {
  const script = authorWorker;
  return script ? { worker: () => new Worker(script, { type: "module" }) } : {};
};

const compiledImporter = () => compiled(IMPORTER, importer);

/** The author's module. The single-file page has only the module of imports, which includes the author's. */
export const compiledAuthor = () => (block(IMPORTER) === null ? compiled(AUTHOR, author) : compiledImporter());

/** Sets the author's module. */
export async function setAuthor() {
  setAuthorLibrary(await compiledAuthor(), thread());
}

/** Sets the module of imports. */
export async function setImporter() {
  setImportLibrary(await compiledImporter(), thread());
}

/** Starts the worker that reads recordings. */
export function startReading() {
  return readingWorker ? new Worker(readingWorker, { type: "module" }) : new Worker(new URL("./reading-worker.ts", import.meta.url), { type: "module" });
}

export function base64(all: Uint8Array) {
  let text = "";
  for (let at = 0; at < all.length; at += 0x8000) text += String.fromCharCode(...all.subarray(at, at + 0x8000));
  return btoa(text);
}

/** The player's module as the page of a player has it: compressed, as base64. */
export async function compressedLibrary(): Promise<string> {
  const text = block(LIBRARY);
  if (text !== null) return base64(bytesOf(text));
  const response = await fetch(absolute(library ?? LIBRARY));
  if (!response.ok || !response.body) throw new Error(`the player's module cannot be read: ${response.status}; reload the page`);
  const stream = response.body.pipeThrough(new CompressionStream("gzip"));
  return base64(new Uint8Array(await new Response(stream).arrayBuffer()));
}
