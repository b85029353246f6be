// The audio worklet: voices in the audio thread, or samples that a worker renders.

import { Stage } from "./stage.js";

const stage = new Stage();
/** Seconds of the ramp to silence after a failure, and back. */
const RAMP_S = 0.005;

class HtexProcessor extends AudioWorkletProcessor {
  static get parameterDescriptors() {
    const least = { minValue: 0, automationRate: "k-rate" };
    return [
      { name: "speed", defaultValue: 0, maxValue: 1e5, ...least },
      { name: "force", defaultValue: 0, maxValue: 1e3, ...least },
      { name: "gain", defaultValue: 1, maxValue: 1e9, ...least },
    ];
  }

  constructor({ processorOptions }) {
    super();
    this.position = NaN;
    this.motion = [NaN, NaN, NaN];
    this.gain = null;
    this.stopped = false;
    this.block = new Float32Array(128);
    this.port.onmessage = ({ data }) => this.receive(data);
    this.source = null;
    try {
      if (processorOptions.voice) this.source = new Here(processorOptions.voice);
    } catch (error) {
      this.fail(error);
    }
  }

  receive(data) {
    if (data.position !== undefined) this.position = data.position;
    if (data.samples) this.source = new There(data.samples);
    if (data.stop) {
      this.stopped = true;
      this.source?.free();
    }
  }

  fail(error) {
    this.source = null;
    this.port.postMessage({ error: { message: error.message, code: error.code } });
  }

  process(_, [channels], { speed, force, gain }) {
    if (this.stopped) return false;
    const frames = channels[0].length;
    if (this.block.length !== frames) this.block = new Float32Array(frames);
    this.render(speed[0], force[0]);
    this.level(gain[0]);
    for (const channel of channels) channel.set(this.block);
    return true;
  }

  render(speed, force) {
    if (!this.source) return void this.block.fill(0);
    try {
      const motion = [speed, force, this.position];
      if (motion.some((x, i) => !Object.is(x, this.motion[i]))) {
        this.source.setMotion(...motion);
        this.motion = motion;
      }
      this.source.render(this.block, (missed) => this.port.postMessage({ missed }));
    } catch (error) {
      this.block.fill(0);
      this.fail(error);
    }
  }

  /** Applies the gain, in a straight line from that of the last block. */
  level(gain) {
    const from = this.gain ?? gain;
    this.gain = gain;
    if (from === 1 && gain === 1) return;
    const step = (gain - from) / this.block.length;
    for (let i = 0; i < this.block.length; i++) this.block[i] *= from + step * (i + 1);
  }
}

/** A voice in this thread. */
class Here {
  constructor(description) {
    this.voice = stage.voice(description);
  }

  setMotion(speed, force, position) {
    this.voice.setMotion(speed, force, position);
  }

  render(block) {
    this.voice.render(block);
  }

  free() {
    this.voice.free();
  }
}

/** A voice in a worker, which renders ahead: blocks that arrive at `port`, asked for as they are used. */
class There {
  constructor(port) {
    this.port = port;
    this.blocks = [];
    this.used = 0;
    this.weight = 0;
    this.motion = null;
    port.onmessage = ({ data }) => this.blocks.push(data);
  }

  setMotion(speed, force, position) {
    this.motion = [speed, force, position];
  }

  render(block, missed) {
    let lacking = 0;
    const step = 1 / (RAMP_S * sampleRate);
    for (let i = 0; i < block.length; i++) {
      const first = this.blocks[0];
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
      if (this.used === first.length) {
        this.port.postMessage({ block: first, motion: this.motion }, [first.buffer]);
        this.motion = null;
        this.blocks.shift();
        this.used = 0;
      }
    }
    if (lacking > 0 && this.last !== undefined) missed(lacking);
    if (this.motion && this.blocks.length > 0) {
      this.port.postMessage({ motion: this.motion });
      this.motion = null;
    }
  }

  free() {
    this.port.postMessage({ stop: true });
  }
}

registerProcessor("htex", HtexProcessor);
