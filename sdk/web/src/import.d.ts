/** Files of other haptic formats as textures: Apple .ahap, Meta .haptic, MPEG .hjif, Penn HaTT .xml, friction maps .png, glTF. */

import type { FitReport, Metadata, NamedBytes, NamedFile, Notice, RecordedQuantity } from "./author.js";
import type { Address, Bytes, Texture } from "./index.js";
import type { SignalLike, WorkerLike } from "./web.js";

/** What a file does not say. */
export interface Asked {
  /** The setting that says it. */
  setting: "full_scale" | "speed_mm_s" | "force_n" | "pitch_mm";
  /** What it is, in words: "at which speed it is felt". */
  words: string;
}

/** A format whose files come in. */
export interface ImportFormat {
  /** "hatt", "haptic", "ahap", "hjif", "png", "gltf" and others. */
  name: string;
  title: string;
  /** Extensions of its files, without the point. */
  extensions: string[];
  /** Whether models are fitted to its files; the others become textures as they are. */
  fitted: boolean;
  /** Settings of `importFile` that it takes, beside metadata. */
  settings: string[];
  /** What its files do not say; `Importer.asks` tells it of one file, which may say more. */
  asks: Asked[];
  /** The actuator in whose range frequencies are positions, unless another is given; null where frequencies are in Hz. */
  profile: string | null;
  /** What of a texture the format keeps, and what it loses, in words. */
  keeps: string;
  loses: string;
  /** Where its files carry licence and author. */
  rights: string;
}

/** The range of frequencies of an actuator. */
export interface ActuatorRange {
  name: string;
  title: string;
  low_hz: number;
  high_hz: number;
}

/** What a file does not say, how it is fitted, and what is said of the texture: the keywords of the Python package, by the same names. A
 * setting that the format has no use for is refused. */
export interface ImportSettings extends Metadata {
  /** What the file calls 1, and white, in the quantity's unit. */
  full_scale?: number;
  /** What `full_scale` is of. Default "lateral_force". */
  quantity?: RecordedQuantity;
  /** Speed (mm/s) and normal force (N) of the finger at which the file is felt. */
  speed_mm_s?: number;
  force_n?: number;
  /** Distance of an image's pixels, mm. Default: the one that the file states. */
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
  /** Of a file that is not fitted, nothing is felt of the difference from it. */
  models: Omit<FitReport["models"][number], "fit_ms">[];
  /** Ids of the models, that of which least is felt first. */
  ranked: string[];
  conditions: Record<string, unknown>[];
  warnings: Notice[];
  notes: Notice[];
}

export interface Imported {
  texture: Texture;
  report: ImportReport;
}

/** What reads files of other formats, in the thread that calls. */
export interface Importer {
  formats(): { formats: ImportFormat[]; profiles: ActuatorRange[] };
  /** Reads a file for what it does not say, and `importFile` has to be given; nothing of one that states a texture. */
  asks(file: NamedBytes): Asked[];
  /** Imports a file; the function `importFile` does it in a worker. */
  importFile(file: NamedBytes, settings?: ImportSettings): Imported;
}

/** Loads the module. */
export function loadImporter(): Promise<Importer>;

export interface ImportOptions extends ImportSettings {
  /** Called with the steps that are done, their number, and what begins: "import buzz.ahap". */
  onProgress?: (progress: { done: number; of: number; text: string }) => void;
  /** Aborts the import, which then fails with an HtexError of the code "aborted". */
  signal?: SignalLike;
}

/** Imports a file in a worker. Errors have the code "invalid-file" where the file is not what its format says, and "invalid-argument". */
export function importFile(file: NamedBytes | NamedFile, options?: ImportOptions): Promise<Imported>;

/** Sets where the module is, and how the worker is started where a bundler has it elsewhere. Before the first use. */
export function setImportLibrary(library: Address | Bytes | object | undefined, options?: { worker?: () => WorkerLike | Promise<WorkerLike> }): void;
