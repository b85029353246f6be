// Runs fits, imports and exports for a page or a program, in a worker. Each call has its own
// instance of the module, whose memory is freed afterwards.

import { AuthorCore } from "./author-core.js";

/** Answers calls from `outside`: the scope of a worker, or the port of a thread. */
export function serveAuthor(outside) {
  const answer = async ({ module, name, request, files }) => {
    try {
      const core = await AuthorCore.make(module, (done, of, text) => outside.postMessage({ progress: { done, of, text } }));
      const { document, bytes } = core.call(name, request, files);
      outside.postMessage({ document, bytes }, [bytes.buffer]);
    } catch ({ message, code }) {
      outside.postMessage({ error: { message, code } });
    }
  };
  outside.onmessage = ({ data }) => void answer(data);
}
