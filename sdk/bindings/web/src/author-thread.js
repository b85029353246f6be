// Calls modules in a worker, for fits, imports and exports.

import { HtexError } from "./core.js";
import { host } from "./host.js";

let startWorker = null;
/** An idle worker that waits for the next call, or null. */
let idle = null;

/** Sets how the worker is started, if a bundler has moved it. */
export function setThread(worker) {
  startWorker = worker;
  idle?.terminate();
  idle = null;
}

/** Starts the worker of a page. */
function startInPage() {
  // Bundlers recognise this form of the call.
  return new Worker(new URL("./author-worker.js", import.meta.url), { type: "module" });
}

function takeWorker() {
  const taken = idle;
  idle = null;
  return taken ?? (startWorker ?? host.startAuthorThread ?? startInPage)();
}

/**
 * Keeps a worker for the next call. While it is idle, it does not keep a Node.js program running.
 */
function giveBack(worker) {
  worker.onmessage = null;
  worker.onerror = null;
  if (idle) return worker.terminate();
  idle = worker;
  worker.unref?.();
}

function aborted(signal, what) {
  return Object.assign(new HtexError(`the ${what} was aborted`, "aborted"), { cause: signal.reason });
}

export function throwIfAborted(signal, what) {
  if (signal?.aborted) throw aborted(signal, what);
}

/**
 * Calls a function by its name, in the module to which the promise `loading` resolves. Returns the
 * resulting document and bytes. The buffers in `copies` are transferred to the worker.
 */
export async function inThread(name, loading, call, { copies, onProgress, signal }) {
  loading.catch(() => {});
  // The worker starts while the module loads.
  const worker = await takeWorker();
  const [module] = await loading.catch((error) => {
    giveBack(worker);
    throw error;
  });
  return new Promise((resolve, reject) => {
    const end = (settle, value, kept) => {
      signal?.removeEventListener("abort", abort);
      if (kept) giveBack(worker);
      else worker.terminate();
      settle(value);
    };
    const abort = () => end(reject, aborted(signal, name), false);
    worker.ref?.();
    worker.onmessage = ({ data: { progress, error, ...result } }) => {
      if (progress) onProgress?.(progress);
      else if (error) end(reject, new HtexError(error.message, error.code ?? "internal"), error.code !== "internal");
      else end(resolve, result, true);
    };
    worker.onerror = ({ message }) => end(reject, new HtexError(`the worker failed: ${message}`, "internal"), false);
    if (signal?.aborted) return abort();
    signal?.addEventListener("abort", abort, { once: true });
    worker.postMessage({ module, name, ...call }, copies);
  });
}
