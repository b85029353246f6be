// Textures and their voices.

import { BLOCK, HtexError, MOTION, toBytes, writeMotion } from "./core.js";
import { GRID_HZ, measured } from "./measured.js";
import { AT, READ, VOICE, checked, checkedMotion } from "./options.js";

/** Frees objects that their owner did not free. */
const abandoned =
  typeof FinalizationRegistry === "undefined" ? null : new FinalizationRegistry(({ core, free, id }) => core.exports[free](id));

/**
 * For models that play sinusoids, spectra are computed from samples: the duration of these samples,
 * seconds, and their seed.
 */
const READ_S = 20;
const READ_SEED = 1;

/** An object with a handle in the library. */
export class Handle {
  constructor(core, id, free) {
    this.core = core;
    this.id = id;
    this.freeing = free;
    abandoned?.register(this, { core, free, id }, this);
  }

  /**
   * Frees the memory of the object. The object cannot be used afterwards. A second call does
   * nothing.
   */
  free() {
    if (this.isFreed) return;
    this.isFreed = true;
    abandoned?.unregister(this);
    this.core.call(this.freeing, this.id);
  }
}

if (Symbol.dispose) {
  Handle.prototype[Symbol.dispose] = function () {
    this.free();
  };
}

/**
 * Default options of `open`: whether WASM modules may run in this thread, the modules that were
 * passed in, and whether the asset's embedded modules may run.
 */
const ALL_RUN = { trusted: true, modules: [], embedded: true };

/** A texture: an open asset (a .htex file). */
export class Texture extends Handle {
  constructor(core, data, options = ALL_RUN, signed = {}) {
    const bytes = toBytes(data);
    const id = core.scope((take) => {
      const at = core.put(take, bytes);
      const given = { ...options, ...signed, modules: options.trusted ? options.modules : [] };
      core.call("htex_asset_from_bytes", at, bytes.length, core.putOpenOptions(take, given), core.results);
      return core.view().getBigUint64(core.results, true);
    });
    super(core, id, "htex_asset_free");
    this.options = options;
  }

  /**
   * Whether models may run as WASM modules: modules that were passed to `open`, or embedded ones.
   */
  get hasModules() {
    const { modules, embedded } = this.options;
    return modules.length > 0 || (embedded && (this.manifest.plugins ?? []).length > 0);
  }

  /** Throws if the model of a representation is a WASM module that may not run in this thread. */
  guard(model, call) {
    const { trusted, modules, embedded } = this.options;
    if (trusted || !this.hasModules) return;
    const chosen = this.chosenModel(model);
    if (modules.length === 0 && !(embedded && this.manifest.plugins.some((plugin) => plugin.model === chosen))) return;
    const advice = "play it with HtexNode or with `new GuardedWorker().render(texture, frames, options)`, or, if you trust its author, open it with `open(bytes, { trusted: true })`";
    throw new HtexError(`${call}: the model ${chosen} comes from a module, which nothing could stop in this thread; ${advice}`, "untrusted");
  }

  /**
   * Returns the model id of the representation that `model` selects. Default: the representation
   * that a voice would choose.
   */
  chosenModel(model) {
    const { core } = this;
    return core.scope((take) => core.text("htex_asset_chosen_model", this.id, core.putText(take, model)));
  }

  /** Returns the bytes of the texture's file. */
  toBytes() {
    return this.bytes.slice();
  }

  /**
   * The asset's whole manifest: name, conditions, representations, measured errors and so on.
   */
  get manifest() {
    this.read ??= JSON.parse(this.core.text("htex_asset_manifest_json", this.id));
    return this.read;
  }

  get name() {
    return this.manifest.name;
  }

  /** Unit of the samples, such as "N". */
  get unit() {
    return this.core.text("htex_asset_unit", this.id);
  }

  /** Physical quantity of the samples, such as "lateral_force". */
  get quantity() {
    return this.manifest.quantity;
  }

  /** What slid over the surface. */
  get contact() {
    return this.manifest.contact ?? "unknown";
  }

  /**
   * The law: how frequencies and level change with speed and force outside the recorded conditions.
   */
  get law() {
    return JSON.parse(this.core.text("htex_asset_law_json", this.id));
  }

  /** Lowest and highest frequency of the spectra, Hz. */
  get band() {
    this.core.call("htex_asset_band", this.id, this.core.results);
    const view = this.core.view();
    return [view.getFloat64(this.core.results, true), view.getFloat64(this.core.results + 8, true)];
  }

  /** The recorded conditions: speed in mm/s and force in N, or NaN where one is unknown. */
  get conditions() {
    const known = (x) => x ?? NaN;
    return this.manifest.conditions.map((c) => ({ speed: known(c.speed_mm_s), force: known(c.force_n) }));
  }

  /** Ids of the models of the representations. */
  get models() {
    return this.manifest.representations.map((representation) => representation.model);
  }

  /**
   * Returns the index of the condition at which a representation plays if no motion is given: the
   * first one, or the strongest one if the first is silent.
   */
  defaultCondition(model) {
    const { core } = this;
    return core.scope((take) => {
      core.call("htex_asset_default_condition", this.id, core.putText(take, model), core.results);
      return core.view().getUint32(core.results, true);
    });
  }

  /** Returns a motion with a speed and a force; what `at` lacks is the default condition's. */
  motion(at, model) {
    if (at.speed !== undefined && at.force !== undefined) return at;
    const { speed_mm_s = 80, force_n = 0.4 } = this.manifest.conditions[this.defaultCondition(model)] ?? {};
    return { ...at, speed: at.speed ?? speed_mm_s, force: at.force ?? force_n };
  }

  /**
   * Returns the spectrum that a recording of the voice would show: one magnitude, in the texture's
   * unit, for each frequency in Hz.
   */
  spectrum(frequencies, options = {}) {
    const { core } = this;
    return this.represented(options, "texture.spectrum", (take, name, motion) => {
      const numbers = core.putNumbers(take, frequencies);
      core.call("htex_asset_magnitude", this.id, name, motion, numbers, numbers, frequencies.length);
      return new Float64Array(core.exports.memory.buffer, numbers, frequencies.length).slice();
    });
  }

  /**
   * Returns the spectrum that a recording of the voice would show at a recorded condition:
   * frequencies in Hz, and magnitudes in the texture's unit.
   */
  readSpectrum(options = {}) {
    const { model, condition = this.defaultCondition(options.model) } = checked(options, READ, "texture.readSpectrum");
    if (!this.manifest.conditions[condition]) {
      const last = this.manifest.conditions.length - 1;
      throw new HtexError(`texture.readSpectrum: there is no condition ${condition}; they are 0 to ${last}`, "invalid-argument");
    }
    this.guard(model, "texture.readSpectrum");
    const frequencies = this.grid;
    try {
      return { frequencies, magnitudes: this.readMagnitudes(model, condition, frequencies) };
    } catch (error) {
      // If the model plays sinusoids, the spectrum can only be computed from samples.
      if (error.code !== "unsupported") throw error;
      return { frequencies, magnitudes: this.readSamples(model, condition, frequencies) };
    }
  }

  readMagnitudes(model, condition, frequencies) {
    const { core } = this;
    return core.scope((take) => {
      const numbers = core.putNumbers(take, frequencies);
      core.call("htex_asset_read_magnitude", this.id, core.putText(take, model), condition, numbers, frequencies.length);
      return new Float64Array(core.exports.memory.buffer, numbers, frequencies.length).slice();
    });
  }

  readSamples(model, condition, frequencies) {
    const { speed_mm_s: speed, force_n: force } = this.manifest.conditions[condition];
    const motion = speed > 0 && force > 0 ? { speed, force } : undefined;
    const rate = 4 * frequencies.at(-1);
    const voice = this.voice({ model, rate, seed: READ_SEED, motion, contact: false });
    const samples = voice.render(READ_S * rate);
    voice.free();
    return measured(samples, rate, frequencies);
  }

  /** The frequencies of the spectra, Hz. */
  get grid() {
    const [low, high] = this.band;
    const [first, last] = [Math.max(1, Math.ceil(low / GRID_HZ - 1e-9)), Math.floor(high / GRID_HZ + 1e-9)];
    return Float64Array.from({ length: last - first + 1 }, (_, i) => GRID_HZ * (first + i));
  }

  /** Returns the level at which a representation plays: RMS in the texture's unit. */
  level(options = {}) {
    const { core } = this;
    return this.represented(options, "texture.level", (take, name, motion) => {
      core.call("htex_asset_level_rms", this.id, name, motion, core.results);
      return core.view().getFloat64(core.results, true);
    });
  }

  /** Returns the parameters of a representation, by name. */
  parameters(options = {}) {
    const { core } = this;
    const read = (take, name, motion) => JSON.parse(core.text("htex_asset_parameters_json", this.id, name, motion));
    return this.represented(options, "texture.parameters", read);
  }

  /** Runs `read` with the model's name and a motion in an arena's memory. */
  represented(options, call, read) {
    const { model, at } = checked(options, AT, call);
    this.guard(model, call);
    const { core } = this;
    const motion = at && this.motion(at, model);
    return core.scope((take) => read(take, core.putText(take, model), core.putMotion(take, motion)));
  }

  /** Makes a voice, which plays the texture. */
  voice(options = {}) {
    return new Voice(this, options);
  }
}

/** A voice: a texture that is playing. */
export class Voice extends Handle {
  constructor(texture, options) {
    const { core } = texture;
    checked(options, VOICE, "texture.voice");
    texture.guard(options.model, "texture.voice");
    const id = core.scope((take) => {
      core.call("htex_voice_new", texture.id, core.putVoiceOptions(take, options), core.results);
      return core.view().getBigUint64(core.results, true);
    });
    super(core, id, "htex_voice_free");
    this.bands = options.bands ?? 0;
  }

  /** Id of the model that plays. */
  get model() {
    return this.core.text("htex_voice_model", this.id);
  }

  /** Sets the gain. The voice reaches the new gain within 10 ms. */
  setGain(gain) {
    this.core.call("htex_voice_set_gain", this.id, gain);
  }

  /** Whether the voice is silent: its samples are 0 until the finger slides again. */
  get isSilent() {
    const { core } = this;
    core.call("htex_voice_is_silent", this.id, core.results);
    return core.view().getUint32(core.results, true) !== 0;
  }

  /** Restarts the voice. It then gives the same samples as a new voice with the same options. */
  reset() {
    this.core.call("htex_voice_reset", this.id, 0);
  }

  /**
   * Returns the envelope of what was rendered since the last call: the level (RMS, in the texture's
   * unit), the mean frequency (Hz), and the mean square in each of the voice's bands.
   */
  envelope(bands = new Float64Array(this.bands)) {
    return this.core.envelope(this.id, bands);
  }

  /** Edges of the bands, Hz. There is one edge more than bands. */
  get envelopeEdges() {
    const { core } = this;
    const count = this.bands > 0 ? this.bands + 1 : 0;
    core.call("htex_voice_envelope_edges", this.id, core.results, count);
    return new Float64Array(core.exports.memory.buffer, core.results, count).slice();
  }

  /**
   * Sets the motion of the finger: speed in mm/s, force in N and, if known, the position along the
   * path and the place on the surface in mm.
   */
  setMotion(speed, force, position = NaN, x = NaN, y = NaN) {
    const { core } = this;
    writeMotion(core.view(), core.results, { speed, force, position, x, y });
    core.call("htex_voice_set_motion", this.id, core.results);
  }

  /**
   * Renders the next samples, in the texture's unit. `out` is a Float32Array to fill, or the length
   * of a new one. Does not allocate if an array is passed in.
   */
  render(out) {
    if (typeof out === "number") {
      if (!Number.isInteger(out) || out < 0) throw new HtexError(`${out} frames; give a whole number`, "invalid-argument");
      out = new Float32Array(out);
    }
    if (!(out instanceof Float32Array)) throw new HtexError("give a Float32Array, or a number of frames", "invalid-argument");
    const { core } = this;
    for (let from = 0; from < out.length; from += BLOCK) {
      out.set(core.render(this.id, Math.min(BLOCK, out.length - from)), from);
    }
    return out;
  }

  /**
   * Renders a block of `frames` samples at each motion, given as arrays of speeds, forces and,
   * optionally, positions and places (x and y).
   */
  renderPath(speeds, forces, frames, positions, xs, ys) {
    const { core } = this;
    const count = speeds.length;
    if ([forces, positions, xs, ys].some((numbers) => numbers && numbers.length !== count)) {
      throw new HtexError("the arrays of the motion differ in length", "invalid-argument");
    }
    return core.scope((take) => {
      const motions = take(MOTION * Math.max(count, 1));
      const view = core.view();
      for (let i = 0; i < count; i++) {
        const motion = { speed: speeds[i], force: forces[i], position: positions?.[i], x: xs?.[i], y: ys?.[i] };
        writeMotion(view, motions + MOTION * i, motion);
      }
      const out = take(Math.max(4 * count * frames, 8));
      core.call("htex_voice_render_path", this.id, motions, count, out, frames);
      return new Float32Array(core.exports.memory.buffer, out, count * frames).slice();
    });
  }

  /**
   * Returns how the voice plays a motion, and whether the motion lies within the recorded
   * conditions. Default: the voice's current motion.
   */
  coverage(motion) {
    const { core } = this;
    checkedMotion(motion, "voice.coverage");
    const json = core.scope((take) => core.text("htex_voice_coverage_json", this.id, core.putMotion(take, motion)));
    return JSON.parse(json);
  }

  /**
   * Returns the spectrum that a recording of the voice would show at its current motion: one
   * magnitude, in the texture's unit, for each frequency in Hz.
   */
  spectrum(frequencies) {
    const { core } = this;
    return core.scope((take) => {
      const numbers = core.putNumbers(take, frequencies);
      core.call("htex_voice_magnitude", this.id, numbers, numbers, frequencies.length);
      return new Float64Array(core.exports.memory.buffer, numbers, frequencies.length).slice();
    });
  }
}
