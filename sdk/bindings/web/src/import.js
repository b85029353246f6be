// Import files of other haptic formats as textures, and export textures to such files. A separate
// WASM module reads and writes them. It also contains the author module, and is loaded when it is
// first needed.

import { AuthorCore } from "./author-core.js";
import { inThread, setThread, throwIfAborted } from "./author-thread.js";
import { bytesOfTexture, copiesIn, loaded, named } from "./files.js";
import { compiledFrom, library, opened } from "./library.js";

let source = () => new URL("./htex-import.wasm", import.meta.url);
let module;
let importer;

/**
 * Sets where the module is (its address, its bytes or a WebAssembly.Module), and how the worker is
 * started, as `setAuthorLibrary` does. Call this before the first use.
 */
export function setImportLibrary(library, { worker } = {}) {
  if (library !== undefined) source = () => library;
  [module, importer] = [undefined, undefined];
  if (worker !== undefined) setThread(worker);
}

function compiled() {
  module ??= compiledFrom(source(), "the module of imports").catch((error) => {
    module = undefined;
    throw error;
  });
  return module;
}

/** Loads the import module into the calling thread. */
export function loadImporter() {
  importer ??= Promise.all([compiled().then((compiledModule) => AuthorCore.make(compiledModule)), library()])
    .then(([own, player]) => new Importer(own, player))
    .catch((error) => {
      importer = undefined;
      throw error;
    });
  return importer;
}

/** Returns the arguments for a call of the module. */
function callOf({ name, bytes }, { models, ...settings }) {
  if (models !== undefined) settings.models = [models].flat();
  return { request: { file: name, settings }, files: [bytes] };
}

/** Returns the arguments for a call that exports a texture. `stroke` is a file, or undefined. */
function exportOf(texture, to, stroke, settings) {
  const request = { format: to, settings: { ...settings, stroke: stroke?.name } };
  return { request, files: [bytesOfTexture(texture), ...(stroke ? [stroke.bytes] : [])] };
}

/** Reads and writes files of other formats, in the calling thread. */
export class Importer {
  constructor(core, player) {
    this.core = core;
    this.player = player;
  }

  /**
   * Returns the formats that can be imported (`formats`) and exported (`exports`), and the
   * actuators (`profiles`).
   */
  formats() {
    return this.core.call("formats", {}).document;
  }

  /** Returns what a file does not state. `importFile` needs each of these as a setting. */
  asks(file) {
    const { name, bytes } = named(file);
    return this.core.call("asks", { file: name }, [bytes]).document;
  }

  /** Imports a file. */
  importFile(file, settings = {}) {
    const { request, files } = callOf(named(file), settings);
    const { document, bytes } = this.core.call("import", request, files);
    return { texture: opened(this.player, bytes), report: document };
  }

  /** Exports a texture to the format with the name `to`. */
  exportFile(texture, to, { stroke, ...settings } = {}) {
    const { request, files } = exportOf(texture, to, stroke && named(stroke), settings);
    const { document, bytes } = this.core.call("export", request, files);
    return { bytes, ...document };
  }
}

/** Imports a file in a worker. `onProgress` is called with `{ done, of, text }`; `signal` aborts the import. */
export async function importFile(file, { onProgress, signal, ...settings } = {}) {
  throwIfAborted(signal, "import");
  const given = await loaded(file);
  const loading = Promise.all([compiled(), library()]);
  const { document, bytes } = await inThread("import", loading, callOf(given, settings), { copies: copiesIn([given]), onProgress, signal });
  const [, player] = await loading;
  return { texture: opened(player, bytes), report: document };
}

/** Exports a texture to the format with the name `to`, in a worker. `signal` aborts the export. */
export async function exportFile(texture, to, { signal, stroke, ...settings } = {}) {
  throwIfAborted(signal, "export");
  const path = stroke && (await loaded(stroke));
  const call = exportOf(texture, to, path, settings);
  const { document, bytes } = await inThread("export", Promise.all([compiled()]), call, { copies: path ? copiesIn([path]) : [], signal });
  return { bytes, ...document };
}
