// Functions that only Node.js provides. `index.node.js` sets them, so that bundles for pages refer
// to no Node.js module.

export const host = {
  /** Reads a file of the package. */
  readFile: null,
  /** Starts the thread of a GuardedWorker. */
  startThread: null,
  /**
   * Starts the thread that runs fits and imports. It has `onmessage` and `onerror`, like a page's
   * worker.
   */
  startAuthorThread: null,
};
