// Where the samples of a worklet come from.

/** Seconds of the ramp to silence where samples lack, and back. */
const RAMP_S = 0.005;

/** A voice in this thread. */
export class Here {
  constructor(voice) {
    this.voice = voice;
    this.last = 0;
  }

  setMotion(speed, force, position) {
    this.voice.setMotion(speed, force, position);
  }

  /** Renders a block; no sample lacks. After an error, which is thrown, the last sample has faded away in it. */
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

  /** What was played since the last call; null for a voice without bands. */
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

/** A voice in a worker, which renders ahead: blocks that arrive at `port`, asked for as they are used. */
export class There {
  /** `started` is called when the first block has arrived. */
  constructor(port, started) {
    this.port = port;
    this.blocks = [];
    this.used = 0;
    this.weight = 0;
    this.motion = null;
    /** Whether the worker was ended. */
    this.isAlone = false;
    port.onmessage = ({ data }) => {
      this.blocks.push(data);
      started?.();
      started = null;
    };
  }

  setMotion(speed, force, position) {
    this.motion = [speed, force, position];
  }

  /** Renders a block; returns the number of samples that lacked. */
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

  /** Whether the worker was ended, and what it had rendered has faded away. */
  get isOver() {
    return this.isAlone && this.blocks.length === 0 && this.weight === 0;
  }

  /** Gives the first block back to be filled again. */
  ask() {
    const { block, envelope } = this.blocks.shift();
    this.measured = envelope;
    this.port.postMessage({ block, motion: this.motion }, [block.buffer]);
    this.motion = null;
    this.used = 0;
  }

  /** The envelope of the last block. */
  envelope() {
    return this.measured;
  }

  free() {
    this.port.postMessage({ stop: true });
  }
}
