// Which textures of a library are shown.

import type { LibraryEntry } from "htex";

export interface Filters {
  readonly search: string;
  readonly tag: string | null;
  readonly license: string | null;
  readonly quantity: string | null;
  /** A speed, mm/s, at which the texture was recorded. */
  readonly speed: number | null;
  /** Largest felt difference from the recordings, dB. */
  readonly felt: number | null;
  /** Largest held-out error, dB. */
  readonly heldOut: number | null;
}

export const ALL: Filters = { search: "", tag: null, license: null, quantity: null, speed: null, felt: null, heldOut: null };

/** The name and the tags in small letters, which a search looks at for each texture. */
const texts = new WeakMap<LibraryEntry, string>();

function textOf(entry: LibraryEntry) {
  const own = texts.get(entry) ?? [entry.name, ...entry.tags].join(" ").toLowerCase();
  texts.set(entry, own);
  return own;
}

/** A speed that differs by less counts as the same, as in `htex lib find`. */
const SAME = 0.05;

function isRecorded({ conditions: { speed_mm_s: range } }: LibraryEntry, speed: number) {
  return range !== undefined && speed >= range.min * (1 - SAME) && speed <= range.max * (1 + SAME);
}

/** Returns the entries that match all filters. */
export function matching(entries: readonly LibraryEntry[], { search, tag, license, quantity, speed, felt, heldOut }: Filters): readonly LibraryEntry[] {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  return entries.filter(
    (entry) =>
      words.every((word) => textOf(entry).includes(word)) &&
      (tag === null || entry.tags.includes(tag)) &&
      (license === null || (entry.license ?? "") === license) &&
      (quantity === null || entry.quantity === quantity) &&
      (speed === null || isRecorded(entry, speed)) &&
      (heldOut === null || (entry.held_out_error_db ?? Infinity) <= heldOut) &&
      (felt === null || (entry.felt_error_rms_db ?? Infinity) <= felt),
  );
}

/** Values with how often they occur, the most frequent one first. */
export function counted(values: Iterable<string>): readonly (readonly [string, number])[] {
  const counts = new Map<string, number>();
  for (const value of values) counts.set(value, (counts.get(value) ?? 0) + 1);
  return [...counts].sort(([a, m], [b, n]) => n - m || (a < b ? -1 : 1));
}
