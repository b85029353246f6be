// The library: fetched and compiled once.

import { Core, toBytes } from "./core.js";
import { Texture } from "./texture.js";

let module;
let core;

/** Where the library is, unless `setLibrary` says otherwise. */
let source = () => new URL("./htex.wasm", import.meta.url);

/** Sets the library: its address, its bytes, or a WebAssembly.Module. Before the first `open`. */
export function setLibrary(library) {
  [source, module, core] = [() => library, undefined, undefined];
}

/** Compiles a module: its address, its bytes, or one that is compiled. */
export async function compiledFrom(library) {
  if (library instanceof WebAssembly.Module) return library;
  if (library instanceof ArrayBuffer || ArrayBuffer.isView(library)) return WebAssembly.compile(toBytes(library));
  const url = new URL(/* @vite-ignore */ library, import.meta.url);
  if (url.protocol === "file:") {
    const { readFile } = await import(/* @vite-ignore */ "node:fs/promises");
    return WebAssembly.compile(await readFile(url));
  }
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return WebAssembly.compile(await response.arrayBuffer());
}

/** The compiled library. */
export function compiled() {
  module ??= compiledFrom(source());
  return module;
}

/** The library in this thread. */
export function library() {
  core ??= compiled().then(async (compiledModule) => Object.assign(await Core.make(compiledModule), { module: compiledModule }));
  return core;
}

/** Opens a texture: its bytes, or its address. */
export async function open(source, options = {}) {
  const data = typeof source === "string" || source instanceof URL ? await download(source) : source;
  return opened(await library(), toBytes(data).slice(), options);
}

/** Opens the bytes of a texture, at once. */
export function opened(player, bytes, options = {}) {
  const texture = new Texture(player, bytes, options);
  const { modules = [], embedded = true } = options;
  const hasModules = modules.length > 0 || (embedded && (texture.manifest.plugins ?? []).length > 0);
  return Object.assign(texture, { bytes, options: { modules: modules.map((m) => toBytes(m).slice()), embedded }, hasModules });
}

async function download(source) {
  const url = new URL(source, globalThis.location?.href);
  const response = await fetch(url);
  if (!response.ok) throw new Error(`${url}: ${response.status} ${response.statusText}`);
  return response.arrayBuffer();
}
