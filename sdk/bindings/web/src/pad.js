// Drives the motors and actuators of gamepads: with two strengths from an envelope (`dual-rumble`),
// or with the samples (`playPCM`).

import { HtexError } from "./core.js";
import { checkTexture } from "./guarded.js";
import { usualGain } from "./node.js";
import { checked } from "./options.js";

/** Strength of a level (RMS) of full scale. A motor's strength is at most 1. */
const STRENGTH = 3;
/**
 * Mean frequencies, Hz: up to the first, only the large motor runs; from the second on, only the
 * small one. `htex_dsp::reduced` has the same values.
 */
const LARGE_MOTOR_HZ = 60;
const SMALL_MOTOR_HZ = 420;
/** Sample rate: the lowest that all browsers support in an AudioBuffer, Hz. */
const RATE = 8000;
/**
 * Duration of one message to the gamepad, seconds: of two strengths, and of samples, between which
 * a browser may leave a gap.
 */
const RUMBLE_S = 0.05;
const SAMPLES_S = 0.25;
/** An effect lasts for two blocks, so that it ends by itself if the page hangs. */
const HELD = 2;

const RUMBLE = { gain: "number", duration: "number" };
const PLAYER = { model: "string", seed: "integer", motion: "object", gain: "number" };

const unit = (x) => (Number.isNaN(x) ? 0 : Math.min(Math.max(x, 0), 1));

/**
 * Returns the parameters of the effect "dual-rumble" for an envelope. `gain` is the strength for a
 * level of 1, `duration` the effect's duration, ms.
 */
export function dualRumble({ level, centroid }, options = {}) {
  const { gain = STRENGTH, duration = 1e3 * HELD * RUMBLE_S } = checked(options, RUMBLE, "dualRumble");
  const strength = unit(gain * level);
  const small = unit((centroid - LARGE_MOTOR_HZ) / (SMALL_MOTOR_HZ - LARGE_MOTOR_HZ));
  return { startDelay: 0, duration, strongMagnitude: strength * (1 - small), weakMagnitude: strength * small };
}

/** Plays a texture on a gamepad until it is stopped. */
class PadPlayer {
  constructor(actuator, texture, options) {
    const { gain = usualGain(texture, options.model), ...voice } = options;
    this.actuator = actuator;
    this.gain = gain;
    this.voice = texture.voice({ ...voice, rate: RATE, bands: 1, motion: options.motion ?? { speed: 0, force: 0 } });
    /** "pcm" or "dual-rumble". */
    this.way = typeof actuator.playPCM === "function" && typeof AudioBuffer === "function" ? "pcm" : "dual-rumble";
    this.isStopped = false;
    /** Resolves when it was stopped; rejects when the gamepad fails. */
    this.ended = this.play().finally(() => this.rest());
    this.ended.catch(() => {});
  }

  setMotion(...motion) {
    if (!this.isStopped) this.voice.setMotion(...motion);
  }

  stop() {
    this.isStopped = true;
    this.wake?.();
    return this.ended;
  }

  async play() {
    try {
      while (!this.isStopped) await (this.way === "pcm" ? this.playSamples() : this.playRumble());
    } catch (error) {
      throw new HtexError(`playOnPad: the gamepad failed: ${error.message}`, "io");
    }
  }

  /**
   * The promise resolves when the samples have been played, with `false` if the actuator cannot
   * play samples.
   */
  async playSamples() {
    const samples = this.voice.render(SAMPLES_S * RATE).map((x) => Math.min(Math.max(this.gain * x, -1), 1));
    const buffer = new AudioBuffer({ length: samples.length, sampleRate: RATE, numberOfChannels: 1 });
    buffer.copyToChannel(samples, 0);
    const played = await Promise.race([this.actuator.playPCM(buffer), this.stopped()]);
    if (played === false) this.way = "dual-rumble";
  }

  async playRumble() {
    this.voice.render(RUMBLE_S * RATE);
    const effect = dualRumble(this.voice.envelope(), { gain: STRENGTH * this.gain });
    // The promise resolves when the effect ends, but the next effect comes earlier. A failure is
    // noticed then.
    this.actuator.playEffect("dual-rumble", effect).catch((error) => (this.failure ??= error));
    await Promise.race([new Promise((resolve) => setTimeout(resolve, 1e3 * RUMBLE_S)), this.stopped()]);
    if (this.failure) throw this.failure;
  }

  stopped() {
    return new Promise((resolve) => (this.wake = resolve));
  }

  async rest() {
    this.isStopped = true;
    this.voice.free();
    const none = dualRumble({ level: 0, centroid: 0 }, { duration: 1 });
    await (this.actuator.reset?.() ?? this.actuator.playEffect("dual-rumble", none)).catch(() => {});
  }
}

/**
 * Plays a texture on a gamepad. If the browser has `playPCM` and the gamepad supports it, the
 * samples are played; otherwise the two motors play the level and the mean frequency.
 */
export function playOnPad(pad, texture, options = {}) {
  const actuator = pad?.vibrationActuator;
  if (!actuator) throw new HtexError("playOnPad: the gamepad has no vibrationActuator; this browser or this gamepad has no haptics", "unsupported");
  checkTexture(texture, "playOnPad");
  return new PadPlayer(actuator, texture, checked(options, PLAYER, "playOnPad"));
}
