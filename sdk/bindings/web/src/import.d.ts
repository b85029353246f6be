/**
 * Import files of other haptic formats as textures: Apple .ahap, Meta .haptic, MPEG .hjif, Penn
 * HaTT .xml, friction maps .png, glTF.
 */

import type { FitReport, Metadata, NamedBytes, NamedFile, Notice, RecordedQuantity } from "./author.js";
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

/** Imports files of other formats. All calls run in the calling thread. */
export interface Importer {
  formats(): { formats: ImportFormat[]; profiles: ActuatorRange[] };
  /**
   * Returns what a file does not state. `importFile` needs each of these as a setting. The list is
   * empty if the file states a complete texture.
   */
  asks(file: NamedBytes): Asked[];
  /** Imports a file. The global function `importFile` does this in a worker. */
  importFile(file: NamedBytes, settings?: ImportSettings): Imported;
}

/** Loads the WASM module that imports files. */
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

/**
 * Sets where the WASM module that imports files comes from. If a bundler has moved its worker,
 * `worker` starts the worker. Call this before the first use.
 */
export function setImportLibrary(library: Address | Bytes | object | undefined, options?: { worker?: () => WorkerLike | Promise<WorkerLike> }): void;
