// Drives the motors and actuators of gamepads, either with two strengths from an envelope
// (`dual-rumble`) or with samples (`playPCM`).

import { HtexError } from "./core.js";
import { checkTexture } from "./guarded.js";
import { usualGain } from "./node.js";
import { checked } from "./options.js";

/** Strength of a motor for a level (RMS) of full scale. Strengths are limited to 1. */
const STRENGTH = 3;
/**
 * Mean frequencies, Hz. Up to the first one, only the large motor runs. From the second one on,
 * only the small motor runs. `htex_dsp::reduced` has the same values.
 */
const LARGE_MOTOR_HZ = 60;
const SMALL_MOTOR_HZ = 420;
/** Sample rate: the lowest that all browsers support in an AudioBuffer, Hz. */
const RATE = 8000;
/**
 * Duration that one message to the gamepad covers, seconds: first for two strengths, then for
 * samples. A browser may leave a gap between two blocks of samples.
 */
const RUMBLE_S = 0.05;
const SAMPLES_S = 0.25;
/** Number of blocks for which an effect lasts. It ends by itself if the page hangs. */
const HELD = 2;

const RUMBLE = { gain: "number", duration: "number" };
const PLAYER = { model: "string", seed: "integer", motion: "object", gain: "number" };

const unit = (x) => (Number.isNaN(x) ? 0 : Math.min(Math.max(x, 0), 1));

/**
 * Converts an envelope to the parameters of the effect "dual-rumble". `gain` is the strength for a
 * level of 1. `duration` is the effect's duration, ms.
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
    /** Resolves when the player was stopped. Rejects if the gamepad fails. */
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
   * Plays one block of samples. The promise of `playPCM` resolves when the samples have been
   * played. It resolves to `false` if the actuator cannot play samples.
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
    // The promise resolves when the effect ends, but the next effect starts earlier. So a failure
    // is noticed only at the next effect.
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
