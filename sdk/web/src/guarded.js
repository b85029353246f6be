// Voices of models that are not trusted, in a worker that is ended when it does not return.

import { HtexError } from "./core.js";

/** Milliseconds between two questions whether the worker returns. */
const ASKED_MS = 250;

let keys = 0;

/** What a worklet or a worker needs to make a voice. */
export function describe(texture, options, rate) {
  texture.key ??= `texture ${(keys += 1)}`;
  const { model, seed, synthesis, frequencyScaling, levelScaling, contact, ceiling, motion } = options;
  const voice = { model, seed, synthesis, frequencyScaling, levelScaling, contact, ceiling, motion, rate };
  const module = texture.core.module;
  return { module, key: texture.key, bytes: texture.bytes, open: texture.options, voice };
}

export class GuardedWorker {
  /** `limit`: milliseconds of the longest call. */
  constructor({ limit = 2_000 } = {}) {
    this.limit = limit;
    this.waiting = new Map();
    this.last = 0;
    this.heard = Date.now();
    this.worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
    this.worker.onmessage = ({ data }) => this.receive(data);
    this.worker.onerror = ({ message }) => this.end(new HtexError(`the worker failed: ${message}`, "internal"));
    this.timer = setInterval(() => this.ask(), ASKED_MS);
  }

  receive({ pong, id, error, ...result }) {
    this.heard = Date.now();
    if (pong) {
      this.asked = false;
      return;
    }
    const { resolve, reject, isOnce } = this.waiting.get(id) ?? {};
    if (isOnce) this.waiting.delete(id);
    if (error) reject?.(new HtexError(error.message, error.code));
    else resolve?.(result);
  }

  ask() {
    if (!this.asked) {
      this.heard = Date.now();
      this.asked = true;
      this.worker.postMessage({ ping: true });
    } else if (Date.now() - this.heard > this.limit) {
      this.end(new HtexError(`a model ran longer than ${this.limit} ms and was stopped`, "model"));
    }
  }

  /** Sends a message; the promise is of its result. `failed` is called with an error, and with later ones too. */
  request(message, transfer = [], failed = null) {
    if (this.ended) return Promise.reject(this.ended);
    this.last += 1;
    const id = this.last;
    const done = new Promise((resolve, reject) => {
      const both = (error) => (reject(error), failed?.(error));
      this.waiting.set(id, { resolve, reject: both, isOnce: !failed });
    });
    this.worker.postMessage({ id, ...message }, transfer);
    return done;
  }

  /** Plays a voice through a port; `failed` is called with an error, at any later time too. */
  play(description, port, failed) {
    return this.request({ description, port }, [port], failed);
  }

  /** Renders the first samples of a new voice. */
  async render(texture, frames, options = {}) {
    const description = describe(texture, options, options.rate);
    return (await this.request({ description, frames })).samples;
  }

  /** Ends the worker; what it was asked for fails with the error. */
  end(error = new HtexError("the worker was ended", "internal")) {
    if (this.ended) return;
    this.ended = error;
    clearInterval(this.timer);
    this.worker.terminate();
    for (const { reject } of this.waiting.values()) reject(error);
    this.waiting.clear();
  }
}
