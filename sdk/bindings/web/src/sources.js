// The sources from which a worklet gets its samples.

/** Duration of the ramp to silence when samples are missing, and of the ramp back, seconds. */
const RAMP_S = 0.005;

/** A voice in this thread. */
export class Here {
  constructor(voice) {
    this.voice = voice;
    this.last = 0;
  }

  setMotion(...motion) {
    this.voice.setMotion(...motion);
  }

  /**
   * Renders a block. Returns 0, because no samples are missing. If rendering fails, the last sample
   * fades away within the block, and the error is thrown.
   */
  render(block) {
    try {
      this.voice.render(block);
      this.last = block[block.length - 1];
      return 0;
    } catch (error) {
      for (let i = 0; i < block.length; i++) block[i] = this.last * (1 - (i + 1) / block.length);
      throw error;
    }
  }

  /**
   * Returns the envelope of what was played since the last call, or null for a voice without bands.
   */
  envelope() {
    return this.voice.bands > 0 ? this.voice.envelope() : null;
  }

  get isOver() {
    return false;
  }

  free() {
    this.voice.free();
  }
}

/**
 * Samples that play in a loop while the finger slides. They are the same at any speed and force.
 */
export class Loop {
  /** `step` is the number of samples by which the loop advances for each output sample. */
  constructor(samples, step) {
    this.samples = samples;
    this.step = step;
    this.at = 0;
    this.weight = 0;
    this.isTouched = false;
    this.power = 0;
    this.frames = 0;
    this.turns = 0;
    this.isHigh = false;
  }

  setMotion(speed, force) {
    this.isTouched = speed > 0 && force > 0;
  }

  /**
   * Renders a block. Returns 0, because no samples are missing. The loop stands still while nothing
   * is audible.
   */
  render(block) {
    const ramp = (this.isTouched ? 1 : -1) / (RAMP_S * sampleRate);
    for (let i = 0; i < block.length; i++) {
      this.weight = Math.min(Math.max(this.weight + ramp, 0), 1);
      block[i] = this.weight > 0 ? this.weight * this.next() : 0;
      this.measure(block[i]);
    }
    return 0;
  }

  /** Returns the sample at the current position, interpolated linearly. */
  next() {
    const { samples, at } = this;
    const whole = Math.floor(at);
    const [a, b] = [samples[whole], samples[(whole + 1) % samples.length]];
    this.at = (at + this.step) % samples.length;
    return a + (at - whole) * (b - a);
  }

  measure(sample) {
    this.power += sample * sample;
    this.frames += 1;
    const isHigh = sample > 0;
    if (isHigh !== this.isHigh) this.turns += 1;
    this.isHigh = isHigh;
  }

  /**
   * Returns the envelope of what was played since the last call. The centroid is estimated as half
   * the rate of sign changes.
   */
  envelope() {
    const { power, frames, turns } = this;
    Object.assign(this, { power: 0, frames: 0, turns: 0 });
    if (frames === 0) return null;
    return { level: Math.sqrt(power / frames), centroid: (0.5 * turns * sampleRate) / frames, frames, bands: new Float64Array(0) };
  }

  get isOver() {
    return false;
  }

  free() {}
}

/**
 * A voice in a worker, which renders blocks in advance. Blocks arrive at `port`. A new block is
 * requested whenever one was used.
 */
export class There {
  /** `started` is called when the first block has arrived. */
  constructor(port, started) {
    this.port = port;
    this.blocks = [];
    this.used = 0;
    this.weight = 0;
    this.motion = null;
    /** Whether the worker was terminated. */
    this.isAlone = false;
    port.onmessage = ({ data }) => {
      this.blocks.push(data);
      started?.();
      started = null;
    };
  }

  setMotion(...motion) {
    this.motion = motion;
  }

  /** Renders a block and returns the number of missing samples. */
  render(block) {
    let lacking = 0;
    const step = 1 / (RAMP_S * sampleRate);
    for (let i = 0; i < block.length; i++) {
      const first = this.blocks[0]?.block;
      if (!first) {
        // Until blocks arrive again, the last sample fades away.
        this.weight = Math.max(this.weight - step, 0);
        block[i] = (this.last ?? 0) * this.weight;
        lacking += 1;
        continue;
      }
      this.weight = Math.min(this.weight + step, 1);
      this.last = first[this.used++];
      block[i] = this.last * this.weight;
      if (this.used === first.length) this.ask();
    }
    if (this.motion && this.blocks.length > 0) {
      this.port.postMessage({ motion: this.motion });
      this.motion = null;
    }
    return this.last === undefined || this.isAlone ? 0 : lacking;
  }

  /** Whether the worker was terminated, and all of its samples have faded away. */
  get isOver() {
    return this.isAlone && this.blocks.length === 0 && this.weight === 0;
  }

  /** Sends the first block back to the worker, which fills it again. */
  ask() {
    const { block, envelope } = this.blocks.shift();
    this.measured = envelope;
    this.port.postMessage({ block, motion: this.motion }, [block.buffer]);
    this.motion = null;
    this.used = 0;
  }

  /** Returns the envelope of the last block. */
  envelope() {
    return this.measured;
  }

  free() {
    this.port.postMessage({ stop: true });
  }
}
