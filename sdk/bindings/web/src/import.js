// Import files of other haptic formats as textures. A separate WASM module reads them. It also
// contains the author module, and is loaded when it is first needed.

import { AuthorCore } from "./author-core.js";
import { inThread, setThread, throwIfAborted } from "./author-thread.js";
import { copiesIn, loaded, named } from "./files.js";
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

/** Reads files of other formats, in the calling thread. */
export class Importer {
  constructor(core, player) {
    this.core = core;
    this.player = player;
  }

  /**
   * Returns the formats that can be imported, and the actuators. Some formats give frequencies as
   * positions in an actuator's range.
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
