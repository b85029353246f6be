// What Node.js has in place of a page; `index.node.js` sets it. Bundles for pages name no module of Node.js.

export const host = {
  /** Reads a file of the package. */
  readFile: null,
  /** Starts the thread of a GuardedWorker. */
  startThread: null,
  /** Starts the thread that fits; it has `onmessage` and `onerror`, as a worker of a page. */
  startAuthorThread: null,
};
