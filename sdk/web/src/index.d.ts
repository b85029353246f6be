/** Textures of touch in the browser and in Node.js. */

export * from "./author.js";

/** Bytes. */
export type Bytes = ArrayBuffer | ArrayBufferView;

/** An error of the library. */
export class HtexError extends Error {
  readonly name: "HtexError";
  /** The kind of error: "invalid-argument", "invalid-asset", "no-representation", "no-model", "model", "invalid-motion", "bad-handle",
   * "unsupported", "internal", "invalid-library", "absent", "io" and others. */
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
}

export interface VoiceOptions {
  /** The model of the representation, by its id or short name. Default: the representation of least error. */
  model?: string;
  /** Rate of the samples, Hz. Default 20000. */
  rate?: number;
  /** Seed of the noise: equal seeds give equal samples. Default 0. */
  seed?: number | bigint;
  /** Motion of the start. Default: the first recorded condition. */
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
  /** The motion; between conditions the spectrum is interpolated. Default: the first recorded condition. */
  at?: Motion;
}

/** A texture asset. */
export class Texture {
  private constructor();
  /** The manifest: name, conditions, representations, qualities and all else that the asset states. */
  readonly manifest: Record<string, unknown> & { name: string };
  readonly name: string;
  /** Unit of the samples, such as "N". */
  readonly unit: string;
  /** Lowest and highest frequency of the spectra, Hz. */
  readonly band: [number, number];
  /** The recorded conditions; NaN where a speed or force is not known. */
  readonly conditions: { speed: number; force: number }[];
  /** Ids of the models of the representations. */
  readonly models: string[];
  /** Whether models of modules may run. */
  readonly hasModules: boolean;
  /** Magnitudes of the texture spectrum at frequencies in Hz, in the unit. */
  spectrum(frequencies: ArrayLike<number>, options?: At): Float64Array;
  /** Level of a representation, RMS in the unit. */
  level(options?: At): number;
  /** Makes a voice. */
  voice(options?: VoiceOptions): Voice;
  /** Frees the memory of the texture; its voices play on. */
  free(): void;
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
  /** How the voice plays a motion, and whether that is within the recorded conditions, as English text. */
  coverage(motion: Motion): string;
  /** Frees the memory of the voice. */
  free(): void;
}

/** Opens a texture: its bytes, or its address. */
export function open(source: Bytes | string | URL, options?: OpenOptions): Promise<Texture>;

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
  law: Record<"frequency_speed" | "level_speed" | "level_force", { exponent: number; source: "measured" | "given" | "assumed" }>;
  /** Ids of the models of the representations. */
  models: string[];
  /** Bytes of the texture. */
  bytes: number;
  /** BLAKE3 of the texture, hexadecimal. */
  blake3: string;
}

/** A library: one `.htexlib` file with thousands of textures, of which ranges are fetched. */
export class Library {
  private constructor();
  /** Opens a library: its address, or its bytes. `fetch` is called for ranges, for example to add headers. */
  static open(source: Bytes | string | URL, options?: { fetch?: typeof fetch }): Promise<Library>;
  /** Name of the library; may be empty. */
  readonly name: string;
  /** Number of textures. */
  readonly count: number;
  /** The entries of all textures, in ascending order of their names. Reads the index, page by page. */
  entries(): AsyncGenerator<LibraryEntry>;
  /** The entry of a texture; undefined if there is none of this name. */
  entry(name: string): Promise<LibraryEntry | undefined>;
  /** The bytes of a texture's `.htex` file; an HtexError of the kind "absent" if there is none of this name. */
  bytes(name: string): Promise<Uint8Array>;
  /** Opens a texture: two requests, one if the page of the index is known. */
  texture(name: string, options?: OpenOptions): Promise<Texture>;
  /** Frees the memory of the library; its textures stay open. */
  free(): void;
}

/** Sets the library: the address of `htex.wasm`, its bytes, or the compiled module. Before the first `open`. */
export function setLibrary(library: string | URL | Bytes | WebAssembly.Module): void;

/** Prepares an audio context for nodes; must have returned before `new HtexNode`. */
export function prepare(context: BaseAudioContext): Promise<void>;

export interface NodeOptions extends Omit<VoiceOptions, "rate" | "gain" | "bands"> {
  /** Factor from the texture's unit to full scale. Default: an RMS of 0.1, -20 dB, at the first condition. */
  gain?: number;
  /** Whether models of modules may run in the audio thread, where a call that does not return stops all sound. Default: only for textures
   * without modules; others play in a worker, 32 ms later. */
  trusted?: boolean;
  /** A worker that several nodes share. */
  worker?: GuardedWorker;
  /** Longest call of a module in the worker, ms. Default 2000. */
  limit?: number;
}

/** Plays a texture. Has an event `error`, whose property of that name is an HtexError. */
export class HtexNode extends AudioWorkletNode {
  constructor(context: BaseAudioContext, texture: Texture, options?: NodeOptions);
  /** Scanning speed, mm/s. */
  readonly speed: AudioParam;
  /** Normal force, N. */
  readonly force: AudioParam;
  /** Factor from the texture's unit to full scale. */
  readonly gain: AudioParam;
  /** Position along the path, mm, for models that follow it. */
  set position(position: number);
  /** Resolves when the voice is made. */
  readonly ready: Promise<void>;
  /** The error after which the node is silent. */
  readonly error?: HtexError;
  /** Frames that a worker did not deliver in time. */
  readonly missed: number;
  /** Ends the voice; the node cannot be used again. */
  stop(): void;
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
}

export interface PointerOptions {
  /** Millimetres of a CSS pixel. Default 25.4 / 96. */
  mmPerPixel?: number;
  /** Force in N of a pressure of 0 to 1. Default 0.8 times the pressure; a mouse has 0.5. */
  force?: (pressure: number) => number;
}

/** Calls `moved` with the motion of a pointer over an element. Returns a function that ends this. */
export function followPointer(element: HTMLElement, moved: (motion: Required<Motion>) => void, options?: PointerOptions): () => void;

/** Lets a node follow a pointer over an element. Returns a function that ends this. */
export function follow(element: HTMLElement, node: HtexNode, options?: PointerOptions): () => void;
