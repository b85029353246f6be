/** Make textures: fit recordings, write parameters, mix and edit textures. */

import type { Address, Bytes, Quantity, Readable, Texture } from "./index.js";
import type { SignalLike, WorkerLike } from "./web.js";

/**
 * A file: its bytes and its name. The extension of the name determines the format of a recording.
 */
export interface NamedBytes {
  name: string;
  bytes: Bytes;
}

/** A File, or a Blob with a name. */
export type NamedFile = Readable & { readonly name: string };

/**
 * A warning or a note. `settings` would fix the problem: names from `ReadingSettings` and
 * `FitSettings`, some with a value ("segments windows").
 */
export interface Notice {
  text: string;
  settings: string[];
}

/** A problem that was found in a file. `Author.explain` explains its code. */
export interface Finding {
  code: string;
  severity: "error" | "warning" | "info";
  /** JSON pointer to the place in the manifest; empty for the whole file. */
  pointer: string;
  message: string;
  settings: string[];
}

export interface Report {
  kind: "texture" | "library" | "recording";
  /** True if no finding is an error. */
  valid: boolean;
  findings: Finding[];
}

export type RecordedQuantity = "lateral_force" | "normal_force" | "acceleration" | "velocity" | "displacement";

/** A parameter of a model. */
export interface ModelField {
  name: string;
  /** Unit; "1" for a pure number. */
  unit: string;
  /** One number, or a list of at most `max_len` numbers. */
  kind: { type: "scalar" } | { type: "list"; max_len: number };
  /** Smallest and largest allowed value. */
  min: number;
  max: number;
  /** The range of most textures, and the scale of a slider for it. */
  usual?: { min: number; max: number; scale: "linear" | "log" };
  default?: number;
  description: string;
}

export interface Model {
  id: string;
  name: string;
  version: string;
  summary: string;
  fields: ModelField[];
  /**
   * Options for fitting. `sweep` and `sweep_alone` are the values to try when accuracy is compared
   * with cost. `not_above` names another option whose value is the upper limit of this one.
   */
  options: {
    name: string;
    default: number;
    min: number;
    max: number;
    choices: string[];
    sweep?: number[];
    sweep_alone?: number[];
    not_above?: string;
    description: string;
  }[];
  /** Whether the level is one of the model's parameters. */
  keeps_level?: boolean;
}

/** Metadata of a texture: what it is, who made it, and how it was recorded. */
export interface Metadata {
  name?: string;
  author?: string;
  /** The licence as an SPDX expression, such as "CC-BY-4.0". */
  license?: string;
  description?: string;
  tags?: string[];
  source?: string;
  doi?: string;
  sensor?: string;
  finger?: string;
  contact?: "finger" | "tool" | "unknown";
  /**
   * Exponents of the law, which states how frequencies and level change with speed and force
   * outside the recorded conditions.
   */
  law?: { frequency_speed?: number; level_speed?: number; level_force?: number };
}

/** Metadata and extensions of a texture. */
export interface MetadataAndExtensions extends Metadata {
  /**
   * Extensions: data that players do not need, by names of the form "com.vendor.NAME/1". The texture
   * keeps its other extensions, and null removes one. `spec/htex-1.md` lists those of this project.
   */
  extensions?: Record<string, unknown>;
}

/** The parameters of a model at one condition. */
export interface MadeAt {
  /** Speed (mm/s) and force (N). Give both for every condition, or neither for any. */
  speed?: number;
  force?: number;
  /** RMS in the quantity's unit. It may be absent for a model with `keeps_level`. */
  level?: number;
  parameters: Record<string, number | number[]>;
}

export interface MakeOptions extends MetadataAndExtensions {
  representations: { model: string; conditions: MadeAt[] }[];
  /** Default "lateral_force". */
  quantity?: RecordedQuantity;
  /** The quantity's unit. Another unit than the quantity has is an error. */
  unit?: string;
  /** Lowest and highest frequency, Hz. Default 20 to 1000. */
  band?: [number, number];
}

/**
 * How recordings are read. The settings have the same names as the keywords in the Python package.
 */
export interface ReadingSettings {
  /** Sample rate, Hz, if the file does not state it. */
  rate_hz?: number;
  /** Role of each column, with a factor if needed, such as `lateral=lateral_V:0.4444,normal=#3`. */
  map?: string;
  /** Tracker files with the finger's motion: one for each recording, or one for all. */
  tracker?: NamedBytes | NamedBytes[];
  tracker_map?: string;
  quantity?: RecordedQuantity;
  /** Value of a full-scale sample in a WAV, FLAC or NPY file, in the quantity's unit. */
  scale?: number;
  /** Frequency response of the recording setup, as a CSV file. */
  response?: NamedBytes;
  from_s?: number;
  to_s?: number;
  most_values?: number;
  segments?: "auto" | "sweeps" | "windows";
  averaging?: "magnitude" | "rms" | "complex";
  /**
   * Speed (mm/s) and force (N). Needed if the recording does not state them; otherwise they
   * override it.
   */
  speed_mm_s?: number;
  force_n?: number;
  /** Refuse recordings with findings that are errors or warnings. */
  strict?: boolean;
}

/** How recordings are read, how models are fitted, and the texture's metadata. */
export interface FitSettings extends ReadingSettings, Metadata {
  /** Short names or ids of the models to fit. Default: all. */
  models?: string | string[];
  /** Options of each model, such as `{ ar: { order: 6 } }`. */
  options?: Record<string, Record<string, number | string>>;
  level?: "fitted" | "recording";
  /**
   * Several settings under one name. `"paper"`: the paper's five models, the middles of sweeps,
   * averaged magnitudes, and the paper's choice for every option. Other settings take precedence.
   */
  preset?: "paper";
  /** Store the recorded spectra in the texture. */
  keep_reference?: boolean;
  /**
   * Whether the texture is coded: fewer bytes, but readers of version 1.0 of the format refuse it.
   * Default: `auto`, which codes a texture of more than eight conditions if its file becomes
   * smaller.
   */
  storage?: "auto" | "coded" | "plain";
  /**
   * Fit only the recorded conditions. Otherwise conditions are computed between recorded speeds, if
   * frequencies follow the speed, and at a third and three times the speed, if it is the only one and the
   * contact is unknown.
   */
  recorded_only?: boolean;
  /**
   * Divides recordings of a free motion into conditions. The grid lines are speeds (mm/s) and
   * forces (N).
   */
  grid?: "auto" | { speed?: number[]; force?: number[] };
  /** Speed (mm/s) and force (N): one pair for each recording, or one for all. */
  conditions?: { speed?: number; force?: number }[];
}

export interface RecordedSpectrum {
  frequency_hz: number[];
  magnitude: number[];
  quantity: RecordedQuantity;
  unit: string;
  band_hz: [number, number];
  segments: number;
  repeatability_rms_db: number | null;
}

/** The columns of a recording, and how they are interpreted. */
export interface Columns {
  columns: {
    name: string;
    /** "lateral", "normal", "time" and others; null for a column that is ignored. */
    role: string | null;
    /** Factor that converts the numbers in the file to `unit`. */
    scale: number;
    unit: string;
    /** The first numbers of the column, as in the file. */
    first: number[];
  }[];
  /** The sample rate that the file states, Hz. */
  rate_hz: number | null;
  /** The roles as a value of the setting `map`. Correct this value to change the roles. */
  map: string;
  /** Why the file cannot be read as a recording; null if it can. */
  problem: string | null;
}

/** A recording that was read, and its spectrum. */
export interface Processed {
  columns: Columns;
  rate_hz: number;
  duration_s: number;
  simulated: boolean;
  spectrum: RecordedSpectrum;
  segments: number;
  from_sweeps: boolean;
  /** Start and end of each segment that was read, s. */
  read_s: [number, number][];
  condition: { speed: number | null; force: number | null };
  /** Lowest and highest speed (mm/s) and force (N) of the segments. */
  speed_spread: [number, number] | null;
  force_spread: [number, number] | null;
  findings: Finding[];
  warnings: Notice[];
  notes: Notice[];
  /**
   * The signals, for drawing: the minimum and maximum in each of at most 1000 time steps. The
   * signals are "signal", "signal_y", "signal_z", "normal" and "speed".
   */
  picture: { from_s: number; step_s: number; steps: number; signals: Record<string, { least: Float32Array; greatest: Float32Array }> };
}

/**
 * A recording as sound: a seamless loop. It is limited to the band, corrected for the response of
 * the recording setup, and reduced to one axis in the same way as its spectrum.
 */
export interface RecordedLoop {
  /** Name of the recording. */
  recording: string;
  condition: { speed: number | null; force: number | null };
  quantity: RecordedQuantity;
  unit: string;
  rate_hz: number;
  /** RMS of the samples. Models fitted to the recording have this level. */
  level_rms: number;
  segments: number;
  samples: Float32Array<ArrayBuffer>;
}

export interface BakeOptions {
  /** Name of the array in the C and Rust code. */
  name?: string;
  /** Id or short name of the model. Default: the representation with the smallest error. */
  model?: string;
  /** Sample rate of the player, Hz. Default 8000. */
  rate?: number;
  /** Largest allowed nine-band error between conditions, dB. Default 0.3. */
  within?: number;
  /**
   * Speeds (mm/s) and forces (N) of the block's conditions. Every speed is combined with every
   * force. Default: only the first recorded condition, or the strongest one if the first is silent.
   */
  grid?: { speed: number[]; force: number[] };
}

/** Licence and author of a texture, for files that are made from it. */
export interface Rights {
  license: string | null;
  author: string | null;
  text: string;
  riff: Uint8Array;
}

/** A baked texture: a block of data for microcontrollers; see `docs/microcontroller.md`. */
export interface Baked {
  bytes: Uint8Array;
  model: string;
  quantity: RecordedQuantity;
  unit: string;
  /** An absolute value that samples rarely exceed. */
  full_scale: number;
  rate_hz: number;
  speeds: number[];
  forces: number[];
  /**
   * Largest nine-band errors, dB: at the conditions, midway between them, and beyond them (null if
   * unknown).
   */
  error_at_conditions_db: number;
  error_between_db: number;
  error_beyond_db: number | null;
  /** The block as a C header (`c`) and as Rust code (`rust`). */
  c: string;
  rust: string;
}

/**
 * How much of the difference between a model and the recording a finger can feel; see
 * `spec/htex-1.md`.
 */
export interface FeltError {
  error_rms_db: number;
  largest_error_db: number;
  total_error_db: number;
  /** RMS difference in sensation, (displacement / threshold)^0.3, over third octaves. */
  sensation_error_rms: number;
  below_detection_threshold: boolean;
  below_difference_threshold: boolean;
  below_if_sensitive: boolean;
  within_repeatability: boolean;
}

/** One of two textures to compare, the model that plays it, and the motion. */
export interface FeltSide {
  texture: Texture | Bytes;
  /** Id or short name of the model. Default: the representation with the smallest error. */
  model?: string;
  /**
   * The motion. Default: the first recorded condition, or the strongest one if the first is silent.
   */
  at?: { speed?: number; force?: number };
}

/**
 * What a fingertip can feel of the difference between two textures, in third-octave bands; see
 * `docs/felt.md`. Levels are relative to the detection threshold.
 */
export interface Felt {
  centre_hz: number[];
  /**
   * Levels of the reference and of the other texture above the detection threshold; negative below
   * it.
   */
  reference_db: number[];
  level_db: number[];
  /** Difference between the parts of both levels that are above the threshold. */
  error_db: number[];
  error_rms_db: number;
  largest_error_db: number;
  total_error_db: number;
  /** Whether the reference itself cannot be felt. Then the two answers below are false. */
  below_detection_threshold: boolean;
  /**
   * Whether a typical person feels no difference (`below_difference_threshold`), and whether a
   * sensitive person does not (`below_if_sensitive`).
   */
  below_difference_threshold: boolean;
  below_if_sensitive: boolean;
  /** RMS difference in sensation, (displacement / threshold)^0.3, over third octaves. */
  sensation_error_rms: number;
}

export interface FitReport {
  models: {
    model: string;
    /** Size of the model's parameters, bytes. */
    bytes: number;
    fit_ms: number;
    /** Felt difference at the condition where it is largest. */
    felt: FeltError | null;
    /**
     * The errors at each condition. `held_out_error` is in units of the difference between two
     * recordings, `held_out_error_db` in decibels; both are absent for recordings that are too short.
     */
    at: { condition: number; level_rms: number; held_out_error?: number | null; held_out_error_db?: number; quality: Record<string, unknown> | null; left_out: Record<string, unknown> | null; felt: FeltError | null }[];
  }[];
  /** Ids of the models. The model whose difference from the recording is felt least comes first. */
  ranked: string[];
  skipped: { model: string; reason: string }[];
  conditions: Record<string, unknown>[];
  /** The recorded spectrum of each condition. */
  spectra: RecordedSpectrum[];
  findings: { recording: string; finding: Finding }[];
  warnings: Notice[];
  notes: Notice[];
  grid: Record<string, unknown> | null;
}

export interface Fitted {
  texture: Texture;
  report: FitReport;
}

/** Makes textures. All calls run in the calling thread. */
export interface Author {
  models(): Model[];
  /** Makes a texture from parameters. The texture states that it was made by hand. */
  make(options: MakeOptions): Texture;
  /** Makes a texture between `a` and `b`. `weight` is the share of `b`, 0 to 1. */
  mix(a: Texture | Bytes, b: Texture | Bytes, weight: number, metadata?: MetadataAndExtensions): Texture;
  /**
   * Returns the texture with other metadata or other extensions. An empty text removes an entry of
   * the metadata.
   */
  edit(texture: Texture | Bytes, metadata: MetadataAndExtensions): Texture;
  /**
   * Checks a file. Recognises libraries and textures by their bytes, and recordings by their
   * `name`.
   */
  validate(bytes: Bytes, options?: { name?: string }): Report;
  /**
   * Returns what a fingertip can feel of the difference between a reference and another texture.
   */
  felt(reference: FeltSide, other: FeltSide): Felt;
  /**
   * Returns the detection threshold: for each frequency in Hz, the magnitude, in the quantity's
   * unit, at which a finger just feels a sinusoid.
   */
  threshold(frequencies: ArrayLike<number>, options?: { quantity?: Quantity }): Float64Array;
  /** Returns the meaning of a finding's code; undefined for an unknown code. */
  explain(code: string): { code: string; severity: string; summary: string; explanation: string; fix: string; settings: string[] } | undefined;
  /** Returns the columns of a recording, and how they are interpreted. */
  columns(recording: NamedBytes, settings?: ReadingSettings): Columns;
  process(recording: NamedBytes, settings?: ReadingSettings): Processed;
  /** Returns recordings as sound. The sample rate `rate` must be a multiple of 10 Hz. */
  recorded(recordings: NamedBytes | NamedBytes[], settings: ReadingSettings & { rate: number; conditions?: FitSettings["conditions"] }): RecordedLoop[];
  /** Fits models to recordings. The global function `fit` does this in a worker. */
  fit(recordings: NamedBytes | NamedBytes[], settings?: FitSettings): Fitted;
  /** Bakes a texture: computes a block of data for players on microcontrollers. */
  bake(texture: Texture | Bytes, options?: BakeOptions): Baked;
  /**
   * Returns the licence and the author of a texture. `text` has both as SPDX lines. `riff` has both
   * as a chunk to append to a WAV file.
   */
  rights(texture: Texture | Bytes): Rights;
  /**
   * Packs textures into a `.htexlib` file, under the names that are the keys of `textures`. Each
   * texture must state a licence, unless `unlicensed` is true.
   */
  library(textures: Record<string, Texture | Bytes>, options?: { name?: string; unlicensed?: boolean }): Uint8Array;
}

/** Loads the WASM module that makes textures. */
export function loadAuthor(): Promise<Author>;

export interface FitOptions extends FitSettings {
  /**
   * Called when a step begins: with the number of finished steps, the total number of steps, and a
   * text that describes the step, such as "read felt.csv" or "fit ar".
   */
  onProgress?: (progress: { done: number; of: number; text: string }) => void;
  /** Aborts the fit, which then fails with an HtexError whose code is "aborted". */
  signal?: SignalLike;
}

/** Fits models to recordings of a texture, in a worker. */
export function fit(recordings: NamedBytes | NamedFile | (NamedBytes | NamedFile)[], options?: FitOptions): Promise<Fitted>;

/**
 * Sets where the WASM module that makes textures comes from. If a bundler has moved its worker,
 * `worker` starts the worker. Call this before the first use.
 */
export function setAuthorLibrary(library: Address | Bytes | object | undefined, options?: { worker?: () => WorkerLike | Promise<WorkerLike> }): void;
