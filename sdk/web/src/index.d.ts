/** Textures of touch in the browser and in Node.js. */

/// <reference lib="esnext.disposable" />

export * from "./author.js";

import type { Contact, Law, Manifest, Quantity } from "./manifest.js";
import { NodeBase } from "./web.js";
import type { AudioContextLike, AudioParamLike, ElementLike, EventLike, Fetch } from "./web.js";

export type { Contact, Exponent, Law, Manifest, ManifestCondition, Quantity, Representation } from "./manifest.js";

/** Bytes. */
export type Bytes = ArrayBuffer | ArrayBufferView;

/** An address: a text or a URL. */
export type Address = string | { readonly href: string };

/** A File, a Blob or a Response. */
export interface Readable {
  arrayBuffer(): Promise<ArrayBuffer>;
}

/** An error of the library. */
export class HtexError extends Error {
  readonly name: "HtexError";
  /** The kind of error: "invalid-argument", "invalid-asset", "no-representation", "no-model", "model", "invalid-motion", "bad-handle",
   * "unsupported", "internal", "invalid-library", "absent", "device", "io", "untrusted" and others. */
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
  /** Place on the surface, mm, for models that are maps of it; both or none. */
  x?: number;
  y?: number;
}

export interface OpenOptions {
  /** WASM modules of models. They precede the built-in ones. */
  modules?: Bytes[];
  /** Whether models that the asset brings along may run, in a sandbox. Default true. */
  embedded?: boolean;
  /** Whether modules may run in the thread that calls and in the audio thread, where nothing ends a call that does not return. Default
   * false: they play in a worker, by `HtexNode` and `GuardedWorker`. */
  trusted?: boolean;
}

export interface VoiceOptions {
  /** The model of the representation, by its id or short name. Default: the representation of least error. */
  model?: string;
  /** Rate of the samples, Hz. Default 20000. */
  rate?: number;
  /** Seed of the noise: equal seeds give equal samples. Default 0. */
  seed?: number | bigint;
  /** Motion of the start. Default: the first recorded condition, or the strongest if the first is silent. */
  motion?: Motion;
  /** How samples are made. Default "streamed". */
  synthesis?: "streamed" | `loop:${number}` | `filter:${number}`;
  /** Whether frequencies follow speeds beyond the recorded ones. Default true. */
  frequencyScaling?: boolean;
  /** Whether the level follows forces beyond the recorded ones. Default true. */
  levelScaling?: boolean;
  /** Whether a finger that rests is silent. Default true. */
  contact?: boolean;
  /** Highest level that a motion outside the recorded ones has, as a multiple of the strongest recorded level: above 0 and finite.
   * Default 4. */
  ceiling?: number;
  /** Gain of the samples. Default 1; not of an `HtexNode`, whose `gain` is an AudioParam. */
  gain?: number;
  /** Greatest magnitude of a sample, in the texture's unit; the gain falls at once where one would exceed it. Default: no limit. */
  limit?: number;
  /** Number of bands of `Voice.envelope`, 1 to 32. Default 0: no envelope, which takes no time. */
  bands?: number;
}

/** Samples that a node plays again and again, such as those of `author.recorded`. */
export interface Loop {
  /** In the unit of the recorded quantity. */
  readonly samples: Float32Array;
  readonly rate_hz: number;
  /** RMS of the samples, by which the usual gain is set. */
  readonly level_rms: number;
}

/** What a voice played since it was last asked: for phones, pads and motors, which take level and frequency. */
export interface Envelope {
  /** RMS of the samples, in the texture's unit, exactly; 0 for none. */
  level: number;
  /** Mean frequency, weighted by power, Hz, of windows that lag by some 20 ms; 0 for silence. */
  centroid: number;
  /** Number of the samples. */
  frames: number;
  /** Mean square in each band, of the same windows. */
  bands: Float64Array;
}

export interface At {
  /** The model of the representation. Default: the representation of least error. */
  model?: string;
  /** The motion; between conditions the spectrum is interpolated. Default: the first recorded condition, or the strongest if the first is silent. */
  at?: Motion;
}

/** A texture asset. */
export class Texture {
  private constructor();
  /** The manifest: name, conditions, representations, qualities and all else that the asset states. */
  readonly manifest: Manifest;
  readonly name: string;
  /** Physical quantity of the samples, such as "lateral_force". */
  readonly quantity: Quantity;
  /** Unit of the samples, such as "N". */
  readonly unit: string;
  /** What slid over the surface. */
  readonly contact: Contact;
  /** How frequencies and level follow a motion outside the recorded ones: stated, or assumed for the quantity and the contact. */
  readonly law: Law;
  /** Lowest and highest frequency of the spectra, Hz. */
  readonly band: [number, number];
  /** The recorded conditions; NaN where a speed or force is not known. */
  readonly conditions: { speed: number; force: number }[];
  /** Ids of the models of the representations. */
  readonly models: string[];
  /** Whether models of modules may run. */
  readonly hasModules: boolean;
  /**
   * Index of the condition at which a representation (default: the one of least error) is played where no motion is given: its first,
   * or its strongest if the first is silent. Loads no model.
   */
  defaultCondition(model?: string): number;
  /** Magnitudes of the texture spectrum at frequencies in Hz, in the unit. */
  spectrum(frequencies: ArrayLike<number>, options?: At): Float64Array;
  /**
   * Magnitudes at a recorded condition (default: the default condition), as a recording of the voice reads them: without chance, and of
   * sums of sinusoids from 20 s of their samples.
   */
  readSpectrum(options?: { model?: string; condition?: number }): { frequencies: Float64Array; magnitudes: Float64Array };
  /** Level of a representation, RMS in the unit. */
  level(options?: At): number;
  /** Parameters of a representation at a motion, by their names. */
  parameters(options?: At): Record<string, number | number[]>;
  /** Makes a voice, which runs in this thread: of a module only if the texture was opened as `trusted`. */
  voice(options?: VoiceOptions): Voice;
  /** The bytes of the file. */
  toBytes(): Uint8Array<ArrayBuffer>;
  /** Frees the memory of the texture; its voices play on. */
  free(): void;
  [Symbol.dispose](): void;
}

/** The relation of a speed or force to the recorded ones. */
export interface Reach {
  /** "followed": the model follows it by itself. Outside, the texture follows its law from the nearest recorded value. */
  kind: "inside" | "unknown" | "followed" | "outside";
  /** The value that was asked for, and the nearest recorded one; of "outside". */
  asked?: number;
  recorded?: number;
}

/** The relation of a motion to the recorded conditions, and how a voice plays it. */
export interface Coverage {
  /** "silent": the finger does not slide. "inside": as recorded, or interpolated. */
  kind: "silent" | "inside" | "followed" | "outside";
  /** One sentence in English; empty if nothing differs from the recording. */
  text: string;
  inside: boolean;
  slides: boolean;
  /** Relative distance of the motion from the one that is played. */
  excess: number;
  /** Factor of all frequencies, and of the level. */
  frequencyFactor: number;
  levelFactor: number;
  /** Speed, mm/s, and normal force, N. */
  speed: Reach;
  force: Reach;
}

/** A playing texture. */
export class Voice {
  private constructor();
  /** Sets the motion: mm/s, N, mm along the path, and the place in mm. Spectrum and level glide to it. */
  setMotion(speed: number, force: number, position?: number, x?: number, y?: number): void;
  /** Renders the next samples, in the texture's unit. They do not depend on the lengths of the blocks. */
  render(frames: number): Float32Array;
  /** As before, to an array, without allocating. */
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
  /** Whether the voice rests: its samples are 0 until a motion is felt again. */
  readonly isSilent: boolean;
  /** Sets the gain, which changes within 10 ms. */
  setGain(gain: number): void;
  /** Makes the voice as it was when it was made. */
  reset(): void;
  /** What was rendered since the last call; the bands are written to the array, if one is given. */
  envelope(bands?: Float64Array): Envelope;
  /** Edges of the bands, Hz: one more than bands, in equal ratios. The first band reaches down to 0 Hz, and the last up to half the rate. */
  readonly envelopeEdges: Float64Array;
  /** How the voice plays a motion, or the one that is set, and whether that is within the recorded conditions. */
  coverage(motion?: Motion): Coverage;
  /** Magnitudes that a recording of the voice reads at the motion that is set, at frequencies in Hz, in the unit; its gain included. */
  spectrum(frequencies: ArrayLike<number>): Float64Array;
  /** Frees the memory of the voice. */
  free(): void;
  [Symbol.dispose](): void;
}

/** Opens a texture: its bytes, a File, a Blob or a Response, or its address. */
export function open(source: Bytes | Readable | Address, options?: OpenOptions): Promise<Texture>;

/** The least and the greatest of some numbers. */
export interface Interval {
  min: number;
  max: number;
}

/** What a library states of a texture. */
export interface LibraryEntry {
  /** Name in the library, with `/` between its parts. */
  name: string;
  tags: string[];
  /** Recorded speeds, mm/s, and forces, N; absent if none is known. */
  conditions: { speed_mm_s?: Interval; force_n?: Interval };
  /** What slid over the surface. */
  contact: "finger" | "tool" | "unknown";
  /** Exponents of the law by which frequencies and level follow a motion outside the recorded ones. */
  law: Law;
  /** Ids of the models of the representations. */
  models: string[];
  /** Bytes of the texture. */
  bytes: number;
  /** BLAKE3 of the texture, hexadecimal. */
  blake3: string;
}

/** What a texture must have to be found; what is absent is not asked for. */
export interface LibraryQuery {
  /** Parts of the name or of a tag, without case; all of them. */
  words?: string[];
  /** Tags, without case; all of them. */
  tags?: string[];
  /** A speed, mm/s, and a force, N, among the recorded ones. */
  speed?: number;
  force?: number;
  /** A model, by its id or short name. */
  model?: string;
}

/** A library: one `.htexlib` file with thousands of textures, of which ranges are fetched. */
export class Library {
  private constructor();
  /** Opens a library: its address, a File or a Blob, of which ranges are read, or its bytes. `fetch` is called for ranges, for example to add
   * headers. */
  static open(source: Bytes | Readable | Address, options?: { fetch?: Fetch }): Promise<Library>;
  /** Name of the library; may be empty. */
  readonly name: string;
  /** Number of textures. */
  readonly count: number;
  /** The entries of all textures, in ascending order of their names. Reads the index, page by page. */
  entries(): AsyncGenerator<LibraryEntry>;
  /** The entries that have all that is asked for. Reads the index, page by page. */
  find(query: LibraryQuery): AsyncGenerator<LibraryEntry>;
  /** The entry of a texture; undefined if there is none of this name. */
  entry(name: string): Promise<LibraryEntry | undefined>;
  /** The bytes of a texture's `.htex` file; an HtexError of the kind "absent" if there is none of this name. */
  bytes(name: string): Promise<Uint8Array>;
  /** Opens a texture: two requests, one if the page of the index is known. */
  texture(name: string, options?: OpenOptions): Promise<Texture>;
  /** Frees the memory of the library; its textures stay open. */
  free(): void;
  [Symbol.dispose](): void;
}

/** Sets the library: the address of `htex.wasm`, its bytes, or the compiled module (a `WebAssembly.Module`); and the addresses of
 * `processor.js` and `worker.js`, for pages whose files are elsewhere. Before the first `open`. */
export function setLibrary(library: Address | Bytes | object | undefined, addresses?: { processor?: Address; worker?: Address }): void;

/** Prepares an audio context for nodes; must have returned before `new HtexNode`. Needs https or localhost. */
export function prepare(context: AudioContextLike): Promise<void>;

export interface LoadOptions extends Omit<VoiceOptions, "rate"> {
  /** Whether models of modules may run in the audio thread, where a call that does not return stops all sound. Default: only those of
   * textures that were opened as trusted; others play in a worker, 32 ms later. */
  trusted?: boolean;
  /** Factor from the texture's unit to full scale. Default: an RMS of 0.1, -20 dB, at the default condition; of `load` the present ratio to
   * that. */
  gain?: number;
  /** Number of bands of the envelopes that `onenvelope` is told, 1 to 32. Default 0: none. */
  bands?: number;
}

export interface NodeOptions extends LoadOptions {
  /** The motion of the start. Default: at rest, silent until `speed` and `force` are set. */
  motion?: Motion;
  /** A worker that several nodes share. */
  worker?: GuardedWorker;
  /** Longest call of a module in the worker, ms. Default 2000. */
  limit?: number;
  /** Factor of all frequencies, above 0, for loudspeakers that have no low ones. Default 1: as a finger feels them. */
  pitch?: number;
}

/** Plays a texture, with a fade at its start and its end. Has an event `error`, whose property of that name is an HtexError. */
export class HtexNode extends NodeBase {
  constructor(context: AudioContextLike, texture: Texture, options?: NodeOptions);
  /** Scanning speed, mm/s. */
  readonly speed: AudioParamLike;
  /** Normal force, N. */
  readonly force: AudioParamLike;
  /** Factor from the texture's unit to full scale. */
  readonly gain: AudioParamLike;
  /** Position along the path, mm, for models that follow it. */
  set position(position: number);
  /** Place on the surface, mm, for models that are maps, such as friction maps; null where it is not known. */
  set place(place: { x: number; y: number } | null);
  /** Fades to another texture within 20 ms; resolves when that has begun. Of several calls at a time the last one counts. */
  load(texture: Texture, options?: LoadOptions): Promise<void>;
  /** Fades to a recording, which plays as it is while a finger slides, at any speed and force. */
  load(loop: Loop, options?: { gain?: number }): Promise<void>;
  /** Resolves when the voice is made. */
  readonly ready: Promise<void>;
  /** Is called with the error after which the node is silent; the worklet's own errors, too. */
  onerror: ((event: EventLike & { readonly error: HtexError }) => void) | null;
  /** Is called every 20 ms or so with what was played, in the texture's unit and before the gain, if the node has bands. */
  onenvelope: ((envelope: Envelope) => void) | null;
  /** Edges of the bands, Hz: one more than bands. */
  readonly envelopeEdges: Float64Array;
  /** The error after which the node is silent. */
  readonly error?: HtexError;
  /** Frames that a worker did not deliver in time. */
  readonly missed: number;
  /** Fades out within 10 ms, and frees the voice; the node cannot be used again. */
  stop(): void;
  [Symbol.dispose](): void;
}

/** A worker that renders voices of models that are not trusted, and is ended when a call takes too long. In Node.js it is a thread, and
 * does not keep the program running while nothing is asked for. */
export class GuardedWorker {
  /** `limit`: longest call, ms. Default 2000. */
  constructor(options?: { limit?: number });
  /** Renders the first samples of a new voice, in the texture's unit. */
  render(texture: Texture, frames: number, options?: VoiceOptions): Promise<Float32Array>;
  /** Ends the worker. */
  end(): void;
  [Symbol.dispose](): void;
}

/** A gamepad of `navigator.getGamepads()`, as far as it is used. */
export interface PadLike {
  readonly vibrationActuator?: ActuatorLike | null;
}

/** Its haptics. */
export interface ActuatorLike {
  playEffect(type: "dual-rumble", effect: RumbleEffect): Promise<unknown>;
  reset?(): Promise<unknown>;
  /** The extension that plays samples; resolves to false where the gamepad does not. */
  playPCM?(sound: any): Promise<boolean>;
}

/** The parameters of the effect "dual-rumble": times in ms, strengths from 0 to 1 of the large and the small motor. */
export interface RumbleEffect {
  startDelay: number;
  duration: number;
  strongMagnitude: number;
  weakMagnitude: number;
}

/** The strengths of the two motors of a gamepad for an envelope: all on the large one up to a mean frequency of 60 Hz, all on the small one from
 * 420 Hz. `gain`: strength of a level of 1, of which a motor has at most 1; default 3, for levels of full scale. `duration`: of the effect, ms.
 * Default 100. */
export function dualRumble(envelope: { readonly level: number; readonly centroid: number }, options?: { gain?: number; duration?: number }): RumbleEffect;

export interface PadOptions {
  /** The model of the representation. Default: the representation of least error. */
  model?: string;
  /** Seed of the noise. Default 0. */
  seed?: number | bigint;
  /** The motion of the start. Default: at rest, until `setMotion`. */
  motion?: Motion;
  /** Factor from the texture's unit to full scale. Default: an RMS of 0.1 at the default condition. */
  gain?: number;
}

/** A texture that plays on a gamepad. */
export interface PadPlayer {
  /** What is played: the samples, or two strengths every 50 ms. */
  readonly way: "pcm" | "dual-rumble";
  /** Sets the motion: mm/s, N, mm along the path, place in mm. Samples follow 0.25 s later, strengths 50 ms later. */
  setMotion(speed: number, force: number, position?: number, x?: number, y?: number): void;
  /** Stops the motors, and frees the voice. */
  stop(): Promise<void>;
  /** Resolves when it was stopped; rejects with an HtexError when the gamepad fails. */
  readonly ended: Promise<void>;
}

/** Plays a texture on a gamepad until it is stopped: its samples where the browser has `playPCM` and the gamepad plays them (between blocks of 0.25 s a
 * browser may leave a gap), else the level and the mean frequency on its two motors. */
export function playOnPad(pad: PadLike, texture: Texture, options?: PadOptions): PadPlayer;

export interface PointerOptions {
  /** Millimetres of a CSS pixel. Default 25.4 / 96. */
  mmPerPixel?: number;
  /** Force in N of a pressure of 0 to 1 that a device measures. Default 0.8 times the pressure. */
  force?: (pressure: number) => number;
  /** Force in N of a mouse, and of a device that tells no other pressure than 0, 0.5 and 1. Default 0.4. */
  defaultForce?: number;
}

/** Calls `moved` with the motion of a pointer over an element: one pointer at a time, of a mouse with the primary button. The element has
 * `touch-action: none` while it is followed. A `null` element, such as an unmatched `querySelector` returns, is an HtexError. Returns a function that ends this. */
export function followPointer(
  element: ElementLike | null,
  moved: (motion: { speed: number; force: number; position: number; x: number; y: number }) => void,
  options?: PointerOptions,
): () => void;

/** Lets a node follow a pointer over an element, and resumes its context on the first press. A `null` element, such as an
 * unmatched `querySelector` returns, is an HtexError. Returns a function that ends this. */
export function follow(element: ElementLike | null, node: HtexNode, options?: PointerOptions): () => void;
