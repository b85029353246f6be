/**
 * The manifest of a texture: everything that its file states except the parameters.
 * `spec/htex-1.md` explains each key.
 */

export type Quantity = string;
export type Contact = "finger" | "tool" | "unknown";

/** A speed and a force at which the texture was recorded. An absent value is unknown. */
export interface ManifestCondition {
  speed_mm_s?: number;
  force_n?: number;
  /** How much two such recordings differ, dB. */
  repeatability_rms_db?: number;
  /** The same over third octaves, dB. */
  repeatability_third_octave_rms_db?: number;
  /** Number of averaged segments; 0 for a computed condition. */
  segments?: number;
}

/** An exponent of the law, and where it comes from. */
export interface Exponent {
  exponent: number;
  source: "measured" | "given" | "assumed";
  estimate?: number;
  standard_error?: number;
}

/**
 * The law: how frequencies and level change with speed and force outside the recorded conditions.
 */
export interface Law {
  frequency_speed: Exponent;
  level_speed: Exponent;
  level_force: Exponent;
}

/** A representation: the texture as one model describes it. */
export interface Representation {
  /** Id of the model. */
  model: string;
  model_version: string;
  /** Level and measured errors at each condition at which the model was fitted. */
  at: ({ condition: number; level_rms: number } & Record<string, unknown>)[];
  [key: string]: unknown;
}

export interface Manifest {
  /** Version of the format. */
  htex: string;
  name: string;
  license?: string;
  author?: string;
  tags?: string[];
  description?: string;
  source?: string;
  doi?: string;
  sensor?: string;
  finger?: string;
  contact?: Contact;
  quantity: Quantity;
  unit: string;
  band: { low_hz: number; high_hz: number };
  provenance?: Record<string, unknown>;
  conditions: ManifestCondition[];
  law?: Law;
  /**
   * How strongly the texture fluctuates in time: standard deviations at 0.5 to 8 and at 8 to 32 Hz,
   * in steps of 1/32 dB (0 to 255). The errors, in decibels, are RMS differences of modulation
   * spectra: of the played fluctuation of the first halves of the recordings to the second halves,
   * and between the halves.
   */
  fluctuation?: { slow: number; fast: number; held_out_error_db?: number; halves_error_db?: number };
  representations: Representation[];
  reference?: Record<string, unknown>;
  /** Embedded models. */
  plugins?: { model: string; version: string; file: string; [key: string]: unknown }[];
  extensions?: Record<string, unknown>;
  extensions_required?: string[];
  /** Keys from a newer minor version. */
  [key: string]: unknown;
}
