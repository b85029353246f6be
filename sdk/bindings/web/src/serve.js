// Renders voices of untrusted models for another thread. That thread terminates this worker if a
// call takes too long.

import { Stage } from "./stage.js";

/**
 * Number of samples in a block, and number of blocks that are rendered in advance: 32 ms at 48 kHz.
 */
const FRAMES = 256;
const AHEAD = 6;

/** Answers messages from the other side. */
export function serve(outside) {
  const stage = new Stage();
  const report = (id, error) => outside.postMessage({ id, error: { message: error.message, code: error.code } });

  /** Renders a voice and sends its samples through a port to an audio worklet. */
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

  /** Renders the first samples of a voice and sends them back. */
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
  // A Node.js port and a page's worker both have this handler. Messages wait until it is set.
  outside.onmessage = ({ data }) => receive(data);
}
