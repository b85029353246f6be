/** Textures of touch in the browser and in Node.js: open, play and make them. */

/// <reference lib="esnext.disposable" />

export * from "./author.js";

import type { Contact, Law, Manifest, Quantity } from "./manifest.js";
import { NodeBase } from "./web.js";
import type { AudioContextLike, AudioParamLike, ElementLike, EventLike, Fetch } from "./web.js";

export type { Contact, Exponent, Law, Manifest, ManifestCondition, Quantity, Representation } from "./manifest.js";

/** Bytes in memory: an ArrayBuffer, or a view of one. */
export type Bytes = ArrayBuffer | ArrayBufferView;

/** An address: a string or a URL. */
export type Address = string | { readonly href: string };

/** A File, a Blob or a Response. */
export interface Readable {
  arrayBuffer(): Promise<ArrayBuffer>;
}

/** An error of the library. */
export class HtexError extends Error {
  readonly name: "HtexError";
  /**
   * The kind of error: "invalid-argument", "invalid-asset", "no-representation", "no-model",
   * "model", "invalid-motion", "bad-handle", "unsupported", "internal", "invalid-library",
   * "absent", "device", "io", "untrusted" and others.
   */
  readonly code: string;
}

/** Motion of a finger over a texture, at one moment. */
export interface Motion {
  /** Scanning speed, mm/s; finite and not negative. Default 0. */
  speed?: number;
  /** Normal force, N; finite and not negative. Default 0. */
  force?: number;
  /** Position along the finger's path, mm. Only models that follow the position use it. */
  position?: number;
  /**
   * Place on the surface, mm. Only models that map a surface use it. Give both coordinates or
   * neither.
   */
  x?: number;
  y?: number;
}

/** Requires a signature. A file that is not signed is refused with the code "not-signed". */
export interface Signed {
  /** Public keys in hexadecimal digits, of which one must have signed the file. */
  onlySignedBy?: string | string[];
  /**
   * The contents of the file with the signature (`oak.htex.sig`). Default: it is fetched from the
   * address of the file, with `.sig` behind the path.
   */
  signature?: Bytes;
}

/** A texture of a library (`cloth.htexlib#oak`) is signed if its library is. */
export interface OpenOptions extends Signed {
  /** Models as WASM modules. A module takes precedence over a built-in model with the same id. */
  modules?: Bytes[];
  /** Whether WASM modules that are embedded in the asset may run, in a sandbox. Default true. */
  embedded?: boolean;
  /**
   * Whether WASM modules may run in the calling thread and in the audio thread. There, nothing can
   * stop a call that does not return. Default false: modules run only in a worker, which `HtexNode`
   * and `GuardedWorker` use.
   */
  trusted?: boolean;
}

export interface VoiceOptions {
  /**
   * Id or short name of the model whose representation plays. Default: the representation with the
   * smallest error.
   */
  model?: string;
  /** Sample rate, Hz. Default 20000. */
  rate?: number;
  /**
   * Seed of the noise. Voices with equal seeds, options and motions give equal samples. Default 0.
   */
  seed?: number | bigint;
  /**
   * Motion at the start. Default: the first recorded condition, or the strongest one if the first
   * is silent.
   */
  motion?: Motion;
  /**
   * How samples are made. "streamed": the model computes each sample. "loop:SECONDS": a sound of
   * this length is computed once and repeated. "filter:TAPS": noise goes through a filter with this
   * number of taps. Default "streamed".
   */
  synthesis?: "streamed" | `loop:${number}` | `filter:${number}`;
  /** Whether frequencies keep changing at speeds outside the recorded range. Default true. */
  frequencyScaling?: boolean;
  /** Whether the level keeps changing at forces outside the recorded range. Default true. */
  levelScaling?: boolean;
  /** Whether the voice is silent while the finger is at rest. Default true. */
  contact?: boolean;
  /**
   * Highest level that the voice reaches at motions outside the recorded conditions, as a multiple
   * of the strongest recorded level. Positive and finite. Default 4.
   */
  ceiling?: number;
  /**
   * Whether the texture becomes stronger and weaker in time as its recording did, if it states how
   * much. Default false.
   */
  fluctuation?: boolean;
  /**
   * Gain of the samples. Default 1. An `HtexNode` does not use this option: its `gain` is an
   * AudioParam.
   */
  gain?: number;
  /**
   * Largest absolute value of a sample, in the texture's unit. The gain drops at once when a sample
   * would exceed it. Default: no limit.
   */
  limit?: number;
  /**
   * Number of bands that `Voice.envelope` returns, 1 to 32. Default 0: no envelope, which saves its
   * computing time.
   */
  bands?: number;
}

/** Samples that a node plays in a loop, such as the result of `author.recorded`. */
export interface Loop {
  /** The samples, in the unit of the recorded quantity. */
  readonly samples: Float32Array;
  readonly rate_hz: number;
  /** RMS of the samples. It determines the node's default gain. */
  readonly level_rms: number;
}

/**
 * Level and mean frequency of what a voice played since the last call, for phones, gamepads and
 * motors that receive a level and a frequency instead of samples.
 */
export interface Envelope {
  /** Exact RMS of the samples, in the texture's unit; 0 if there are none. */
  level: number;
  /**
   * Mean frequency of the spectrum, weighted by power, Hz; 0 for silence. It is computed from time
   * windows, so it is late by some 20 ms.
   */
  centroid: number;
  /** Number of samples since the last call. */
  frames: number;
  /** Mean square of the samples in each band, computed from the same windows. */
  bands: Float64Array;
}

export interface At {
  /** Id or short name of the model to use. Default: the representation with the smallest error. */
  model?: string;
  /**
   * The motion. The spectrum is interpolated between conditions. A speed or a force that is absent
   * is the default condition's. Default: the first recorded condition, or the strongest if the
   * first is silent.
   */
  at?: Motion;
}

/** A texture: an open asset (a .htex file). */
export class Texture {
  private constructor();
  /**
   * The asset's whole manifest: name, conditions, representations, measured errors and so on.
   */
  readonly manifest: Manifest;
  readonly name: string;
  /** Physical quantity of the samples, such as "lateral_force". */
  readonly quantity: Quantity;
  /** Unit of the samples, such as "N". */
  readonly unit: string;
  /** What slid over the surface. */
  readonly contact: Contact;
  /**
   * How frequencies and level change with speed and force outside the recorded conditions. If the
   * asset does not state this law, it is the usual one for its quantity and contact.
   */
  readonly law: Law;
  /** Lowest and highest frequency of the asset's spectra, Hz. */
  readonly band: [number, number];
  /** The recorded conditions; NaN where a speed or force is unknown. */
  readonly conditions: { speed: number; force: number }[];
  /** Ids of the models of the representations. */
  readonly models: string[];
  /**
   * Whether models may run as WASM modules: modules that were passed to `open`, or embedded ones.
   */
  readonly hasModules: boolean;
  /**
   * Index of the condition at which a representation plays if no motion is given: the first one, or
   * the strongest one if the first is silent. Default `model`: the representation with the smallest
   * error. Loads no model.
   */
  defaultCondition(model?: string): number;
  /**
   * Returns a motion with a speed and a force. What `at` lacks is the default condition's; if that
   * does not state it either, it is 80 mm/s or 0.4 N.
   */
  motion(at: Motion, model?: string): Motion & { speed: number; force: number };
  /**
   * Spectrum that a recording of the voice would show: one magnitude, in the texture's unit, for
   * each frequency in Hz.
   */
  spectrum(frequencies: ArrayLike<number>, options?: At): Float64Array;
  /**
   * Spectrum that a recording of the voice would show at a recorded condition, but without random
   * variation. Default `condition`: the result of `defaultCondition`. If the model plays sinusoids,
   * the spectrum is computed from 20 s of samples.
   */
  readSpectrum(options?: { model?: string; condition?: number }): { frequencies: Float64Array; magnitudes: Float64Array };
  /** Level at which a representation plays: RMS in the texture's unit. */
  level(options?: At): number;
  /** Parameters of a representation at a motion, by name. */
  parameters(options?: At): Record<string, number | number[]>;
  /**
   * Makes a voice, which runs in the calling thread. If its model is a WASM module, the texture
   * must have been opened with `trusted: true`.
   */
  voice(options?: VoiceOptions): Voice;
  /** Returns the bytes of the texture's file. */
  toBytes(): Uint8Array<ArrayBuffer>;
  /** Frees the memory of the texture. Its voices continue to play. */
  free(): void;
  [Symbol.dispose](): void;
}

/** How a speed or force relates to the recorded values. */
export interface Reach {
  /**
   * "inside": within the recorded range. "unknown": the asset does not state the recorded values.
   * "followed": the model itself follows the speed or force. "outside": the texture plays as at the
   * nearest recorded value, changed by its law.
   */
  kind: "inside" | "unknown" | "followed" | "outside";
  /** Only for "outside": the requested value, and the nearest recorded value. */
  asked?: number;
  recorded?: number;
}

/** How a motion relates to the recorded conditions, and how a voice plays it. */
export interface Coverage {
  /**
   * "silent": the finger does not slide. "inside": the texture plays as recorded, or interpolated
   * between recorded conditions. "followed": the model itself follows the motion. "outside": the
   * motion lies outside the recorded conditions.
   */
  kind: "silent" | "inside" | "followed" | "outside";
  /**
   * One English sentence that states how playback differs from the recording; empty if it does not
   * differ.
   */
  text: string;
  inside: boolean;
  slides: boolean;
  /** Relative difference between the requested motion and the motion that is actually played. */
  excess: number;
  /** Factors that multiply all frequencies (`frequencyFactor`) and the level (`levelFactor`). */
  frequencyFactor: number;
  levelFactor: number;
  /** Speed, mm/s, and normal force, N. */
  speed: Reach;
  force: Reach;
}

/** A voice: a texture that is playing. */
export class Voice {
  private constructor();
  /**
   * Sets the motion: speed (mm/s), force (N), position along the path (mm), and place (mm).
   * Spectrum and level change gradually to the new motion.
   */
  setMotion(speed: number, force: number, position?: number, x?: number, y?: number): void;
  /**
   * Renders the next `frames` samples, in the texture's unit. Rendering in shorter or longer blocks
   * gives the same samples.
   */
  render(frames: number): Float32Array;
  /** Renders the next samples into an existing array. Does not allocate. */
  render(out: Float32Array): Float32Array;
  /** Renders a block of `frames` samples at each of the motions. */
  renderPath(
    speeds: ArrayLike<number>,
    forces: ArrayLike<number>,
    frames: number,
    positions?: ArrayLike<number>,
    xs?: ArrayLike<number>,
    ys?: ArrayLike<number>,
  ): Float32Array;
  /** Id of the model that plays. */
  readonly model: string;
  /** Whether the voice is silent: its samples are 0 until the finger slides again. */
  readonly isSilent: boolean;
  /** Sets the gain. The voice reaches the new gain within 10 ms. */
  setGain(gain: number): void;
  /** Restarts the voice. It then gives the same samples as a new voice with the same options. */
  reset(): void;
  /**
   * Returns the level and mean frequency of what was rendered since the last call. If `bands` is
   * given, the mean square in each band is written to it.
   */
  envelope(bands?: Float64Array): Envelope;
  /**
   * Edges of the bands, Hz. There is one edge more than bands, and they are spaced by equal ratios.
   * The first band also includes everything below, down to 0 Hz. The last band also includes
   * everything above, up to half the sample rate.
   */
  readonly envelopeEdges: Float64Array;
  /**
   * Returns how the voice plays a motion, and whether the motion lies within the recorded
   * conditions. Default: the voice's current motion.
   */
  coverage(motion?: Motion): Coverage;
  /**
   * Returns the spectrum that a recording of the voice would show at its current motion: one
   * magnitude, in the texture's unit, for each frequency in Hz. The magnitudes include the gain.
   */
  spectrum(frequencies: ArrayLike<number>): Float64Array;
  /** Frees the memory of the voice. */
  free(): void;
  [Symbol.dispose](): void;
}

/**
 * Opens a texture from its bytes, a File, a Blob, a Response, or its address. The address
 * `cloth.htexlib#woven/cotton` is the texture `woven/cotton` of a library.
 */
export function open(source: Bytes | Readable | Address, options?: OpenOptions): Promise<Texture>;

/** A range of values: minimum and maximum. */
export interface Interval {
  min: number;
  max: number;
}

/** What a library states about a texture. */
export interface LibraryEntry {
  /** Name in the library. `/` separates the parts of a name. */
  name: string;
  tags: string[];
  /** Recorded speeds, mm/s, and forces, N; absent if unknown. */
  conditions: { speed_mm_s?: Interval; force_n?: Interval };
  /** What slid over the surface. */
  contact: "finger" | "tool" | "unknown";
  /**
   * The law: exponents that state how frequencies and level change with speed and force outside the
   * recorded conditions.
   */
  law: Law;
  /** Ids of the models of the representations. */
  models: string[];
  /** Licence and author; absent if the texture states none, or in a library of version 1.0. */
  license?: string;
  author?: string;
  /** Physical quantity of the samples; absent in a library of version 1.0. */
  quantity?: Quantity;
  /** Felt difference from the recordings, RMS over third octaves, dB; absent if it is not known. */
  felt_error_rms_db?: number;
  /** Held-out error, RMS over third octaves, dB; absent if the texture does not state it. */
  held_out_error_db?: number;
  /** Size of the texture's file, bytes. */
  bytes: number;
  /** BLAKE3 hash of the texture's file, hexadecimal. */
  blake3: string;
}

/** What a library says about itself. */
export interface LibraryMetadata {
  version?: string;
  description?: string;
  authors?: string[];
  homepage?: string;
  source?: string;
  changelog?: string;
  /** Date of the version: `YYYY-MM-DD`. */
  date?: string;
}

/** Criteria that a texture must meet to be found. Absent criteria are ignored. */
export interface LibraryQuery {
  /** Words to find in the name or in a tag, ignoring case. All words must match. */
  words?: string[];
  /** Tags that the texture must have, ignoring case. */
  tags?: string[];
  /** A speed (mm/s) and a force (N) that must lie within the recorded range. */
  speed?: number;
  force?: number;
  /** Id or short name of a model that the texture must have. */
  model?: string;
  /** Licence and author that the texture must have, ignoring case. `*` stands for any text. */
  license?: string;
  author?: string;
  quantity?: Quantity;
  /** Largest felt difference from the recordings, dB. */
  felt?: number;
  /** Largest held-out error, dB. */
  held_out?: number;
}

/**
 * A library: one `.htexlib` file with thousands of textures. Only the byte ranges that are needed
 * are fetched.
 */
export class Library {
  private constructor();
  /**
   * Opens a library from its address, its bytes, or a File or Blob. From an address, File or Blob,
   * only the ranges that are needed are read. `fetch` replaces the global function, for example to
   * add headers to the requests for ranges. With `onlySignedBy`, one of the keys must have signed
   * the library; this reads the whole index.
   */
  static open(source: Bytes | Readable | Address, options?: { fetch?: Fetch } & Signed): Promise<Library>;
  /** Name of the library; may be empty. */
  readonly name: string;
  /** What the library says about itself. */
  readonly metadata: LibraryMetadata;
  /** BLAKE3 hash of the index, hexadecimal. It names the library. */
  readonly blake3: string;
  /** Number of textures. */
  readonly count: number;
  /**
   * Returns the entries of all textures, in ascending order of their names. Reads 1 MiB of the
   * index at once.
   */
  entries(): AsyncGenerator<LibraryEntry>;
  /** Returns the entries that match a query. Reads 1 MiB of the index at once. */
  find(query: LibraryQuery): AsyncGenerator<LibraryEntry>;
  /** Returns the entry of a texture; undefined if there is no texture with this name. */
  entry(name: string): Promise<LibraryEntry | undefined>;
  /**
   * Returns the bytes of a texture's `.htex` file. Fails with an HtexError with the code "absent"
   * if there is no texture with this name.
   */
  bytes(name: string): Promise<Uint8Array>;
  /**
   * Opens a texture. This makes two requests, or one if the page of the index with the texture is
   * already known.
   */
  texture(name: string, options?: Omit<OpenOptions, keyof Signed>): Promise<Texture>;
  /** Frees the memory of the library. Its textures stay open. */
  free(): void;
  [Symbol.dispose](): void;
}

/**
 * Sets where the WASM library comes from: the address of `htex.wasm`, its bytes, or the compiled
 * module (a `WebAssembly.Module`). If a page keeps its files elsewhere, also set the addresses of
 * `processor.js` and `worker.js`. Call this before the first `open`.
 */
export function setLibrary(library: Address | Bytes | object | undefined, addresses?: { processor?: Address; worker?: Address }): void;

/**
 * Prepares an audio context for nodes. Await this before `new HtexNode`. The page must come from
 * https or localhost.
 */
export function prepare(context: AudioContextLike): Promise<void>;

export interface LoadOptions extends Omit<VoiceOptions, "rate"> {
  /**
   * Whether models in WASM modules may run in the audio thread. There, a call that does not return
   * stops all sound. Default: only if the texture was opened with `trusted: true`. Otherwise the
   * modules run in a worker, and their samples come 32 ms later.
   */
  trusted?: boolean;
  /**
   * Factor that converts samples in the texture's unit to fractions of full scale. Default: the
   * factor that gives an RMS of 0.1 (-20 dB) at the default condition. If you changed the gain,
   * `load` keeps the ratio between your gain and the default.
   */
  gain?: number;
  /**
   * Number of bands in the envelopes that are passed to `onenvelope`, 1 to 32. Default 0: no
   * envelopes.
   */
  bands?: number;
}

export interface NodeOptions extends LoadOptions {
  /**
   * Motion at the start. Default: the finger is at rest, and the node is silent until `speed` and
   * `force` are set.
   */
  motion?: Motion;
  /** A worker that several nodes share. */
  worker?: GuardedWorker;
  /** Longest allowed call of a WASM module in the worker, ms. Default 2000. */
  limit?: number;
  /**
   * Factor that multiplies all frequencies, for loudspeakers that cannot play low frequencies. Must
   * be positive. Default 1: the frequencies that a finger feels.
   */
  pitch?: number;
}

/**
 * An audio node that plays a texture. It fades in at the start and out at the end. If it fails, it
 * fires an event `error`, whose property `error` is an HtexError.
 */
export class HtexNode extends NodeBase {
  constructor(context: AudioContextLike, texture: Texture, options?: NodeOptions);
  /** Scanning speed, mm/s. */
  readonly speed: AudioParamLike;
  /** Normal force, N. */
  readonly force: AudioParamLike;
  /** Factor that converts the texture's unit to full scale. */
  readonly gain: AudioParamLike;
  /** Position along the finger's path, mm. Only models that follow the position use it. */
  set position(position: number);
  /**
   * Place on the surface, mm; null if unknown. Only models that map a surface use it, such as
   * friction maps.
   */
  set place(place: { x: number; y: number } | null);
  /**
   * Fades to another texture within 20 ms. Resolves when the fade has begun. If several calls are
   * made at the same time, only the last one takes effect.
   */
  load(texture: Texture, options?: LoadOptions): Promise<void>;
  /**
   * Fades to a recording. While the finger slides, the recording plays unchanged at any speed and
   * force.
   */
  load(loop: Loop, options?: { gain?: number }): Promise<void>;
  /** Resolves when the node's voice has been made. */
  readonly ready: Promise<void>;
  /**
   * Called if the node fails, with the error. The node is silent afterwards. Errors of the audio
   * worklet itself are also passed to it.
   */
  onerror: ((event: EventLike & { readonly error: HtexError }) => void) | null;
  /**
   * Called about every 20 ms with the envelope of what was played, in the texture's unit and before
   * the gain. It is called only if the node has `bands`.
   */
  onenvelope: ((envelope: Envelope) => void) | null;
  /** Edges of the bands, Hz. There is one edge more than bands. */
  readonly envelopeEdges: Float64Array;
  /** The error that made the node silent; absent if there was none. */
  readonly error?: HtexError;
  /** Number of samples that the worker did not deliver in time. */
  readonly missed: number;
  /** Fades out within 10 ms and frees the voice. The node cannot be used again. */
  stop(): void;
  [Symbol.dispose](): void;
}

/**
 * A worker that renders voices of untrusted models. It is terminated if a call takes too long. In
 * Node.js the worker is a thread. While it has nothing to do, it does not keep the program running.
 */
export class GuardedWorker {
  /** `limit`: longest allowed call, ms. Default 2000. */
  constructor(options?: { limit?: number });
  /** Renders the first samples of a new voice, in the texture's unit. */
  render(texture: Texture, frames: number, options?: VoiceOptions): Promise<Float32Array>;
  /** Ends the worker. */
  end(): void;
  [Symbol.dispose](): void;
}

/** A gamepad from `navigator.getGamepads()`, reduced to the parts that are used here. */
export interface PadLike {
  readonly vibrationActuator?: ActuatorLike | null;
}

/** The vibration actuator of a gamepad. */
export interface ActuatorLike {
  playEffect(type: "dual-rumble", effect: RumbleEffect): Promise<unknown>;
  reset?(): Promise<unknown>;
  /**
   * Plays samples. Only some browsers have this function. Resolves to false if the gamepad does not
   * support it.
   */
  playPCM?(sound: any): Promise<boolean>;
}

/**
 * Parameters of the effect "dual-rumble": times in ms, and strengths from 0 to 1 for the large and
 * the small motor.
 */
export interface RumbleEffect {
  startDelay: number;
  duration: number;
  strongMagnitude: number;
  weakMagnitude: number;
}

/**
 * Converts an envelope to the strengths of a gamepad's two motors. Up to a mean frequency of 60 Hz,
 * only the large motor runs. From 420 Hz, only the small motor runs. `gain` is the strength for a
 * level of 1, and strengths are limited to 1. Default 3, for levels in fractions of full scale.
 * `duration` is the duration of the effect, ms. Default 100.
 */
export function dualRumble(envelope: { readonly level: number; readonly centroid: number }, options?: { gain?: number; duration?: number }): RumbleEffect;

export interface PadOptions {
  /** Id or short name of the model to use. Default: the representation with the smallest error. */
  model?: string;
  /** Seed of the noise. Default 0. */
  seed?: number | bigint;
  /** Motion at the start. Default: the finger is at rest until `setMotion` is called. */
  motion?: Motion;
  /**
   * Factor that converts samples in the texture's unit to fractions of full scale. Default: the
   * factor that gives an RMS of 0.1 at the default condition.
   */
  gain?: number;
}

/** A texture that plays on a gamepad. */
export interface PadPlayer {
  /**
   * How the texture is played: as samples ("pcm"), or as the strengths of two motors every 50 ms
   * ("dual-rumble").
   */
  readonly way: "pcm" | "dual-rumble";
  /**
   * Sets the motion: speed (mm/s), force (N), position along the path (mm), and place (mm). Samples
   * follow the motion up to 0.25 s later, strengths up to 50 ms later.
   */
  setMotion(speed: number, force: number, position?: number, x?: number, y?: number): void;
  /** Stops the motors and frees the voice. */
  stop(): Promise<void>;
  /** Resolves when the player was stopped. Rejects with an HtexError if the gamepad fails. */
  readonly ended: Promise<void>;
}

/**
 * Plays a texture on a gamepad until `stop` is called. If the browser has `playPCM` and the gamepad
 * supports it, the gamepad plays the samples. The browser may then leave a gap between blocks of
 * 0.25 s. Otherwise the two motors play the level and the mean frequency.
 */
export function playOnPad(pad: PadLike, texture: Texture, options?: PadOptions): PadPlayer;

export interface PointerOptions {
  /** Size of a CSS pixel, mm. Default 25.4 / 96. */
  mmPerPixel?: number;
  /**
   * Converts a pressure that the device measures, 0 to 1, to a force in N. Default: 0.8 times the
   * pressure.
   */
  force?: (pressure: number) => number;
  /**
   * Force, N, for a mouse, and for a device that reports no pressures except 0, 0.5 and 1. Default
   * 0.4.
   */
  defaultForce?: number;
}

/**
 * Calls `moved` with the motion of a pointer over an element. Only one pointer is followed at a
 * time, and a mouse only while its primary button is pressed. While this lasts, the element has the
 * style `touch-action: none`. Returns a function that stops following. Throws an HtexError if
 * `element` is `null`, which `querySelector` returns if nothing matches.
 */
export function followPointer(
  element: ElementLike | null,
  moved: (motion: { speed: number; force: number; position: number; x: number; y: number }) => void,
  options?: PointerOptions,
): () => void;

/**
 * Makes a node follow a pointer over an element, and resumes its audio context on the first press.
 * Returns a function that stops following. Throws an HtexError if `element` is `null`, which
 * `querySelector` returns if nothing matches.
 */
export function follow(element: ElementLike | null, node: HtexNode, options?: PointerOptions): () => void;
