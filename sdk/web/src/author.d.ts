/** Textures made: recordings fitted, parameters written, textures mixed and edited. */

import type { Address, Bytes, Quantity, Readable, Texture } from "./index.js";
import type { SignalLike, WorkerLike } from "./web.js";

/** A file: its name, which tells what kind of recording it is, and its bytes. */
export interface NamedBytes {
  name: string;
  bytes: Bytes;
}

/** A File, or a Blob with a name. */
export type NamedFile = Readable & { readonly name: string };

/** Settings that help against a problem: names of `ReadingSettings` and `FitSettings`, some with a value ("segments windows"). */
export interface Notice {
  text: string;
  settings: string[];
}

/** A finding; `Author.explain` tells more of its code. */
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
  /** Whether no finding is an error. */
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
  /** Least and greatest value. */
  min: number;
  max: number;
  /** The range of most textures, and the scale on which it is even: for sliders. */
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
  /** Options of fitting. */
  options: { name: string; default: number; min: number; max: number; choices: string[]; description: string }[];
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

/** Parameters of a model at a condition. */
export interface MadeAt {
  /** Speed, mm/s, and force, N; both of all conditions, or of none. */
  speed?: number;
  force?: number;
  /** RMS in the quantity's unit; may be absent of a model with `keeps_level`. */
  level?: number;
  parameters: Record<string, number | number[]>;
}

export interface MakeOptions extends Metadata {
  representations: { model: string; conditions: MadeAt[] }[];
  /** Default "lateral_force". */
  quantity?: RecordedQuantity;
  /** The quantity's unit, to be checked. */
  unit?: string;
  /** Lowest and highest frequency, Hz. Default 20 to 1000. */
  band?: [number, number];
}

/** How recordings are read: the keywords of the Python package, by the same names. */
export interface ReadingSettings {
  /** Sampling rate, where the file does not say. */
  rate_hz?: number;
  /** Roles of columns: `lateral=lateral_V:0.4444,normal=#3`. */
  map?: string;
  /** Files with the finger's motion, one for each recording or one for all. */
  tracker?: NamedBytes | NamedBytes[];
  tracker_map?: string;
  quantity?: RecordedQuantity;
  /** What a full-scale sample of WAV, FLAC and NPY is, in the quantity's unit. */
  scale?: number;
  /** Response of the recording setup, a CSV. */
  response?: NamedBytes;
  from_s?: number;
  to_s?: number;
  most_values?: number;
  segments?: "auto" | "sweeps" | "windows";
  averaging?: "magnitude" | "rms" | "complex";
  /** Speed and force, where the recording does not say, or instead of what it says. */
  speed_mm_s?: number;
  force_n?: number;
  /** Refuse recordings with findings that are errors or warnings. */
  strict?: boolean;
}

/** How models are fitted, and what is said of the texture. */
export interface FitSettings extends ReadingSettings, Metadata {
  /** Models by short name or id. Default: all. */
  models?: string | string[];
  /** Options of models: `{ ar: { order: 6 } }`. */
  options?: Record<string, Record<string, number | string>>;
  level?: "fitted" | "recording";
  /** Keep the recorded spectra in the texture. */
  keep_reference?: boolean;
  /** A grid of conditions from recordings of a free motion: lines of speed (mm/s) and force (N). */
  grid?: "auto" | { speed?: number[]; force?: number[] };
  /** Speed and force of each recording, or one for all. */
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

/** What the columns of a file are taken to be. */
export interface Columns {
  columns: {
    name: string;
    /** "lateral", "normal", "time" and others; null for a column that is not read. */
    role: string | null;
    /** Factor to the unit. */
    scale: number;
    unit: string;
    /** The first numbers, as they are in the file. */
    first: number[];
  }[];
  /** The rate that the file states. */
  rate_hz: number | null;
  /** The roles as the setting `map`, which may be corrected. */
  map: string;
  /** Why the file cannot be read as a recording, if it cannot. */
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
  /** Stretches that are read, s. */
  read_s: [number, number][];
  condition: { speed: number | null; force: number | null };
  /** Least and greatest over the segments. */
  speed_spread: [number, number] | null;
  force_spread: [number, number] | null;
  findings: Finding[];
  warnings: Notice[];
  notes: Notice[];
  /** The signals in at most 1000 steps of time: the least and the greatest of each step. "signal", "signal_y", "signal_z", "normal", "speed". */
  picture: { from_s: number; step_s: number; steps: number; signals: Record<string, { least: Float32Array; greatest: Float32Array }> };
}

/** What is read of a recording as sound: a loop without a seam, in the band, compensated and of one axis as its spectrum is. */
export interface RecordedLoop {
  /** Name of the recording. */
  recording: string;
  condition: { speed: number | null; force: number | null };
  quantity: RecordedQuantity;
  unit: string;
  rate_hz: number;
  /** RMS of the samples: the level of models that are fitted to the recording. */
  level_rms: number;
  segments: number;
  samples: Float32Array<ArrayBuffer>;
}

export interface BakeOptions {
  /** Name of the array. */
  name?: string;
  /** Default: the representation of least error. */
  model?: string;
  /** Sampling rate of the player, Hz. Default 8000. */
  rate?: number;
  /** Largest error of nine bands between conditions, dB. Default 0.3. */
  within?: number;
  /** Speeds, mm/s, and forces, N, which are all combined. Default: the first condition, or the strongest if the first is silent. */
  grid?: { speed: number[]; force: number[] };
}

/** A block for the player on microcontrollers; see `docs/microcontroller.md`. */
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
  /** Largest errors of nine bands: at the conditions, midway between them, and beyond them, where that is known. */
  error_at_conditions_db: number;
  error_between_db: number;
  error_beyond_db: number | null;
  /** The block as a C header, and as Rust. */
  c: string;
  rust: string;
}

/** What is felt of the difference between a model and the recording; see `spec/htex-1.md`. */
export interface FeltError {
  error_rms_db: number;
  largest_error_db: number;
  total_error_db: number;
  below_difference_threshold: boolean;
  below_if_sensitive: boolean;
  within_repeatability: boolean;
}

/** A texture as it is felt: by a model, at a motion. */
export interface FeltSide {
  texture: Texture | Bytes;
  /** Default: the representation of least error. */
  model?: string;
  /** Default: the first recorded condition, or the strongest if the first is silent. */
  at?: { speed?: number; force?: number };
}

/** What a fingertip feels of a difference: levels above the detection threshold in third octaves; see `docs/felt.md`. */
export interface Felt {
  centre_hz: number[];
  /** Levels above the threshold of the reference and of the other one; negative below it. */
  reference_db: number[];
  level_db: number[];
  /** Difference of what is above the threshold. */
  error_db: number[];
  error_rms_db: number;
  largest_error_db: number;
  total_error_db: number;
  /** Whether no difference is felt, by the usual listener and by a sensitive one. */
  below_difference_threshold: boolean;
  below_if_sensitive: boolean;
}

export interface FitReport {
  models: {
    model: string;
    /** Bytes of its parameters. */
    bytes: number;
    fit_ms: number;
    /** At the condition where most is felt. */
    felt: FeltError | null;
    at: { condition: number; level_rms: number; quality: Record<string, unknown> | null; left_out: Record<string, unknown> | null; felt: FeltError | null }[];
  }[];
  /** Ids of the models, that of which least is felt first. */
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

/** What makes textures, in the thread that calls. */
export interface Author {
  models(): Model[];
  /** Makes a texture of parameters; it states that it was made by hand. */
  make(options: MakeOptions): Texture;
  /** Makes a texture between two others; `weight` is the part of the second, 0 to 1. */
  mix(a: Texture | Bytes, b: Texture | Bytes, weight: number, metadata?: Metadata): Texture;
  /** A texture with other metadata; an empty text removes an entry. */
  edit(texture: Texture | Bytes, metadata: Metadata): Texture;
  /** Checks a file: a library and a texture are known by their bytes, a recording by its `name`. */
  validate(bytes: Bytes, options?: { name?: string }): Report;
  /** What a fingertip feels of the difference of a texture from a reference. */
  felt(reference: FeltSide, other: FeltSide): Felt;
  /** The magnitudes at which sinusoids of frequencies in Hz are at the detection threshold, in the quantity's unit. */
  threshold(frequencies: ArrayLike<number>, options?: { quantity?: Quantity }): Float64Array;
  /** What the code of a finding means. */
  explain(code: string): { code: string; severity: string; summary: string; explanation: string; fix: string; settings: string[] } | undefined;
  /** What the columns of a recording are taken to be. */
  columns(recording: NamedBytes, settings?: ReadingSettings): Columns;
  process(recording: NamedBytes, settings?: ReadingSettings): Processed;
  /** What is read of recordings as sound, at a rate that is a multiple of 10 Hz. */
  recorded(recordings: NamedBytes | NamedBytes[], settings: ReadingSettings & { rate: number; conditions?: FitSettings["conditions"] }): RecordedLoop[];
  /** Fits models to recordings; `fit` does it in a worker. */
  fit(recordings: NamedBytes | NamedBytes[], settings?: FitSettings): Fitted;
  /** Bakes a block for the player on microcontrollers. */
  bake(texture: Texture | Bytes, options?: BakeOptions): Baked;
  /** Licence and author of a texture; `text` has both as lines of SPDX, `riff` as a chunk to append to a WAV file. */
  rights(texture: Texture | Bytes): Rights;
  /** Packs textures, by their names, to a `.htexlib` file. Each states a licence, unless `unlicensed` allows those that do not. */
  library(textures: Record<string, Texture | Bytes>, options?: { name?: string; unlicensed?: boolean }): Uint8Array;
}

/** Loads the author module. */
export function loadAuthor(): Promise<Author>;

export interface FitOptions extends FitSettings {
  /** Called with the steps that are done, their number, and what begins: "read felt.csv", "fit ar". */
  onProgress?: (progress: { done: number; of: number; text: string }) => void;
  /** Aborts the fit, which then fails with an HtexError of the code "aborted". */
  signal?: SignalLike;
}

/** Fits models to recordings of a texture, in a worker. */
export function fit(recordings: NamedBytes | NamedFile | (NamedBytes | NamedFile)[], options?: FitOptions): Promise<Fitted>;

/** Sets where the module is, and how its worker is started where a bundler has it elsewhere. Before the first use. */
export function setAuthorLibrary(library: Address | Bytes | object | undefined, options?: { worker?: () => WorkerLike | Promise<WorkerLike> }): void;
