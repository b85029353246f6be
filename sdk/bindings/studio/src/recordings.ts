// Recordings that are read, and fitted in a worker.

import { computed, effect, signal } from "@preact/signals";
import { fit, type Author, type Columns, type Fitted, type Processed } from "htex";

import { author, theAuthor } from "./author.ts";
import { recordedWork } from "./reference.ts";
import { begin, fail, say, screen } from "./state.ts";

export interface Recording {
  readonly name: string;
  readonly bytes: Uint8Array;
}

/** A recording as it is understood. */
export interface Read {
  readonly recording: Recording;
  readonly columns: Columns | null;
  readonly processed: Processed | null;
  /** Why it cannot be read. */
  readonly problem: string | null;
}

export const recordings = signal<readonly Recording[]>([]);
/** Roles of columns, as corrected by hand, by the recording's name. */
export const maps = signal<Readonly<Record<string, string>>>({});
export const speed = signal<number | null>(null);
export const force = signal<number | null>(null);
export const rate = signal<number | null>(null);
export const reads = signal<readonly Read[]>([]);
export const progress = signal<{ done: number; of: number; text: string } | null>(null);
export const fitted = signal<Fitted | null>(null);
export const license = signal("CC0-1.0");
export const isReading = signal(false);

/** The fit that was made last: its recordings, and the settings that they were read with. */
let lastFit: { all: readonly Recording[]; read: ReturnType<typeof settings> } | null = null;
/** Rate of recordings as sound, Hz. */
const LOOP_HZ = 48_000;

let aborting: AbortController | null = null;

/** The settings of all recordings, and the map of one. */
function settings(name: string) {
  const map = maps.peek()[name];
  const given = { map, speed_mm_s: speed.peek() ?? undefined, force_n: force.peek() ?? undefined, rate_hz: rate.peek() ?? undefined };
  return Object.fromEntries(Object.entries(given).filter(([, value]) => value !== undefined));
}

function attempt<T>(run: () => T): [T | null, string | null] {
  try {
    return [run(), null];
  } catch (error) {
    return [null, error instanceof Error ? error.message : String(error)];
  }
}

function read(made: Author, recording: Recording): Read {
  const [columns] = attempt(() => made.columns(recording, settings(recording.name)));
  const [processed, problem] = attempt(() => made.process(recording, settings(recording.name)));
  return { recording, columns, processed, problem };
}

/** Reads all again when recordings or their settings change. */
export function keepReading() {
  theAuthor().catch(fail);
  return effect(() => {
    const [made, all] = [author.value, recordings.value];
    void [maps.value, speed.value, force.value, rate.value];
    if (!made) return;
    isReading.value = all.length > 0;
    // The page shows that it reads before it does.
    setTimeout(() => {
      reads.value = all.map((one) => read(made, one));
      isReading.value = false;
    }, 20);
  });
}

export const canFit = computed(() => reads.value.length > 0 && reads.value.every(({ processed }) => processed !== null));

const stem = (name: string) => name.replace(/\.[^.]+$/, "");

export async function fitAll() {
  const all = recordings.peek();
  const first = all[0];
  if (!first) return;
  aborting = new AbortController();
  progress.value = { done: 0, of: 1, text: "begin" };
  const read = settings(first.name);
  const start = performance.now();
  try {
    const result = await fit(all.map(({ name, bytes }) => ({ name, bytes })), {
      ...read,
      name: stem(first.name),
      ...(license.peek() ? { license: license.peek() } : {}),
      onProgress: (now) => (progress.value = now),
      signal: aborting.signal,
    });
    performance.measure("fit", { start });
    fitted.peek()?.texture.free();
    fitted.value = result;
    lastFit = { all, read };
    say(`${result.report.ranked.length} models fitted.`, "good");
  } catch (error) {
    if ((error as { code?: string }).code !== "aborted") throw error;
    say("The fit was stopped.");
  } finally {
    progress.value = null;
    aborting = null;
  }
}

export function abort() {
  aborting?.abort();
}

/** Puts the fitted texture on the pad, played by a model, with its recorded spectra behind. */
export async function toPad(model?: string) {
  const [result, last, made] = [fitted.peek(), lastFit, await theAuthor()];
  if (!result || !last) return;
  const bytes = result.texture.toBytes();
  const { report } = result;
  const conditions = report.conditions.map((condition) => ({ speed: (condition["speed_mm_s"] as number | undefined) ?? null, force: (condition["force_n"] as number | undefined) ?? null }));
  const loops = () => made.recorded([...last.all], { ...last.read, rate: LOOP_HZ });
  recordedWork.value = { bytes, names: last.all.map(({ name }) => name), loops, spectra: report.spectra, conditions };
  await begin(bytes, "fit a recording", model ?? report.ranked[0]);
  screen.value = "shape";
}
