// Renders the voices of models that are not trusted, for another thread, which ends this one when a call takes too long.

import { Stage } from "./stage.js";

/** Frames of a block, and blocks that are rendered ahead: 32 ms at 48 kHz. */
const FRAMES = 256;
const AHEAD = 6;

/** Answers the messages of the other side. */
export function serve(outside) {
  const stage = new Stage();
  const report = (id, error) => outside.postMessage({ id, error: { message: error.message, code: error.code } });

  /** Plays a voice through a port to an audio worklet. */
  const play = ({ id, description, port }) => {
    let voice = null;
    const attempt = (run) => {
      try {
        run();
      } catch (error) {
        voice = null;
        report(id, error);
      }
    };
    const render = (block) => {
      voice.render(block);
      const envelope = voice.bands > 0 ? voice.envelope() : null;
      port.postMessage({ block, envelope }, [block.buffer]);
    };
    port.onmessage = ({ data: { block, motion, stop } }) =>
      attempt(() => {
        if (voice && motion) voice.setMotion(...motion);
        if (voice && block) render(block);
        if (stop) {
          voice?.free();
          voice = null;
          port.close();
        }
      });
    attempt(() => {
      voice = stage.voice(description);
      for (let i = 0; i < AHEAD; i++) render(new Float32Array(FRAMES));
      outside.postMessage({ id, ready: true });
    });
  };

  /** Renders samples at once. */
  const render = ({ id, description, frames }) => {
    try {
      const voice = stage.voice(description);
      const samples = voice.render(frames);
      voice.free();
      outside.postMessage({ id, samples }, [samples.buffer]);
    } catch (error) {
      report(id, error);
    }
  };

  const receive = (data) => {
    if (data.ping) outside.postMessage({ pong: data.ping });
    else if (data.port) play(data);
    else render(data);
  };
  // A port of Node.js and a worker of a page both have it; messages wait until it is set.
  outside.onmessage = ({ data }) => receive(data);
}
