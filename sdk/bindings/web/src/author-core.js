// Calls the single function of the author module, with a JSON document and the bytes of files. Runs
// in the calling thread. Programs use `author.js` instead.

import { Core, HtexError } from "./core.js";
import { Guests } from "./guests.js";

/** Sizes of the structs htex_bytes and htex_author_result. */
const FILE = 8;
const ANSWER = 16;

export class AuthorCore {
  /** Instantiates the compiled module. `onProgress` is called with the progress of a fit. */
  static async make(module, onProgress = null) {
    const guests = Object.assign(new Guests(), { onProgress });
    const instance = await WebAssembly.instantiate(module, { htex: guests.imports() });
    return new AuthorCore(new Core(instance, guests));
  }

  constructor(core) {
    this.core = core;
  }

  /** Calls a function of the module. Returns its document, and its bytes if it has any. */
  call(name, request, files = []) {
    const { core } = this;
    const memory = () => core.exports.memory.buffer;
    return core.scope((take) => {
      const text = new TextEncoder().encode(JSON.stringify(request));
      const places = files.map((file) => core.put(take, file));
      const list = take(FILE * Math.max(files.length, 1));
      const document = core.put(take, text);
      const title = core.putText(take, name);
      const result = take(ANSWER);
      const view = core.view();
      files.forEach((file, i) => {
        view.setUint32(list + FILE * i, places[i], true);
        view.setUint32(list + FILE * i + 4, file.length, true);
      });
      new Uint8Array(memory(), result, ANSWER).fill(0);
      let failure;
      try {
        core.call("htex_author_call", title, document, text.length, list, files.length, result);
      } catch (error) {
        failure = error;
      }
      // After a trap the memory must not be read any more.
      if (failure?.code === "internal") throw failure;
      const taken = (at) => {
        const now = core.view();
        const [start, length] = [now.getUint32(result + at, true), now.getUint32(result + at + 4, true)];
        if (start === 0) return new Uint8Array(0);
        const bytes = new Uint8Array(memory(), start, length).slice();
        core.exports.htex_free(start, length);
        return bytes;
      };
      const [json, bytes] = [taken(0), taken(8)];
      const read = json.length > 0 ? JSON.parse(new TextDecoder().decode(json)) : {};
      if (failure) throw read.code ? new HtexError(read.message, read.code) : failure;
      return { document: read, bytes };
    });
  }
}
