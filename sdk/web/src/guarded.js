// Voices of models that are not trusted, in a worker that is ended when it does not return.

import { HtexError } from "./core.js";

/** Milliseconds between two questions whether the worker returns. */
const ASKED_MS = 250;

let keys = 0;

/** What a worklet or a worker needs to make a voice. */
export function describe(texture, options, rate) {
  texture.key ??= `texture ${(keys += 1)}`;
  const { model, seed, synthesis, frequencyScaling, levelScaling, contact, ceiling, limit, motion } = options;
  const voice = { model, seed, synthesis, frequencyScaling, levelScaling, contact, ceiling, limit, motion, rate };
  const module = texture.core.module;
  return { module, key: texture.key, bytes: texture.bytes, open: texture.options, voice };
}

/** Starts the worker of a page. */
function startInPage(receive, failed) {
  const worker = new Worker(new URL("./worker.js", import.meta.url), { type: "module" });
  worker.onmessage = ({ data }) => receive(data);
  worker.onerror = ({ message }) => failed(message);
  return worker;
}

/** Starts a thread of Node.js, which has no `Worker` of pages. It keeps the program running only while it is asked for something. */
async function startInNode(receive, failed) {
  const { Worker: Thread } = await import(/* @vite-ignore */ "node:worker_threads");
  const thread = new Thread(new URL("./worker.js", import.meta.url));
  thread.on("message", receive);
  thread.on("error", ({ message }) => failed(message));
  thread.unref();
  return thread;
}

export class GuardedWorker {
  /** `limit`: milliseconds of the longest call. */
  constructor({ limit = 2_000 } = {}) {
    this.limit = limit;
    this.waiting = new Map();
    this.last = 0;
    this.heard = Date.now();
    const receive = (data) => this.receive(data);
    const failed = (message) => this.end(new HtexError(`the worker failed: ${message}`, "internal"));
    if (typeof Worker !== "undefined") this.worker = startInPage(receive, failed);
    // Until the thread of Node.js has started, messages wait.
    else {
      this.early = [];
      startInNode(receive, failed).then((thread) => this.started(thread), ({ message }) => failed(message));
    }
    this.timer = setInterval(() => this.ask(), ASKED_MS);
    this.timer.unref?.();
  }

  /** Passes on what waited for a thread of Node.js. */
  started(thread) {
    this.worker = thread;
    if (this.ended) return void thread.terminate();
    for (const [message, transfer] of this.early) thread.postMessage(message, transfer);
    this.hold();
  }

  post(message, transfer = []) {
    if (this.worker) this.worker.postMessage(message, transfer);
    else this.early.push([message, transfer]);
    this.hold();
  }

  /** Keeps a program of Node.js running while a result is waited for. */
  hold() {
    const how = this.waiting.size > 0 ? "ref" : "unref";
    this.worker?.[how]?.();
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
    if (error) reject?.(new HtexError(error.message, error.code));
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

  /** Sends a message; the promise is of its result. `failed` is called with an error, and with later ones too. */
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
    this.worker?.terminate();
    for (const { reject } of this.waiting.values()) reject(error);
    this.waiting.clear();
  }
}
