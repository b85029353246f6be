// The WASM library, which is fetched and compiled once.

import { Core, HtexError, toBytes } from "./core.js";
import { host } from "./host.js";
import { Library } from "./htexlib.js";
import { OPEN, checked, signedBy } from "./options.js";
import { Texture } from "./texture.js";

/** Returns where the library is. `setLibrary` replaces this function. */
let source = () => new URL("./htex.wasm", import.meta.url);
/** Addresses of the worklet's file and the worker's file, if they are not next to this file. */
export const files = { processor: undefined, worker: undefined };

let module;
/**
 * The instances of the library in this thread: one that runs models in WASM modules, and one that
 * does not.
 */
let cores = {};

/**
 * Sets the library: its address, its bytes, or a WebAssembly.Module; and the addresses of
 * `processor.js` and `worker.js`.
 */
export function setLibrary(library, addresses = {}) {
  checked(addresses, { processor: "any", worker: "any" }, "setLibrary");
  if (library !== undefined) source = () => library;
  Object.assign(files, addresses);
  [module, cores] = [undefined, {}];
}

/** Downloads a file. `what` names it in errors. */
async function download(url, what) {
  let response;
  try {
    response = await fetch(url);
  } catch (error) {
    throw new HtexError(`${what} ${url} cannot be downloaded (${error.message}); check the address and the connection, and call again`, "io");
  }
  return received(response, `${what} ${url}`);
}

/** Refuses a response that has no body to be read. */
function received(response, what) {
  if (!response.ok) {
    const advice = response.status >= 500 ? "call again later" : "check the address";
    throw new HtexError(`${what}: the server answered ${response.status} ${response.statusText}; ${advice}`, "io");
  }
  if (response.bodyUsed) throw new HtexError(`${what}: the body of this Response was read already; give its bytes`, "invalid-argument");
  return response;
}

function isBytes(data) {
  return data instanceof ArrayBuffer || ArrayBuffer.isView(data);
}

/**
 * Converts an address that a caller passes in, or an address in this package, to a URL. This is a
 * function of its own because bundlers would treat a `new URL` with another base as one of their
 * own files.
 */
export function resolved(address) {
  return address instanceof URL ? address : new URL(address, globalThis.location?.href);
}

const isAddress = (source) => typeof source === "string" || source instanceof URL;

/** Returns the library's bytes, for threads that cannot receive a module. */
export function libraryBytes() {
  return moduleBytes(source(), "the library");
}

async function moduleBytes(library, what) {
  if (isBytes(library)) return toBytes(library);
  if (library instanceof WebAssembly.Module) {
    throw new HtexError("this browser gives no WebAssembly.Module to other threads; give setLibrary the address or the bytes of htex.wasm", "unsupported");
  }
  const url = resolved(library);
  if (url.protocol === "file:" && host.readFile) return host.readFile(url);
  return new Uint8Array(await (await download(url, what)).arrayBuffer());
}

/**
 * Compiles a module from its address or its bytes, or returns it if it is already compiled. If the
 * server states the WASM content type, it compiles while the module is still downloading. `what`
 * names the module in errors.
 */
export async function compiledFrom(library, what) {
  if (library instanceof WebAssembly.Module) return library;
  const url = isBytes(library) ? null : resolved(library);
  if (url && url.protocol !== "file:" && WebAssembly.compileStreaming) {
    const response = await download(url, what);
    const isTyped = /^application\/wasm\b/.test(response.headers.get("content-type") ?? "");
    return isTyped ? WebAssembly.compileStreaming(response) : WebAssembly.compile(await response.arrayBuffer());
  }
  return WebAssembly.compile(await moduleBytes(library, what));
}

/** Returns the compiled library. After a failure the next call tries again. */
export function compiled() {
  module ??= compiledFrom(source(), "the library").catch((error) => {
    module = undefined;
    throw error;
  });
  return module;
}

/** Returns the library in this thread. It runs models in WASM modules only if `trusted` is true. */
export function library({ trusted = false } = {}) {
  cores[trusted] ??= compiled()
    .then(async (compiledModule) => Object.assign(await Core.make(compiledModule, { runsModules: trusted }), { module: compiledModule }))
    .catch((error) => {
      delete cores[trusted];
      throw error;
    });
  return cores[trusted];
}

/** Makes a texture from its bytes, in a library that has been loaded. */
export function opened(core, bytes, { modules = [], embedded = true, trusted = false } = {}, signed = {}) {
  const options = { modules: modules.map((module) => toBytes(module).slice()), embedded, trusted };
  return Object.assign(new Texture(core, bytes, options, signed), { bytes });
}

/** Opens a texture from its bytes, a File, a Blob, a Response, or its address. */
export async function open(source, options = {}) {
  checked(options, OPEN, "open");
  const signed = signedBy(options, "open");
  // Both are fetched at the same time. If both fail, the first failure is reported.
  const [core, file] = await Promise.all([library(options), signedFile(source, signed)]);
  return opened(core, file.bytes, options, file.signed);
}

/**
 * Returns the bytes of a texture, and how they must be signed. Of a texture at an address, the
 * signature is fetched from the address with `.sig`, unless it was given.
 */
async function signedFile(source, signed) {
  if (!isAddress(source)) return { bytes: await bytesOf(source, "open"), signed };
  const url = addressOf(source, "open");
  // The signature of a texture's library was checked when the library was opened.
  if (isInLibrary(url)) return { bytes: await bytesAt(url, signed), signed: {} };
  if (!signed.onlySignedBy || signed.signature) return { bytes: await bytesAt(url), signed };
  const [bytes, signature] = await Promise.all([bytesAt(url), signatureAt(url)]);
  return { bytes, signed: { ...signed, signature } };
}

/** Largest size of a signature, bytes. */
const MOST_SIGNATURE = 4096;

/** Fetches the signature of a file; undefined if the server has none. */
export async function signatureAt(url, fetcher = fetch) {
  const address = new URL(url);
  address.pathname += ".sig";
  const response = await fetcher(address);
  if (response.status === 404) return undefined;
  const bytes = new Uint8Array(await received(response, `the signature ${address}`).arrayBuffer());
  // The reader refuses one byte more.
  return bytes.subarray(0, MOST_SIGNATURE + 1);
}

/** Copies the bytes that a caller passes in, in any of the forms that `open` accepts. */
export async function bytesOf(source, call) {
  if (isAddress(source)) return bytesAt(addressOf(source, call));
  if (isBytes(source)) return toBytes(source).slice();
  if (typeof Response !== "undefined" && source instanceof Response) {
    return new Uint8Array(await received(source, `${call}: ${source.url || "the response"}`).arrayBuffer());
  }
  if (isBlob(source)) return new Uint8Array(await source.arrayBuffer());
  const given = source === null ? "null" : (source?.constructor?.name ?? typeof source);
  const awaited = source instanceof Promise ? "; `await` it first" : "";
  const text = `${call} takes an ArrayBuffer, a typed array, a File, a Blob, a Response or an address, not ${given}${awaited}`;
  throw new HtexError(text, "invalid-argument");
}

/** Downloads a texture's file. `cloth.htexlib#woven/cotton` is a texture of a library, of which only the needed ranges are fetched. */
async function bytesAt(url, signed = {}) {
  if (!isInLibrary(url)) {
    return new Uint8Array(await (await download(url, "the texture")).arrayBuffer());
  }
  const opened = await Library.open(new URL(url.href.slice(0, -url.hash.length)), signed);
  try {
    return await opened.bytes(decodeURIComponent(url.hash.slice(1)));
  } finally {
    opened.free();
  }
}

const isInLibrary = (url) => url.hash !== "" && /\.htexlib$/i.test(url.pathname);

export function isBlob(source) {
  return typeof Blob !== "undefined" && source instanceof Blob;
}

/**
 * Converts an address that a caller passes in to a URL. Relative addresses are errors in Node.js,
 * which has no base address.
 */
export function addressOf(source, call) {
  const base = globalThis.location?.href;
  const url = URL.canParse(source, base) ? new URL(source, base) : null;
  const isFile = url?.protocol === "file:" && host.readFile;
  if (url && !isFile) return url;
  const advice = host.readFile || !base ? `\`${call}(await readFile(${JSON.stringify(String(source))}))\`, with readFile of node:fs/promises` : "an address";
  throw new HtexError(`${call}: ${JSON.stringify(String(source))} is no address of a web server, and no file is read; give ${advice}`, "invalid-argument");
}
