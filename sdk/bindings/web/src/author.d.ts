/** Making textures: fit recordings, write parameters, mix and edit textures. */

import type { Address, Bytes, Quantity, Readable, Texture } from "./index.js";
import type { SignalLike, WorkerLike } from "./web.js";

/** A file: its bytes and its name, which tells what kind of recording it is. */
export interface NamedBytes {
  name: string;
  bytes: Bytes;
}

/** A File, or a Blob with a name. */
export type NamedFile = Readable & { readonly name: string };

/**
 * Settings that would fix a problem: names from `ReadingSettings` and `FitSettings`, some with a
 * value ("segments windows").
 */
export interface Notice {
  text: string;
  settings: string[];
}

/** A finding. `Author.explain` explains its code. */
export interface Finding {
  code: string;
  severity: "error" | "warning" | "info";
  /** JSON pointer into the manifest; empty for the file as a whole. */
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
  /** One number, or a list of at most `max_len`. */
  kind: { type: "scalar" } | { type: "list"; max_len: number };
  /** Minimum and maximum. */
  min: number;
  max: number;
  /** The range for most textures, and the scale on which sliders should show it. */
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
  /** Options for fitting. `sweep` and `sweep_alone` are values for comparing accuracy with cost. */
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
  /** Whether the level is one of the parameters. */
  keeps_level?: boolean;
}

/** What a texture is, who made it, and how it was recorded. */
export interface Metadata {
  name?: string;
  author?: string;
  /** SPDX expression, such as "CC-BY-4.0". */
  license?: string;
  description?: string;
  tags?: string[];
  source?: string;
  doi?: string;
  sensor?: string;
  finger?: string;
  contact?: "finger" | "tool" | "unknown";
  /** Exponents of the law outside the recorded motions. */
  law?: { frequency_speed?: number; level_speed?: number; level_force?: number };
}

/** A model's parameters at a condition. */
export interface MadeAt {
  /** Speed, mm/s, and force, N. Give both for every condition, or neither. */
  speed?: number;
  force?: number;
  /** RMS in the quantity's unit. May be absent for a model with `keeps_level`. */
  level?: number;
  parameters: Record<string, number | number[]>;
}

export interface MakeOptions extends Metadata {
  representations: { model: string; conditions: MadeAt[] }[];
  /** Default "lateral_force". */
  quantity?: RecordedQuantity;
  /** The quantity's unit, which is checked. */
  unit?: string;
  /** Lowest and highest frequency, Hz. Default 20 to 1000. */
  band?: [number, number];
}

/** How recordings are read. The names are the keywords of the Python package. */
export interface ReadingSettings {
  /** Sample rate, if the file does not state it. */
  rate_hz?: number;
  /** Roles of columns: `lateral=lateral_V:0.4444,normal=#3`. */
  map?: string;
  /** Files with the finger's motion: one for each recording, or one for all. */
  tracker?: NamedBytes | NamedBytes[];
  tracker_map?: string;
  quantity?: RecordedQuantity;
  /** Value of a full-scale sample in WAV, FLAC and NPY, in the quantity's unit. */
  scale?: number;
  /** Response of the recording setup, a CSV. */
  response?: NamedBytes;
  from_s?: number;
  to_s?: number;
  most_values?: number;
  segments?: "auto" | "sweeps" | "windows";
  averaging?: "magnitude" | "rms" | "complex";
  /** Speed and force, if the recording does not state them or to override what it states. */
  speed_mm_s?: number;
  force_n?: number;
  /** Refuse recordings that have errors or warnings. */
  strict?: boolean;
}

/** How models are fitted, and the texture's metadata. */
export interface FitSettings extends ReadingSettings, Metadata {
  /** Models by short name or id. Default: all. */
  models?: string | string[];
  /** Options of models: `{ ar: { order: 6 } }`. */
  options?: Record<string, Record<string, number | string>>;
  level?: "fitted" | "recording";
  /** Keep the recorded spectra in the texture. */
  keep_reference?: boolean;
  /**
   * A grid of conditions for recordings of a free motion: lists of speeds (mm/s) and forces (N).
   */
  grid?: "auto" | { speed?: number[]; force?: number[] };
  /** Speed and force: one for each recording, or one for all. */
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

/** How the columns of a file are interpreted. */
export interface Columns {
  columns: {
    name: string;
    /** "lateral", "normal", "time" and others; null for a column that is ignored. */
    role: string | null;
    /** Factor that converts the column to the unit. */
    scale: number;
    unit: string;
    /** The first numbers, as the file states them. */
    first: number[];
  }[];
  /** The rate that the file states. */
  rate_hz: number | null;
  /** The roles in the form of the setting `map`, so that they can be corrected. */
  map: string;
  /** Why the file cannot be read as a recording; absent if it can. */
  problem: string | null;
}

/** A recording as it is read. */
export interface Processed {
  columns: Columns;
  rate_hz: number;
  duration_s: number;
  simulated: boolean;
  spectrum: RecordedSpectrum;
  segments: number;
  from_sweeps: boolean;
  /** Segments that are read, s. */
  read_s: [number, number][];
  condition: { speed: number | null; force: number | null };
  /** Minimum and maximum over the segments. */
  speed_spread: [number, number] | null;
  force_spread: [number, number] | null;
  findings: Finding[];
  warnings: Notice[];
  notes: Notice[];
  /**
   * The signals in at most 1000 time steps, as the minimum and maximum of each step: "signal",
   * "signal_y", "signal_z", "normal", "speed".
   */
  picture: { from_s: number; step_s: number; steps: number; signals: Record<string, { least: Float32Array; greatest: Float32Array }> };
}

/**
 * A recording as sound: a seamless loop, limited to the band, compensated, and reduced to one axis
 * in the same way as its spectrum.
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
  /** Name of the array. */
  name?: string;
  /** Default: the representation with the smallest error. */
  model?: string;
  /** Sample rate of the player, Hz. Default 8000. */
  rate?: number;
  /** Largest nine-band error between conditions, dB. Default 0.3. */
  within?: number;
  /**
   * Speeds, mm/s, and forces, N. Every speed is combined with every force. Default: the first
   * condition, or the strongest if the first is silent.
   */
  grid?: { speed: number[]; force: number[] };
}

/** A block for players on microcontrollers; see `docs/microcontroller.md`. */
export interface Rights {
  license: string | null;
  author: string | null;
  text: string;
  riff: Uint8Array;
}

export interface Baked {
  bytes: Uint8Array;
  model: string;
  quantity: RecordedQuantity;
  unit: string;
  /** A magnitude that samples rarely exceed. */
  full_scale: number;
  rate_hz: number;
  speeds: number[];
  forces: number[];
  /**
   * Largest nine-band errors: at the conditions, midway between them and, if known, beyond them.
   */
  error_at_conditions_db: number;
  error_between_db: number;
  error_beyond_db: number | null;
  /** The block as a C header and as Rust code. */
  c: string;
  rust: string;
}

/** How much of the difference between a model and the recording is felt; see `spec/htex-1.md`. */
export interface FeltError {
  error_rms_db: number;
  largest_error_db: number;
  total_error_db: number;
  below_difference_threshold: boolean;
  below_if_sensitive: boolean;
  within_repeatability: boolean;
}

/** A texture to compare: played by a model, at a motion. */
export interface FeltSide {
  texture: Texture | Bytes;
  /** Default: the representation with the smallest error. */
  model?: string;
  /** Default: the first recorded condition, or the strongest if the first is silent. */
  at?: { speed?: number; force?: number };
}

/**
 * What a fingertip feels of a difference: levels above the detection threshold in third octaves;
 * see `docs/felt.md`.
 */
export interface Felt {
  centre_hz: number[];
  /** Levels of the reference and of the other texture above the threshold; negative if below it. */
  reference_db: number[];
  level_db: number[];
  /** Difference between the parts above the threshold. */
  error_db: number[];
  error_rms_db: number;
  largest_error_db: number;
  total_error_db: number;
  /** Whether a typical and a sensitive listener feel no difference. */
  below_difference_threshold: boolean;
  below_if_sensitive: boolean;
}

export interface FitReport {
  models: {
    model: string;
    /** Size of its parameters, bytes. */
    bytes: number;
    fit_ms: number;
    /** At the condition where the difference is felt most. */
    felt: FeltError | null;
    at: { condition: number; level_rms: number; quality: Record<string, unknown> | null; left_out: Record<string, unknown> | null; felt: FeltError | null }[];
  }[];
  /** Ids of the models, starting with the one whose difference is felt least. */
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

/** Makes textures, in the calling thread. */
export interface Author {
  models(): Model[];
  /** Makes a texture from parameters. The texture states that it was made by hand. */
  make(options: MakeOptions): Texture;
  /** Makes a texture between two others. `weight` is the share of the second, 0 to 1. */
  mix(a: Texture | Bytes, b: Texture | Bytes, weight: number, metadata?: Metadata): Texture;
  /** Returns the texture with other metadata. An empty text removes an entry. */
  edit(texture: Texture | Bytes, metadata: Metadata): Texture;
  /**
   * Checks a file. Libraries and textures are recognised by their bytes, recordings by their
   * `name`.
   */
  validate(bytes: Bytes, options?: { name?: string }): Report;
  /** Returns what a fingertip feels of the difference between a texture and a reference. */
  felt(reference: FeltSide, other: FeltSide): Felt;
  /**
   * Returns the magnitudes at which sinusoids of given frequencies, Hz, reach the detection
   * threshold, in the quantity's unit.
   */
  threshold(frequencies: ArrayLike<number>, options?: { quantity?: Quantity }): Float64Array;
  /** Returns what the code of a finding means. */
  explain(code: string): { code: string; severity: string; summary: string; explanation: string; fix: string; settings: string[] } | undefined;
  /** Returns how the columns of a recording are interpreted. */
  columns(recording: NamedBytes, settings?: ReadingSettings): Columns;
  process(recording: NamedBytes, settings?: ReadingSettings): Processed;
  /** Returns recordings as sound, at a sample rate that is a multiple of 10 Hz. */
  recorded(recordings: NamedBytes | NamedBytes[], settings: ReadingSettings & { rate: number; conditions?: FitSettings["conditions"] }): RecordedLoop[];
  /** Fits models to recordings. The function `fit` does this in a worker. */
  fit(recordings: NamedBytes | NamedBytes[], settings?: FitSettings): Fitted;
  /** Bakes a block for players on microcontrollers. */
  bake(texture: Texture | Bytes, options?: BakeOptions): Baked;
  /**
   * Returns licence and author of a texture: `text` has both as SPDX lines, `riff` as a chunk to
   * append to a WAV file.
   */
  rights(texture: Texture | Bytes): Rights;
  /**
   * Packs textures, by name, into a `.htexlib` file. Each must state a licence, unless `unlicensed`
   * allows textures without one.
   */
  library(textures: Record<string, Texture | Bytes>, options?: { name?: string; unlicensed?: boolean }): Uint8Array;
}

/** Loads the author module. */
export function loadAuthor(): Promise<Author>;

export interface FitOptions extends FitSettings {
  /**
   * Called with the number of finished steps, the total number, and what begins: "read felt.csv",
   * "fit ar".
   */
  onProgress?: (progress: { done: number; of: number; text: string }) => void;
  /** Aborts the fit, which then fails with an HtexError with the code "aborted". */
  signal?: SignalLike;
}

/** Fits models to recordings of a texture, in a worker. */
export function fit(recordings: NamedBytes | NamedFile | (NamedBytes | NamedFile)[], options?: FitOptions): Promise<Fitted>;

/**
 * Sets where the module is, and how its worker is started if a bundler has moved it. Call this
 * before the first use.
 */
export function setAuthorLibrary(library: Address | Bytes | object | undefined, options?: { worker?: () => WorkerLike | Promise<WorkerLike> }): void;
