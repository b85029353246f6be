// What a model's shaper does: it shows handles on the spectrum, and moves them.

import type { Author } from "htex";

import type { Frame, Spec } from "./spec.ts";

export interface Handle {
  readonly name: string;
  readonly hz: number;
  /** Decibels at the shown point. */
  readonly db: number;
  /** What dragging changes. */
  readonly moves: "level" | "both";
  /** Smallest change of the decibels, if the model has steps. */
  readonly stepDb?: number;
}

/** A handle and its new decibels. */
export interface Drawn {
  readonly handle: number;
  readonly db: number;
}

/** Lowest and highest frequency, Hz. */
export type Range = readonly [low: number, high: number];

/** What an edit may not change: locked handles, and frequencies outside a range. */
export interface Limits {
  readonly locked: ReadonlySet<number>;
  readonly range: Range | null;
}

export const NO_LIMITS: Limits = { locked: new Set(), range: null };

export const isInRange = ({ range }: Limits, hz: number) => !range || (hz >= range[0] && hz <= range[1]);

/** Whether an edit may change a handle. */
export const isFree = (limits: Limits, handle: number, hz: number) => !limits.locked.has(handle) && isInRange(limits, hz);

/** Where an edit takes place: the module that makes, the texture that is changed, and the point that is shown. */
export interface Bench extends Frame {
  readonly author: Author;
  readonly shown: number;
  /** Without limits, an edit may change everything. */
  readonly limits?: Limits;
}

/** Strengths of the macros, -1 to 1. */
export interface Macros {
  readonly rougher: number;
  readonly brighter: number;
  readonly peak: number;
  readonly level: number;
}

export interface Shaper {
  /** Whether a part of the curve can change alone. */
  readonly isLocal: boolean;
  handles(bench: Bench, spec: Spec): Handle[];
  /** Moves a handle to a frequency and to decibels at the shown point; other points change alike. */
  move(bench: Bench, spec: Spec, handle: number, hz: number, db: number): Spec;
  /** Sets decibels of several handles at once, as a hand draws across them. */
  draw?(bench: Bench, spec: Spec, drawn: readonly Drawn[]): Spec;
  /** Adds a handle; absent where their number is fixed. */
  add?(bench: Bench, spec: Spec, hz: number, db: number): Spec;
  remove?(bench: Bench, spec: Spec, handle: number): Spec;
  /** Whether a macro changes something while handles are locked; absent if every handle moves alone. */
  turns?(macro: keyof Macros, locked: ReadonlySet<number>): boolean;
  /** The macros. Without limits, *level* is not applied, because it is the same for all models. */
  macros(bench: Bench, spec: Spec, macros: Macros): Spec;
}

/** Greatest change of a macro, dB, and of the peak, octaves. */
export const MACRO_DB = 14;
export const MACRO_OCTAVES = 1;
/** Frequencies around which *rougher* and *brighter* take hold, Hz. */
const ROUGH_HZ = 90;
const BRIGHT_HZ = 320;

export const isLimited = ({ limits }: Bench): boolean => limits !== undefined && limits !== NO_LIMITS;

/** The change of a frequency's decibels by *rougher* and *brighter*. */
export function macroGain({ rougher, brighter }: Macros, hz: number) {
  const low = 1 / (1 + (hz / ROUGH_HZ) ** 2);
  const high = hz ** 2 / (hz ** 2 + BRIGHT_HZ ** 2);
  return MACRO_DB * (rougher * low + brighter * high);
}

export const macroRatio = ({ peak }: Macros) => 2 ** (MACRO_OCTAVES * peak);

/** The number between two at which a function that rises, or falls, has a value: halving in equal ratios. */
export function solve(of: (x: number) => number, wanted: number, low: number, high: number): number {
  const rises = of(high) > of(low);
  let [a, b] = [low, high];
  for (let i = 0; i < 12; i++) {
    const middle = Math.sqrt(a * b);
    if (of(middle) < wanted === rises) a = middle;
    else b = middle;
  }
  return Math.sqrt(a * b);
}
