// What the catalogue shows: the entries that were read so far, the filters, and the texture in the address.

import { computed, signal } from "@preact/signals";
import type { Library, LibraryEntry } from "htex";

import { ALL, counted, matching, type Filters } from "./filters.ts";

export const entries = signal<readonly LibraryEntry[]>([]);
/** Whether all entries were read. */
export const isWhole = signal(false);
export const filters = signal<Filters>(ALL);
export const found = computed(() => matching(entries.value, filters.value));

export const tags = computed(() => counted(entries.value.flatMap((entry) => entry.tags)));
export const licenses = computed(() => counted(entries.value.map((entry) => entry.license ?? "")));
export const quantities = computed(() => counted(entries.value.flatMap((entry) => entry.quantity ?? [])));
export const knowsHeldOut = computed(() => entries.value.some((entry) => entry.held_out_error_db !== undefined));
export const knowsFelt = computed(() => entries.value.some((entry) => entry.felt_error_rms_db !== undefined));

/** The address of the page of the build. No texture has such a name, since none begins with a slash. */
export const BUILD = "/build";

const named = () => {
  try {
    return decodeURIComponent(location.hash.slice(1));
  } catch {
    return "";
  }
};

/** The name of the texture in the address; empty for the list. */
export const route = signal(named());
addEventListener("hashchange", () => (route.value = named()));

export const addressOf = (name: string) => `#${encodeURIComponent(name)}`;

/** Number of entries after which the list is drawn again, and the page may answer. */
const AT_ONCE = 2000;

/** Reads all entries. */
export async function readEntries(library: Library) {
  const all: LibraryEntry[] = [];
  for await (const entry of library.entries()) {
    all.push(entry);
    if (all.length % AT_ONCE !== 0) continue;
    entries.value = [...all];
    await new Promise((resolve) => setTimeout(resolve));
  }
  entries.value = all;
  isWhole.value = true;
}
