// A worker that renders the voices of models that are not trusted. The page ends it when a call takes too long.

import { Stage } from "./stage.js";

/** Frames of a block, and blocks that are rendered ahead: 32 ms at 48 kHz. */
const FRAMES = 256;
const AHEAD = 6;

const stage = new Stage();

/** The other side: a page, or a program of Node.js, in which this is a thread. */
let outside = globalThis;

function report(id, error) {
  outside.postMessage({ id, error: { message: error.message, code: error.code } });
}

/** Plays a voice through a port to an audio worklet. */
function play({ id, description, port }) {
  let voice;
  const attempt = (run) => {
    try {
      if (voice !== null) run();
    } catch (error) {
      voice = null;
      report(id, error);
    }
  };
  const render = (block) => {
    voice.render(block);
    port.postMessage(block, [block.buffer]);
  };
  port.onmessage = ({ data: { block, motion, stop } }) =>
    attempt(() => {
      if (motion) voice.setMotion(...motion);
      if (block) render(block);
      if (stop) {
        voice.free();
        voice = null;
        port.close();
      }
    });
  attempt(() => {
    voice = stage.voice(description);
    for (let i = 0; i < AHEAD; i++) render(new Float32Array(FRAMES));
    outside.postMessage({ id, ready: true });
  });
}

/** Renders samples at once. */
function render({ id, description, frames }) {
  try {
    const voice = stage.voice(description);
    const samples = voice.render(frames);
    voice.free();
    outside.postMessage({ id, samples }, [samples.buffer]);
  } catch (error) {
    report(id, error);
  }
}

function listen() {
  outside.onmessage = ({ data }) => {
    if (data.ping) outside.postMessage({ pong: data.ping });
    else if (data.port) play(data);
    else render(data);
  };
}

// Without `await` at this level, which bundles of workers in another format than ES do not have. Messages wait for `onmessage`.
if (globalThis.postMessage) listen();
else
  import(/* @vite-ignore */ "node:worker_threads").then(({ parentPort }) => {
    outside = parentPort;
    listen();
  });
