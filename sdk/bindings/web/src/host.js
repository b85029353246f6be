// What Node.js provides in place of a page. `index.node.js` sets it, so that bundles for pages name
// no Node.js module.

export const host = {
  /** Reads a file of the package. */
  readFile: null,
  /** Starts the thread of a GuardedWorker. */
  startThread: null,
  /** Starts the thread that fits models. Like a page's worker it has `onmessage` and `onerror`. */
  startAuthorThread: null,
};
