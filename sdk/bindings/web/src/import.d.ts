/**
 * Importing files of other haptic formats as textures: Apple .ahap, Meta .haptic, MPEG .hjif, Penn
 * HaTT .xml, friction maps .png, glTF.
 */

import type { FitReport, Metadata, NamedBytes, NamedFile, Notice, RecordedQuantity } from "./author.js";
import type { Address, Bytes, Texture } from "./index.js";
import type { SignalLike, WorkerLike } from "./web.js";

/** Something that a file does not state. */
export interface Asked {
  /** The setting that states it. */
  setting: "full_scale" | "speed_mm_s" | "force_n" | "pitch_mm";
  /** Its description: "at which speed it is felt". */
  words: string;
}

/** A format that can be imported. */
export interface ImportFormat {
  /** "hatt", "haptic", "ahap", "hjif", "png", "gltf" and others. */
  name: string;
  title: string;
  /** Extensions of its files, without the dot. */
  extensions: string[];
  /** Whether models are fitted to its files. Other formats become textures as they are. */
  fitted: boolean;
  /** Settings of `importFile` that it accepts, apart from metadata. */
  settings: string[];
  /**
   * What its files do not state. `Importer.asks` answers this for one file, which may state more.
   */
  asks: Asked[];
  /**
   * Default actuator for formats that give frequencies as positions in an actuator's range; null if
   * frequencies are in Hz.
   */
  profile: string | null;
  /** Which parts of a texture the format keeps, and which it loses, in words. */
  keeps: string;
  loses: string;
  /** Where its files state licence and author. */
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
 * What a file does not state, how it is fitted, and the texture's metadata. The names are the
 * keywords of the Python package. A setting that the format does not use is refused.
 */
export interface ImportSettings extends Metadata {
  /** The value of the file's 1, or of white, in the quantity's unit. */
  full_scale?: number;
  /** The quantity of `full_scale`. Default "lateral_force". */
  quantity?: RecordedQuantity;
  /** Speed (mm/s) and normal force (N) of the finger at which the file is felt. */
  speed_mm_s?: number;
  force_n?: number;
  /** Distance between an image's pixels, mm. Default: the distance that the file states. */
  pitch_mm?: number;
  /** The actuator in whose range frequencies are positions. Default: the format's own. */
  profile?: string;
  /** Models by short name or id. Default: all. */
  models?: string | string[];
  /** Options of models: `{ ar: { order: 6 } }`. */
  options?: Record<string, Record<string, number | string>>;
  level?: "fitted" | "recording";
  /** Keep the spectrum of the signal in the texture. */
  keep_reference?: boolean;
}

export interface ImportReport {
  /** Name of the format. */
  format: string;
  /** If no model was fitted to the file, its difference is not felt. */
  models: Omit<FitReport["models"][number], "fit_ms">[];
  /** Ids of the models, starting with the one whose difference is felt least. */
  ranked: string[];
  conditions: Record<string, unknown>[];
  warnings: Notice[];
  notes: Notice[];
}

export interface Imported {
  texture: Texture;
  report: ImportReport;
}

/** Reads files of other formats, in the calling thread. */
export interface Importer {
  formats(): { formats: ImportFormat[]; profiles: ActuatorRange[] };
  /**
   * Returns what a file does not state, so that `importFile` needs it as a setting; empty for a
   * file that states a complete texture.
   */
  asks(file: NamedBytes): Asked[];
  /** Imports a file. The function `importFile` does this in a worker. */
  importFile(file: NamedBytes, settings?: ImportSettings): Imported;
}

/** Loads the module. */
export function loadImporter(): Promise<Importer>;

export interface ImportOptions extends ImportSettings {
  /**
   * Called with the number of finished steps, the total number, and what begins: "import
   * buzz.ahap".
   */
  onProgress?: (progress: { done: number; of: number; text: string }) => void;
  /** Aborts the import, which then fails with an HtexError with the code "aborted". */
  signal?: SignalLike;
}

/** Imports a file in a worker. Errors have the code "invalid-file" where the file is not what its format says, and "invalid-argument". */
export function importFile(file: NamedBytes | NamedFile, options?: ImportOptions): Promise<Imported>;

/**
 * Sets where the module is, and how the worker is started if a bundler has moved it. Call this
 * before the first use.
 */
export function setImportLibrary(library: Address | Bytes | object | undefined, options?: { worker?: () => WorkerLike | Promise<WorkerLike> }): void;
