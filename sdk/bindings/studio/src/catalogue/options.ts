// What `htex lib catalogue` writes into the page of a catalogue beside the library.

/** A texture that a build left out, and why. */
export interface LeftOut {
  readonly name: string;
  readonly reasons: readonly string[];
}

/** A kind of finding of the recordings of a build. */
export interface Finding {
  readonly code: string;
  readonly severity: string;
  readonly textures: number;
  readonly inLibrary: number;
  readonly first: readonly string[];
}

/** The report of a build. */
export interface BuildReport {
  readonly program: string;
  /** How many textures the recipe asks for. */
  readonly planned: number;
  /** How many of them the build left out; `leftOut` has the first ones. */
  readonly missing: number;
  readonly leftOut: readonly LeftOut[];
  readonly findings: readonly Finding[];
}

export interface CatalogueOptions {
  /** Address of the library, relative to the page. */
  readonly library: string;
  readonly report: BuildReport | null;
}
