/**
 * Import files of other haptic formats as textures, and export textures to such files: Apple .ahap,
 * Meta .haptic, MPEG .hjif, friction maps .png, glTF; Penn HaTT .xml can only be imported, Android
 * effects and .wav can only be exported.
 */

import type { FeltError, FitReport, Metadata, NamedBytes, NamedFile, Notice, RecordedQuantity } from "./author.js";
import type { Address, Bytes, Texture } from "./index.js";
import type { SignalLike, WorkerLike } from "./web.js";

/** Something that a file does not state, so that the user must state it. */
export interface Asked {
  /** Name of the setting that states it. */
  setting: "full_scale" | "speed_mm_s" | "force_n" | "pitch_mm";
  /** Description for the user, such as "at which speed it is felt". */
  words: string;
}

/** A format that can be imported. */
export interface ImportFormat {
  /** "hatt", "haptic", "ahap", "hjif", "png", "gltf" and others. */
  name: string;
  title: string;
  /** Extensions of the format's files, without the dot. */
  extensions: string[];
  /**
   * Whether models are fitted to the format's files. Files of other formats become textures without
   * a fit.
   */
  fitted: boolean;
  /** Settings of `importFile` that the format accepts, apart from metadata. */
  settings: string[];
  /**
   * What the format's files do not state. A particular file may state more: `Importer.asks` returns
   * what it lacks.
   */
  asks: Asked[];
  /**
   * Default actuator, if the format gives frequencies as positions in an actuator's range; null if
   * it gives frequencies in Hz.
   */
  profile: string | null;
  /** Which parts of a texture the format keeps, and which parts it loses, in words. */
  keeps: string;
  loses: string;
  /** Where the format's files state licence and author, in words. */
  rights: string;
}

/** A format that can be exported. */
export interface ExportFormat {
  /** "haptic", "ahap", "android", "hjif", "wav", "png", "gltf" and others. */
  name: string;
  title: string;
  /** Extensions of the format's files, without the dot. The first is the usual one. */
  extensions: string[];
  /** Settings of `exportFile` that the format accepts, apart from `extension`. */
  settings: (keyof ExportSettings)[];
  /** Default actuator; null if the format's files are not made for an actuator. */
  profile: string | null;
  /** Which parts of a texture the format keeps, and which parts it loses, in words. */
  keeps: string;
  loses: string;
  /** Where the format's files state licence and author, in words. */
  rights: string;
}

/** The frequency range of an actuator. */
export interface ActuatorRange {
  name: string;
  title: string;
  low_hz: number;
  high_hz: number;
}

/**
 * What a file does not state, how models are fitted to it, and the texture's metadata. The settings
 * have the same names as the keywords in the Python package. A setting that the format does not use
 * is an error.
 */
export interface ImportSettings extends Metadata {
  /**
   * The value, in the quantity's unit, for which 1 stands in the file; in an image, the value of
   * white.
   */
  full_scale?: number;
  /** The quantity of the texture and of `full_scale`. Default "lateral_force". */
  quantity?: RecordedQuantity;
  /** Speed (mm/s) and normal force (N) of the finger for which the file is meant. */
  speed_mm_s?: number;
  force_n?: number;
  /** Distance between the pixels of an image, mm. Default: the distance that the file states. */
  pitch_mm?: number;
  /**
   * The actuator, if the format gives frequencies as positions in an actuator's range. Default: the
   * format's own.
   */
  profile?: string;
  /** Short names or ids of the models to fit. Default: all. */
  models?: string | string[];
  /** Options of each model, such as `{ ar: { order: 6 } }`. */
  options?: Record<string, Record<string, number | string>>;
  level?: "fitted" | "recording";
  /** Store the spectrum of the signal in the texture. */
  keep_reference?: boolean;
  /** Whether the texture is coded: fewer bytes, but readers of version 1.0 refuse it. */
  storage?: "auto" | "coded" | "plain";
}

export interface ImportReport {
  /** Name of the format. */
  format: string;
  /** The models of the texture. `felt` is null if no model was fitted to the file. */
  models: Omit<FitReport["models"][number], "fit_ms">[];
  /** Ids of the models. The model whose difference from the signal is felt least comes first. */
  ranked: string[];
  conditions: Record<string, unknown>[];
  warnings: Notice[];
  notes: Notice[];
}

export interface Imported {
  texture: Texture;
  report: ImportReport;
}

/**
 * How a texture is exported. The settings have the same names as the keywords in the Python
 * package. A setting that the format does not use is an error.
 */
export interface ExportSettings {
  /**
   * Short name or id of the model that is exported. Default: the model with the smallest nine-band
   * error. Models that the texture embeds do not run here; `htex export` runs them.
   */
  model?: string;
  /**
   * Speed (mm/s) and normal force (N) of the finger. Default: the first recorded condition, or the
   * strongest one if the first is silent.
   */
  speed_mm_s?: number;
  force_n?: number;
  /** Duration, s, from 0.5 to 600. Default 2. */
  seconds?: number;
  /**
   * A stroke of the finger, in place of one speed, force and duration: a CSV file with the columns
   * t_s, speed_mm_s and force_n, or with a position in place of the speed.
   */
  stroke?: NamedBytes;
  /** Name of the actuator that will play the file. Default: the format's own. */
  profile?: string;
  /** Sample rate of a WAV file, Hz. Default 8000. */
  rate_hz?: number;
  /** How an .hjif file encodes the texture: as seven tones, or as samples. Default "vectorial". */
  coding?: "vectorial" | "wavelet";
  /** Seed of the random numbers: the same seed gives the same samples. Default 0. */
  seed?: number;
  /** One of the format's extensions, such as "kt" for Kotlin. Default: the first. */
  extension?: string;
}

/** How much of a texture an exported file loses. */
export interface ExportLoss {
  /** How much of the difference between the file and the texture a finger can feel. */
  felt: FeltError & {
    /** Third-octave bands (Hz), and the difference in each, dB. */
    centre_hz: number[];
    error_db: number[];
  };
  /** Level of the file relative to the level of the texture, dB. */
  level_db: number;
  /** RMS of what the file plays, in the texture's unit. */
  level_rms: number;
  /** Other measures of the difference, such as "band_error_rms_db". */
  [measure: string]: unknown;
}

/** What `htex export --json` prints about an exported file. */
export interface ExportReport {
  /** Name of the format. */
  format: string;
  /** Which parts of a texture the format always loses, in words. */
  loses: string;
  /** The licence and the author that the file states, as a sentence. */
  rights: string;
  /** Other remarks. */
  notes: string[];
  /**
   * The actuator, the duration (s), and the fraction of the time (0 to 1) in which the actuator is
   * too weak. Missing if the file is not made for an actuator.
   */
  profile?: string;
  seconds?: number;
  limited?: number;
  /** Missing if the file contains the whole texture. */
  lost?: ExportLoss;
}

export interface Exported {
  /** The file. It has the same bytes as the file that `htex export` writes. */
  bytes: Uint8Array;
  /** Extension for the file's name, without the dot. */
  extension: string;
  report: ExportReport;
}

/** Imports and exports files of other formats. All calls run in the calling thread. */
export interface Importer {
  formats(): { formats: ImportFormat[]; exports: ExportFormat[]; profiles: ActuatorRange[] };
  /**
   * Returns what a file does not state. `importFile` needs each of these as a setting. The list is
   * empty if the file states a complete texture.
   */
  asks(file: NamedBytes): Asked[];
  /** Imports a file. The global function `importFile` does this in a worker. */
  importFile(file: NamedBytes, settings?: ImportSettings): Imported;
  /**
   * Exports a texture to the format with the name `to`. The global function `exportFile` does this
   * in a worker.
   */
  exportFile(texture: Texture | Bytes, to: string, settings?: ExportSettings): Exported;
}

/** Loads the WASM module that imports and exports files. */
export function loadImporter(): Promise<Importer>;

export interface ImportOptions extends ImportSettings {
  /**
   * Called when a step begins: with the number of finished steps, the total number of steps, and a
   * text that describes the step, such as "import buzz.ahap".
   */
  onProgress?: (progress: { done: number; of: number; text: string }) => void;
  /** Aborts the import, which then fails with an HtexError whose code is "aborted". */
  signal?: SignalLike;
}

/**
 * Imports a file in a worker. Fails with an HtexError. Its code is "invalid-file" if the file is
 * not valid in its format, and "invalid-argument" if a setting is missing or invalid.
 */
export function importFile(file: NamedBytes | NamedFile, options?: ImportOptions): Promise<Imported>;

export interface ExportOptions extends Omit<ExportSettings, "stroke"> {
  stroke?: NamedBytes | NamedFile;
  /** Aborts the export, which then fails with an HtexError whose code is "aborted". */
  signal?: SignalLike;
}

/**
 * Exports a texture to the format with the name `to`, such as "ahap", in a worker. Fails with an
 * HtexError. Its code is
 *
 * - "invalid-argument" if there is no such format, if a setting is invalid, if the texture is
 *   silent or too weak to be felt at this motion, or if the format cannot store it;
 * - "no-model" if none of the models that the texture needs is part of this package;
 * - "invalid-asset" if the texture is damaged;
 * - "invalid-recording" if the stroke cannot be read.
 */
export function exportFile(texture: Texture | Bytes, to: string, options?: ExportOptions): Promise<Exported>;

/**
 * Sets where the WASM module that imports and exports files comes from. If a bundler has moved its
 * worker, `worker` starts the worker. Call this before the first use.
 */
export function setImportLibrary(library: Address | Bytes | object | undefined, options?: { worker?: () => WorkerLike | Promise<WorkerLike> }): void;
