// The audio worklet. It plays a source of samples, and fades to another source.

import { Here, Loop, There } from "./sources.js";
import { Stage } from "./stage.js";
import { Track } from "./track.js";

const stage = new Stage();
/** Durations of fades, seconds: at a start, at a stop, and from one texture to another. */
const START_S = 0.01;
const STOP_S = 0.01;
const CHANGE_S = 0.02;
/**
 * Largest number of sources that are audible at the same time: the current one, and sources that
 * fade out.
 */
const MOST_TRACKS = 4;
/** Seconds between two envelopes. */
const REPORT_S = 0.02;

class HtexProcessor extends AudioWorkletProcessor {
  static get parameterDescriptors() {
    const least = { minValue: 0, automationRate: "k-rate" };
    return [
      { name: "speed", defaultValue: 0, maxValue: 1e5, ...least },
      { name: "force", defaultValue: 0, maxValue: 1e3, ...least },
      { name: "gain", defaultValue: 1, maxValue: 1e9, ...least },
    ];
  }

  constructor({ processorOptions: { gain, load } }) {
    super();
    this.position = NaN;
    this.place = [NaN, NaN];
    /** The current value of the parameter `gain`. */
    this.gain = gain;
    this.tracks = [];
    this.block = new Float32Array(128);
    this.unreported = 0;
    /** The samples of the last loop. */
    this.looped = null;
    this.port.onmessage = ({ data }) => this.receive(data);
    // A page opened as a file cannot send a compiled library through a port.
    this.port.onmessageerror = () => this.port.postMessage({ unusable: true });
    if (load) this.load(load);
  }

  receive(data) {
    if (data.position !== undefined) this.position = data.position;
    if (data.place) this.place = data.place;
    if (data.load) this.load(data.load);
    if (data.alone) for (const { source } of this.tracks) source.isAlone = true;
    if (data.stop) {
      this.stopping = true;
      // A suspended context renders no fade, so the sources are dropped at once.
      for (const track of this.tracks) data.isHeard ? track.fadeOut(STOP_S * sampleRate) : this.leave(track);
    }
  }

  /**
   * Starts a source. It is a voice that is made from a description, a voice whose samples arrive at
   * a port, or a loop. A loop without samples of its own plays the samples of the last loop.
   */
  load({ id, description, samples, loop, gain }) {
    if (this.stopping) return;
    if (loop) {
      this.looped = loop.samples ?? this.looped;
      this.start(new Loop(this.looped, loop.step), id, gain);
      return;
    }
    if (samples) {
      const source = new There(samples, () => this.start(source, id, gain));
      return;
    }
    const { library } = description;
    if (!(stage.core || library instanceof WebAssembly.Module || ArrayBuffer.isView(library))) return void this.port.postMessage({ id, unusable: true });
    try {
      this.start(new Here(stage.voice(description)), id, gain);
    } catch (error) {
      this.fail(error, id);
    }
  }

  /** Fades from the current source, if there is one, to another. */
  start(source, id, gain) {
    if (this.stopping) return void source.free();
    const frames = (this.tracks.length > 0 ? CHANGE_S : START_S) * sampleRate;
    for (const track of this.tracks) track.fadeOut(frames);
    this.tracks.push(new Track(source, { gain, parameter: this.gain, frames }));
    this.thin();
    this.port.postMessage({ id, started: true });
  }

  /** If there are too many sources, makes the quietest one fade out within the next block. */
  thin() {
    for (const track of this.tracks) if (track.isOver) this.leave(track);
    const leaving = this.tracks.filter(({ isLeaving }) => isLeaving);
    if (this.tracks.length > MOST_TRACKS) leaving.reduce((a, b) => (b.way < a.way ? b : a)).fadeOut(this.block.length);
  }

  leave(track) {
    track.source.free();
    this.tracks = this.tracks.filter((other) => other !== track);
  }

  fail({ message, code }, id) {
    this.port.postMessage({ id, error: { message, code } });
  }

  process(_, [[out]], { speed, force, gain }) {
    this.gain = gain[0];
    if (this.block.length !== out.length) this.block = new Float32Array(out.length);
    const motion = [speed[0], force[0], this.position, ...this.place];
    this.tracks.forEach((track, i) => {
      this.render(track, motion);
      if (i === 0) out.set(this.block);
      else for (let k = 0; k < out.length; k++) out[k] += this.block[k];
    });
    for (const track of this.tracks) if (track.isOver || track.failed) this.leave(track);
    this.report(out.length);
    if (this.stopping && this.tracks.length === 0) {
      this.port.postMessage({ ended: true });
      return false;
    }
    return true;
  }

  render(track, motion) {
    try {
      const missed = track.render(this.block, motion);
      if (missed > 0) this.port.postMessage({ missed });
    } catch (error) {
      track.failed = true;
      this.fail(error);
    }
    track.level(this.block, this.gain);
    track.fade(this.block);
  }

  /** Reports the envelope of the source that fades in or plays. */
  report(frames) {
    const source = this.tracks.at(-1)?.source;
    this.unreported += frames;
    if (!source || this.unreported < REPORT_S * sampleRate) return;
    this.unreported = 0;
    const envelope = source.envelope();
    if (envelope) this.port.postMessage({ envelope });
  }
}

registerProcessor("htex", HtexProcessor);
