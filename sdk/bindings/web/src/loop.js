// Recordings as sound: samples that a node plays in a loop.

import { HtexError } from "./core.js";

/** Refuses anything that is not a loop from `author.recorded`. */
export function checkLoop({ samples, rate_hz: rate, level_rms: level }, call) {
  const isLoop = samples instanceof Float32Array && samples.length > 0 && rate > 0 && Number.isFinite(rate) && level >= 0;
  if (!isLoop) throw new HtexError(`${call}: a loop has samples (a Float32Array that is not empty), rate_hz (above 0) and level_rms, such as author.recorded returns`, "invalid-argument");
}

/**
 * The loops of a node. Samples are large, so the worklet keeps the samples of the last loop, and
 * they are not sent again.
 */
export class Loops {
  /**
   * Returns what the worklet needs to play a loop at the sample rate of the context, with all
   * frequencies multiplied by `pitch`.
   */
  describe({ samples, rate_hz: rate }, { contextRate, pitch = 1 }) {
    const step = (rate * pitch) / contextRate;
    if (this.sent === samples) return { step };
    this.sent = samples;
    return { step, samples };
  }
}
