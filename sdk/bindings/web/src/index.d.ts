/** Touch textures in the browser and in Node.js. */

/// <reference lib="esnext.disposable" />

export * from "./author.js";

import type { Contact, Law, Manifest, Quantity } from "./manifest.js";
import { NodeBase } from "./web.js";
import type { AudioContextLike, AudioParamLike, ElementLike, EventLike, Fetch } from "./web.js";

export type { Contact, Exponent, Law, Manifest, ManifestCondition, Quantity, Representation } from "./manifest.js";

/** Bytes. */
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
  /** Position along the path, mm, for models that follow it. */
  position?: number;
  /**
   * Place on the surface, mm, for models that are maps of the surface. Give both coordinates or
   * neither.
   */
  x?: number;
  y?: number;
}

export interface OpenOptions {
  /** WASM modules of models. They take precedence over the built-in ones. */
  modules?: Bytes[];
  /** Whether models embedded in the asset may run, in a sandbox. Default true. */
  embedded?: boolean;
  /**
   * Whether modules may run in the calling thread and in the audio thread, where nothing can stop a
   * call that does not return. Default false: they play in a worker, through `HtexNode` and
   * `GuardedWorker`.
   */
  trusted?: boolean;
}

export interface VoiceOptions {
  /**
   * The model of the representation, by its id or short name. Default: the representation with the
   * smallest error.
   */
  model?: string;
  /** Sample rate, Hz. Default 20000. */
  rate?: number;
  /** Seed of the noise: equal seeds give equal samples. Default 0. */
  seed?: number | bigint;
  /**
   * Motion at the start. Default: the first recorded condition, or the strongest if the first is
   * silent.
   */
  motion?: Motion;
  /** How samples are made. Default "streamed". */
  synthesis?: "streamed" | `loop:${number}` | `filter:${number}`;
  /** Whether frequencies follow speeds beyond the recorded ones. Default true. */
  frequencyScaling?: boolean;
  /** Whether the level follows forces beyond the recorded ones. Default true. */
  levelScaling?: boolean;
  /** Whether a finger at rest is silent. Default true. */
  contact?: boolean;
  /**
   * Ceiling of the level at motions outside the recorded ones, as a multiple of the strongest
   * recorded level: above 0 and finite. Default 4.
   */
  ceiling?: number;
  /**
   * Gain of the samples. Default 1. Not available for an `HtexNode`, whose `gain` is an AudioParam.
   */
  gain?: number;
  /**
   * Largest absolute value of a sample, in the texture's unit. The gain drops at once when a sample
   * would exceed it. Default: no limit.
   */
  limit?: number;
  /** Number of bands in `Voice.envelope`, 1 to 32. Default 0: no envelope, which costs no time. */
  bands?: number;
}

/** Samples that a node plays in a loop, such as the result of `author.recorded`. */
export interface Loop {
  /** In the unit of the recorded quantity. */
  readonly samples: Float32Array;
  readonly rate_hz: number;
  /** RMS of the samples. The default gain is set by it. */
  readonly level_rms: number;
}

/**
 * What a voice played since the last call, for phones, pads and motors that are driven by level and
 * frequency.
 */
export interface Envelope {
  /** Exact RMS of the samples, in the texture's unit; 0 if there are none. */
  level: number;
  /**
   * Mean frequency, weighted by power, Hz; 0 for silence. It is computed from windows that lag by
   * some 20 ms.
   */
  centroid: number;
  /** Number of samples. */
  frames: number;
  /** Mean square in each band, computed from the same windows. */
  bands: Float64Array;
}

export interface At {
  /** The model of the representation. Default: the representation with the smallest error. */
  model?: string;
  /**
   * The motion. The spectrum is interpolated between conditions. Default: the first recorded
   * condition, or the strongest if the first is silent.
   */
  at?: Motion;
}

/** A texture asset. */
export class Texture {
  private constructor();
  /**
   * The manifest: name, conditions, representations, qualities and everything else that the asset
   * states.
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
   * How frequencies and level follow a motion outside the recorded ones: as the asset states, or as
   * assumed for its quantity and contact.
   */
  readonly law: Law;
  /** Lowest and highest frequency of the spectra, Hz. */
  readonly band: [number, number];
  /** The recorded conditions; NaN where a speed or force is unknown. */
  readonly conditions: { speed: number; force: number }[];
  /** Ids of the models of the representations. */
  readonly models: string[];
  /** Whether models in modules may run. */
  readonly hasModules: boolean;
  /**
   * Index of the condition at which a representation is played when no motion is given: its first,
   * or its strongest if the first is silent. The default representation is the one with the
   * smallest error. Loads no model.
   */
  defaultCondition(model?: string): number;
  /** Magnitudes of the texture's spectrum, in its unit, at frequencies in Hz. */
  spectrum(frequencies: ArrayLike<number>, options?: At): Float64Array;
  /**
   * Magnitudes at a recorded condition (default: the default condition), as a recording of the
   * voice would show them, but without random variation. For sums of sinusoids they are computed
   * from 20 s of samples.
   */
  readSpectrum(options?: { model?: string; condition?: number }): { frequencies: Float64Array; magnitudes: Float64Array };
  /** Level of a representation: RMS in the texture's unit. */
  level(options?: At): number;
  /** Parameters of a representation at a motion, by name. */
  parameters(options?: At): Record<string, number | number[]>;
  /**
   * Makes a voice, which runs in this thread. If its model is a module, the texture must have been
   * opened as `trusted`.
   */
  voice(options?: VoiceOptions): Voice;
  /** The bytes of the file. */
  toBytes(): Uint8Array<ArrayBuffer>;
  /** Frees the memory of the texture. Its voices continue to play. */
  free(): void;
  [Symbol.dispose](): void;
}

/** How a speed or force relates to the recorded values. */
export interface Reach {
  /**
   * "followed": the model follows it by itself. "outside": the texture follows its law from the
   * nearest recorded value.
   */
  kind: "inside" | "unknown" | "followed" | "outside";
  /** The requested value and the nearest recorded one, for "outside". */
  asked?: number;
  recorded?: number;
}

/** How a motion relates to the recorded conditions, and how a voice plays it. */
export interface Coverage {
  /** "silent": the finger does not slide. "inside": as recorded, or interpolated. */
  kind: "silent" | "inside" | "followed" | "outside";
  /** One sentence in English; empty if nothing differs from the recording. */
  text: string;
  inside: boolean;
  slides: boolean;
  /** Relative difference between the motion and the one that is actually played. */
  excess: number;
  /** Factors that multiply all frequencies, and the level. */
  frequencyFactor: number;
  levelFactor: number;
  /** Speed, mm/s, and normal force, N. */
  speed: Reach;
  force: Reach;
}

/** A voice: a texture that plays. */
export class Voice {
  private constructor();
  /**
   * Sets the motion: mm/s, N, mm along the path, and the place in mm. Spectrum and level change
   * gradually.
   */
  setMotion(speed: number, force: number, position?: number, x?: number, y?: number): void;
  /** Renders the next samples, in the texture's unit. They do not depend on the block lengths. */
  render(frames: number): Float32Array;
  /** The same, into an existing array and without allocating. */
  render(out: Float32Array): Float32Array;
  /** Renders a block of `frames` samples at each motion. */
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
  /** Sets the gain. The change takes 10 ms. */
  setGain(gain: number): void;
  /** Restarts the voice as it was when it was made. */
  reset(): void;
  /**
   * Returns what was rendered since the last call. The bands are written to the array, if one is
   * given.
   */
  envelope(bands?: Float64Array): Envelope;
  /**
   * Edges of the bands, Hz: one more than there are bands, spaced by equal ratios. The first band
   * also includes everything down to 0 Hz, and the last everything up to half the sample rate.
   */
  readonly envelopeEdges: Float64Array;
  /**
   * Returns how the voice plays a motion, or its current motion, and whether the motion lies within
   * the recorded conditions.
   */
  coverage(motion?: Motion): Coverage;
  /**
   * Returns the magnitudes that a recording of the voice would show at its current motion, in the
   * texture's unit, at frequencies in Hz. They include the gain.
   */
  spectrum(frequencies: ArrayLike<number>): Float64Array;
  /** Frees the memory of the voice. */
  free(): void;
  [Symbol.dispose](): void;
}

/** Opens a texture from its bytes, a File, a Blob, a Response, or its address. */
export function open(source: Bytes | Readable | Address, options?: OpenOptions): Promise<Texture>;

/** The minimum and maximum of some numbers. */
export interface Interval {
  min: number;
  max: number;
}

/** What a library states about a texture. */
export interface LibraryEntry {
  /** Name in the library, with `/` between its parts. */
  name: string;
  tags: string[];
  /** Recorded speeds, mm/s, and forces, N; absent if unknown. */
  conditions: { speed_mm_s?: Interval; force_n?: Interval };
  /** What slid over the surface. */
  contact: "finger" | "tool" | "unknown";
  /**
   * Exponents of the law by which frequencies and level follow a motion outside the recorded ones.
   */
  law: Law;
  /** Ids of the models of the representations. */
  models: string[];
  /** Size of the texture, bytes. */
  bytes: number;
  /** BLAKE3 hash of the texture, hexadecimal. */
  blake3: string;
}

/** Conditions that a texture must meet to be found. Absent conditions are ignored. */
export interface LibraryQuery {
  /** Parts of the name or of a tag, ignoring case. All must match. */
  words?: string[];
  /** Tags, ignoring case. All must match. */
  tags?: string[];
  /** A speed, mm/s, and a force, N, within the recorded range. */
  speed?: number;
  force?: number;
  /** A model, by its id or short name. */
  model?: string;
}

/**
 * A library: one `.htexlib` file with thousands of textures. Only the necessary byte ranges are
 * fetched.
 */
export class Library {
  private constructor();
  /**
   * Opens a library from its address, its bytes, or a File or Blob of which ranges are read.
   * `fetch` is called for ranges, for example to add headers.
   */
  static open(source: Bytes | Readable | Address, options?: { fetch?: Fetch }): Promise<Library>;
  /** Name of the library; may be empty. */
  readonly name: string;
  /** Number of textures. */
  readonly count: number;
  /**
   * Returns the entries of all textures, in ascending order of their names. Reads the index, page
   * by page.
   */
  entries(): AsyncGenerator<LibraryEntry>;
  /** Returns the entries that match a query. Reads the index, page by page. */
  find(query: LibraryQuery): AsyncGenerator<LibraryEntry>;
  /** Returns the entry of a texture; undefined if there is no texture with this name. */
  entry(name: string): Promise<LibraryEntry | undefined>;
  /**
   * Returns the bytes of a texture's `.htex` file. Fails with an HtexError with the code "absent"
   * if there is no texture with this name.
   */
  bytes(name: string): Promise<Uint8Array>;
  /** Opens a texture: with two requests, or one if the page of the index is already known. */
  texture(name: string, options?: OpenOptions): Promise<Texture>;
  /** Frees the memory of the library. Its textures stay open. */
  free(): void;
  [Symbol.dispose](): void;
}

/**
 * Sets the library: the address of `htex.wasm`, its bytes, or the compiled module (a
 * `WebAssembly.Module`). Pages that keep their files elsewhere also set the addresses of
 * `processor.js` and `worker.js`. Call this before the first `open`.
 */
export function setLibrary(library: Address | Bytes | object | undefined, addresses?: { processor?: Address; worker?: Address }): void;

/**
 * Prepares an audio context for nodes. Await it before `new HtexNode`. Needs https or localhost.
 */
export function prepare(context: AudioContextLike): Promise<void>;

export interface LoadOptions extends Omit<VoiceOptions, "rate"> {
  /**
   * Whether models in modules may run in the audio thread, where a call that does not return stops
   * all sound. Default: only the modules of textures that were opened as trusted. Others play in a
   * worker, 32 ms later.
   */
  trusted?: boolean;
  /**
   * Factor that converts the texture's unit to full scale. Default: the factor that gives an RMS of
   * 0.1 (-20 dB) at the default condition. `load` keeps the current ratio to that default.
   */
  gain?: number;
  /** Number of bands in the envelopes passed to `onenvelope`, 1 to 32. Default 0: none. */
  bands?: number;
}

export interface NodeOptions extends LoadOptions {
  /** Motion at the start. Default: at rest, silent until `speed` and `force` are set. */
  motion?: Motion;
  /** A worker that several nodes share. */
  worker?: GuardedWorker;
  /** Longest call of a module in the worker, ms. Default 2000. */
  limit?: number;
  /**
   * Factor that multiplies all frequencies, above 0, for loudspeakers that cannot play low
   * frequencies. Default 1: as a finger feels them.
   */
  pitch?: number;
}

/**
 * Plays a texture, with a fade at its start and its end. Fires an event `error`, whose property
 * `error` is an HtexError.
 */
export class HtexNode extends NodeBase {
  constructor(context: AudioContextLike, texture: Texture, options?: NodeOptions);
  /** Scanning speed, mm/s. */
  readonly speed: AudioParamLike;
  /** Normal force, N. */
  readonly force: AudioParamLike;
  /** Factor that converts the texture's unit to full scale. */
  readonly gain: AudioParamLike;
  /** Position along the path, mm, for models that follow it. */
  set position(position: number);
  /** Place on the surface, mm, for models that are maps, such as friction maps; null if unknown. */
  set place(place: { x: number; y: number } | null);
  /**
   * Fades to another texture within 20 ms. Resolves when the fade has begun. Of several
   * simultaneous calls the last one counts.
   */
  load(texture: Texture, options?: LoadOptions): Promise<void>;
  /** Fades to a recording. It plays unchanged, at any speed and force, while a finger slides. */
  load(loop: Loop, options?: { gain?: number }): Promise<void>;
  /** Resolves when the voice has been made. */
  readonly ready: Promise<void>;
  /**
   * Called with the error after which the node is silent, also for errors of the worklet itself.
   */
  onerror: ((event: EventLike & { readonly error: HtexError }) => void) | null;
  /**
   * Called about every 20 ms with what was played, in the texture's unit and before the gain, if
   * the node has bands.
   */
  onenvelope: ((envelope: Envelope) => void) | null;
  /** Edges of the bands, Hz: one more than there are bands. */
  readonly envelopeEdges: Float64Array;
  /** The error after which the node is silent. */
  readonly error?: HtexError;
  /** Number of frames that a worker did not deliver in time. */
  readonly missed: number;
  /** Fades out within 10 ms and frees the voice. The node cannot be used again. */
  stop(): void;
  [Symbol.dispose](): void;
}

/**
 * A worker that renders voices of untrusted models. It is terminated if a call takes too long. In
 * Node.js it is a thread, and does not keep the program running while it has nothing to do.
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

/** The parts of a gamepad from `navigator.getGamepads()` that are used. */
export interface PadLike {
  readonly vibrationActuator?: ActuatorLike | null;
}

/** The gamepad's haptics. */
export interface ActuatorLike {
  playEffect(type: "dual-rumble", effect: RumbleEffect): Promise<unknown>;
  reset?(): Promise<unknown>;
  /** The extension that plays samples. Resolves to false if the gamepad does not support it. */
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
 * Returns the strengths of a gamepad's two motors for an envelope. Up to a mean frequency of 60 Hz
 * only the large motor runs, and from 420 Hz only the small one. `gain` is the strength for a level
 * of 1; a motor's strength is at most 1. Default 3, for levels of full scale. `duration` is the
 * duration of the effect, ms. Default 100.
 */
export function dualRumble(envelope: { readonly level: number; readonly centroid: number }, options?: { gain?: number; duration?: number }): RumbleEffect;

export interface PadOptions {
  /** The model of the representation. Default: the representation with the smallest error. */
  model?: string;
  /** Seed of the noise. Default 0. */
  seed?: number | bigint;
  /** Motion at the start. Default: at rest, until `setMotion`. */
  motion?: Motion;
  /**
   * Factor that converts the texture's unit to full scale. Default: the factor that gives an RMS of
   * 0.1 at the default condition.
   */
  gain?: number;
}

/** A texture that plays on a gamepad. */
export interface PadPlayer {
  /** What is played: samples, or two strengths every 50 ms. */
  readonly way: "pcm" | "dual-rumble";
  /** Sets the motion: mm/s, N, mm along the path, place in mm. Samples follow 0.25 s later, strengths 50 ms later. */
  setMotion(speed: number, force: number, position?: number, x?: number, y?: number): void;
  /** Stops the motors and frees the voice. */
  stop(): Promise<void>;
  /** Resolves when it was stopped. Rejects with an HtexError if the gamepad fails. */
  readonly ended: Promise<void>;
}

/**
 * Plays a texture on a gamepad until it is stopped. If the browser has `playPCM` and the gamepad
 * supports it, the samples are played (the browser may leave a gap between blocks of 0.25 s).
 * Otherwise the two motors play the level and the mean frequency.
 */
export function playOnPad(pad: PadLike, texture: Texture, options?: PadOptions): PadPlayer;

export interface PointerOptions {
  /** Millimetres per CSS pixel. Default 25.4 / 96. */
  mmPerPixel?: number;
  /**
   * Force in N for a pressure, 0 to 1, that the device measures. Default 0.8 times the pressure.
   */
  force?: (pressure: number) => number;
  /**
   * Force in N of a mouse, and of a device that reports only the pressures 0, 0.5 and 1. Default
   * 0.4.
   */
  defaultForce?: number;
}

/**
 * Calls `moved` with the motion of a pointer over an element: one pointer at a time; of a mouse,
 * only while the primary button is pressed. Meanwhile the element has `touch-action: none`. A
 * `null` element, such as an unmatched `querySelector` returns, is an HtexError. Returns a function
 * that ends this.
 */
export function followPointer(
  element: ElementLike | null,
  moved: (motion: { speed: number; force: number; position: number; x: number; y: number }) => void,
  options?: PointerOptions,
): () => void;

/** Lets a node follow a pointer over an element, and resumes its context on the first press. A `null` element, such as an
 * unmatched `querySelector` returns, is an HtexError. Returns a function that ends this. */
export function follow(element: ElementLike | null, node: HtexNode, options?: PointerOptions): () => void;
