// Renders voices of untrusted models in a worker. If a call does not return, the worker is
// terminated.

import { HtexError } from "./core.js";
import { host } from "./host.js";
import { files, libraryBytes } from "./library.js";
import { VOICE, checked } from "./options.js";
import { Texture } from "./texture.js";

/** Milliseconds between two checks that the worker still answers. */
const ASKED_MS = 250;

let keys = 0;

/**
 * Returns everything that a worklet or a worker needs to make a voice. If `rests` is true, the
 * finger is lifted at the start.
 */
export function describe(texture, voice, rests = false) {
  texture.key ??= `texture ${(keys += 1)}`;
  return { library: texture.core.module, key: texture.key, bytes: texture.bytes, open: texture.options, voice, rests };
}

/** Refuses anything that is not a texture from `open`. */
export function checkTexture(texture, call) {
  if (texture instanceof Texture && texture.bytes && !texture.isFreed) return;
  const what = texture?.isFreed ? "a texture that was freed" : "no texture";
  throw new HtexError(`${call} was given ${what}; give what \`await open(…)\` returns`, "invalid-argument");
}

/** Starts the worker of a page. */
function startInPage(receive, failed) {
  // Bundlers recognise this form.
  const worker = files.worker
    ? new Worker(/* @vite-ignore */ files.worker, { type: "module" })
    : new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
  worker.onmessage = ({ data }) => receive(data);
  worker.onerror = ({ message }) => failed(message ?? "its file cannot be loaded");
  return worker;
}

export class GuardedWorker {
  /** `limit`: longest allowed call, ms. */
  constructor(options = {}) {
    const { limit = 2_000 } = checked(options, { limit: "number" }, "GuardedWorker");
    this.limit = limit;
    this.waiting = new Map();
    this.last = 0;
    this.heard = Date.now();
    const receive = (data) => this.receive(data);
    const failed = (message) => this.end(new HtexError(`the worker failed: ${message}`, "internal"));
    this.worker = (host.startThread ?? startInPage)(receive, failed);
    this.timer = setInterval(() => this.ask(), ASKED_MS);
    this.timer.unref?.();
  }

  post(message, transfer = []) {
    this.hold();
    try {
      this.worker.postMessage(message, transfer);
    } catch (error) {
      if (error.name !== "DataCloneError" || !message.description) throw error;
      this.postWithBytes(message, transfer);
    }
  }

  /**
   * Posts a message together with the library's bytes, for browsers that cannot send the compiled
   * library.
   */
  postWithBytes(message, transfer) {
    const send = (library) => this.worker.postMessage({ ...message, description: { ...message.description, library } }, transfer);
    libraryBytes().then(send).catch((error) => this.receive({ id: message.id, error }));
  }

  /** Keeps a Node.js program running while a request is pending. */
  hold() {
    const how = this.waiting.size > 0 ? "ref" : "unref";
    this.worker[how]?.();
    this.timer[how]?.();
  }

  receive({ pong, id, error, ...result }) {
    this.heard = Date.now();
    if (pong) {
      this.asked = false;
      return;
    }
    const { resolve, reject, isOnce } = this.waiting.get(id) ?? {};
    if (isOnce) this.waiting.delete(id);
    this.hold();
    if (error) reject?.(new HtexError(error.message, error.code ?? "internal"));
    else resolve?.(result);
  }

  ask() {
    if (!this.asked) {
      this.heard = Date.now();
      this.asked = true;
      this.post({ ping: true });
    } else if (Date.now() - this.heard > this.limit) {
      this.end(new HtexError(`a model ran longer than ${this.limit} ms and was stopped`, "model"));
    }
  }

  /**
   * Sends a message and returns a promise of its result. `failed` is called with every error, also
   * with errors that come after the result.
   */
  request(message, transfer = [], failed = null) {
    if (this.ended) return Promise.reject(this.ended);
    this.last += 1;
    const id = this.last;
    const done = new Promise((resolve, reject) => {
      const both = (error) => (reject(error), failed?.(error));
      this.waiting.set(id, { resolve, reject: both, isOnce: !failed });
    });
    this.post({ id, ...message }, transfer);
    return done;
  }

  /**
   * Plays a voice through a port. `failed` is called with every error, until `forget` is called.
   */
  play(description, port, failed) {
    const ready = this.request({ description, port }, [port], failed);
    const id = this.last;
    return { ready, forget: () => void this.waiting.delete(id) };
  }

  /** Renders the first samples of a new voice. */
  async render(texture, frames, options = {}) {
    const call = "worker.render";
    checkTexture(texture, call);
    checked(options, VOICE, call);
    if (!Number.isInteger(frames) || frames < 0) throw new HtexError(`${call}: ${frames} frames; give a whole number`, "invalid-argument");
    return (await this.request({ description: describe(texture, options), frames })).samples;
  }

  /** Terminates the worker. Pending requests fail with the error. */
  end(error = new HtexError("the worker was ended", "internal")) {
    if (this.ended) return;
    this.ended = error;
    clearInterval(this.timer);
    this.worker.terminate();
    for (const { reject } of this.waiting.values()) reject(error);
    this.waiting.clear();
  }
}

if (Symbol.dispose) {
  GuardedWorker.prototype[Symbol.dispose] = function () {
    this.end();
  };
}
