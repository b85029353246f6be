// A track: a source of samples in a worklet, with its gain and its fade.

/** Whether two numbers are equal as 32-bit floats, which a node's parameters are. */
function same(a, b) {
  return Math.fround(a) === Math.fround(b);
}

export class Track {
  /**
   * Makes a track that fades in within `frames` samples. Its gain is `gain` until the node's gain
   * parameter differs from `parameter`.
   */
  constructor(source, { gain, parameter, frames }) {
    this.source = source;
    this.given = gain;
    this.parameter = parameter;
    this.gain = null;
    /** Progress of the fade, 0 to 1, and its change per sample. */
    this.way = 0;
    this.step = 1 / frames;
    this.motion = [];
  }

  fadeOut(frames) {
    this.step = -1 / frames;
    this.given ??= this.parameter;
    this.isLeaving = true;
  }

  get isOver() {
    return (this.isLeaving && this.way <= 0) || this.source.isOver;
  }

  /** Renders a block and returns the number of missing samples. */
  render(block, motion) {
    if (motion.some((x, i) => !Object.is(x, this.motion[i]))) {
      this.motion = motion;
      this.source.setMotion(...motion);
    }
    return this.source.render(block);
  }

  /**
   * Applies the gain, with a linear ramp from the gain of the last block. A track that fades out
   * keeps its gain.
   */
  level(block, parameter) {
    if (!this.isLeaving && !same(parameter, this.parameter)) this.given = null;
    if (!this.isLeaving) this.parameter = parameter;
    const gain = this.given ?? parameter;
    const from = this.gain ?? gain;
    this.gain = gain;
    if (from === 1 && gain === 1) return;
    const step = (gain - from) / block.length;
    for (let i = 0; i < block.length; i++) block[i] *= from + step * (i + 1);
  }

  /**
   * Applies the fade with equal power. So a fade between two textures of the same level keeps this
   * level.
   */
  fade(block) {
    if (this.way === 1 && this.step > 0) return;
    for (let i = 0; i < block.length; i++) {
      this.way = Math.min(Math.max(this.way + this.step, 0), 1);
      block[i] *= Math.sin(0.5 * Math.PI * this.way);
    }
  }
}
