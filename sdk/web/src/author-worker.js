// A worker in which recordings are fitted. Each call has an instance of its own, whose memory is free afterwards.

import { AuthorCore } from "./author-core.js";

/** The other side: a page, or a program of Node.js, in which this is a thread. */
let outside = globalThis;

async function answer({ module, name, request, files }) {
  try {
    const core = await AuthorCore.make(module, (done, of, text) => outside.postMessage({ progress: { done, of, text } }));
    const { document, bytes } = core.call(name, request, files);
    outside.postMessage({ document, bytes }, [bytes.buffer]);
  } catch ({ message, code }) {
    outside.postMessage({ error: { message, code } });
  }
}

function listen() {
  outside.onmessage = ({ data }) => void answer(data);
}

// Without `await` at this level, which bundles of workers in another format than ES do not have. Messages wait for `onmessage`.
if (globalThis.postMessage) listen();
else
  import(/* @vite-ignore */ "node:worker_threads").then(({ parentPort }) => {
    outside = parentPort;
    listen();
  });
