// Recordings that are read, and fitted, in workers.

import { batch, computed, effect, signal } from "@preact/signals";
import { fit, type Columns, type FitSettings, type Fitted, type Processed, type RecordedLoop, type RecordedQuantity } from "htex";

import { theAuthor } from "./author.ts";
import { entriesOf, rolesOf, textOf } from "./columns.ts";
import { LEVEL_UNKNOWN } from "./level.ts";
import { rankedBy } from "./ranking.ts";
import { reader, type Reader } from "./reading.ts";
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
  /** The settings that it was read with, as a text; null if it has yet to be read. */
  readonly key: string | null;
}

/** The motion of a recording that does not state its own. */
export interface Motion {
  readonly speed: number | null;
  readonly force: number | null;
}

/** What is said of recordings that they do not state. */
export interface Stated {
  readonly quantity: RecordedQuantity;
  /** The map of the columns, as a text; empty for what the reader finds. */
  readonly map: string;
  readonly rate: number | null;
  readonly from: number | null;
  readonly to: number | null;
  readonly segments: "auto" | "sweeps" | "windows";
  /** Whether it is known what a full-scale sample stands for, and that number in the quantity's unit. */
  readonly isScaleKnown: boolean;
  readonly scale: number | null;
  /** The motions, in the order of the recordings. */
  readonly motions: readonly Motion[];
}

const NOTHING: Stated = { quantity: "lateral_force", map: "", rate: null, from: null, to: null, segments: "auto", isScaleKnown: false, scale: null, motions: [] };

export const recordings = signal<readonly Recording[]>([]);
export const stated = signal<Stated>(NOTHING);
export const license = signal("CC0-1.0");
export const reads = signal<readonly Read[]>([]);
/** The reading that is going on. */
export const reading = signal<{ done: number; of: number; name: string } | null>(null);
export const progress = signal<{ done: number; of: number; text: string } | null>(null);
/** The last fit of these recordings, and the settings that they were read with. */
export const fitted = signal<(Fitted & { readonly key: string; readonly isLevelKnown: boolean }) | null>(null);

/** Rate of recordings as sound, Hz. */
const LOOP_HZ = 48_000;
/** Time after the last change of a setting at which recordings are read again, ms: while a number is typed they are not. */
const TYPED_MS = 300;

/** Takes other recordings. What was said and made of the ones before goes with them. */
export function openRecordings(all: readonly Recording[]) {
  abort();
  fitted.peek()?.texture.free();
  batch(() => {
    fitted.value = null;
    stated.value = NOTHING;
    recordings.value = all;
  });
}

export function state(change: Partial<Stated>) {
  stated.value = { ...stated.peek(), ...change };
}

/** Another quantity has other axes; those of the map are called by their names there. */
export function stateQuantity(quantity: RecordedQuantity) {
  const roles = rolesOf(quantity);
  const renamed = entriesOf(stated.peek().map).map((entry) => ({ ...entry, role: roles.includes("signal") ? entry.role.replace(/^lateral/, "signal") : entry.role.replace(/^signal/, "lateral") }));
  state({ quantity, map: textOf(renamed.filter(({ role }) => roles.includes(role))) });
}

export function stateMotion(index: number, change: Partial<Motion>) {
  const motions = recordings.peek().map((_, i) => ({ speed: null, force: null, ...stated.peek().motions[i], ...(i === index ? change : {}) }));
  state({ motions });
}

const isOfSamples = ({ name }: Recording) => /\.(wav|flac|npy)$/i.test(name);

/** Whether there are files that have samples without a unit. */
export const asksScale = computed(() => recordings.value.some(isOfSamples));

/** Whether a role is one of the axes of the texture's signal. */
const isAxis = (role: string, quantity: RecordedQuantity) => (quantity === "normal_force" ? role === "normal" : /^(lateral|signal)/.test(role));

/** Whether the level is one of what was recorded: of samples, what full scale stands for must be known. */
export const isLevelKnown = computed(() => {
  const { isScaleKnown, scale, map, quantity } = stated.value;
  const axes = entriesOf(map).filter(({ role }) => isAxis(role, quantity));
  const isStated = isScaleKnown && scale !== null && recordings.value.every(isOfSamples);
  return !asksScale.value || isStated || (axes.length > 0 && axes.every((axis) => axis.scale !== null));
});

const given = <T extends object>(all: T) => Object.fromEntries(Object.entries(all).filter(([, value]) => value !== null && value !== "")) as { [name in keyof T]?: NonNullable<T[name]> };

/** The settings that all recordings are read with. */
function settings({ quantity, map, rate, from, to, segments, isScaleKnown, scale }: Stated, all: readonly Recording[]) {
  const full = isScaleKnown && all.every(isOfSamples) ? scale : null;
  // Where there is a map, the scale stands in it.
  const scaled = entriesOf(map).map((entry) => ({ ...entry, scale: entry.scale ?? (isAxis(entry.role, quantity) ? full : null) }));
  return given({ quantity, segments, map: full === null ? map : textOf(scaled), scale: map ? null : full, rate_hz: rate, from_s: from, to_s: to });
}

/** The settings of one recording: its motion is its own. */
function settingsOf(index: number, what: Stated, all: readonly Recording[]) {
  const { speed = null, force = null } = what.motions[index] ?? {};
  return given({ ...settings(what, all), speed_mm_s: speed, force_n: force });
}

function conditionsOf({ motions }: Stated, all: readonly Recording[]): Pick<FitSettings, "conditions"> {
  const conditions = all.map((_, i) => given({ speed: motions[i]?.speed ?? null, force: motions[i]?.force ?? null }));
  return conditions.some((one) => Object.keys(one).length > 0) ? { conditions } : {};
}

const keyOf = (what: Stated, all: readonly Recording[]) => JSON.stringify([settings(what, all), conditionsOf(what, all)]);

/** Whether the settings were changed since the last fit. */
export const isFitOld = computed(() => fitted.value !== null && fitted.value.key !== keyOf(stated.value, recordings.value));

const said = (error: unknown) => (error instanceof Error ? error.message : String(error));

function put(index: number, change: Partial<Read>) {
  reads.value = reads.peek().map((read, i) => (i === index ? { ...read, ...change } : read));
}

async function readOne(own: Reader, index: number, recording: Recording, key: string) {
  const from = JSON.parse(key);
  const columns = await own.ask("columns", [recording], from).catch(() => null);
  // The columns can be corrected while the rest is read.
  put(index, { columns });
  const [processed, problem] = await own.ask("process", [recording], from).then((one) => [one, null] as const, (error) => [null, said(error)] as const);
  put(index, { columns: processed?.columns ?? columns, processed, problem, key });
}

let stopReader: (() => void) | null = null;

/** Whether the reading was stopped before all was read. */
export const isStopped = signal(false);

/** Stops the reading until it is asked for; what was read stays. */
export function haltReading() {
  isStopped.value = reading.peek() !== null;
  stopReader?.();
}

/** Reads the recordings that were not yet read with these settings. A later call takes the place of one that is going on. */
export async function read() {
  stopReader?.();
  isStopped.value = false;
  const [what, all] = [stated.peek(), recordings.peek()];
  const keys = all.map((_, i) => JSON.stringify(settingsOf(i, what, all)));
  reads.value = all.map((recording) => reads.peek().find((read) => read.recording === recording) ?? { recording, columns: null, processed: null, problem: null, key: null });
  const wanted = all.map((recording, index) => ({ recording, index, key: keys[index] ?? "" })).filter(({ index, key }) => reads.peek()[index]?.key !== key);
  if (wanted.length === 0) return;
  const making = reader();
  let isEnded = false;
  const end = () => {
    isEnded = true;
    reading.value = null;
    stopReader = null;
    making.then((own) => own.end(), () => {});
  };
  stopReader = end;
  try {
    for (const [done, { recording, index, key }] of wanted.entries()) {
      reading.value = { done, of: wanted.length, name: recording.name };
      const own = await making;
      if (isEnded) return;
      await readOne(own, index, recording, key);
      if (isEnded) return;
    }
  } finally {
    if (!isEnded) end();
  }
}

/** Reads all again when recordings or their settings change. */
export function keepReading() {
  theAuthor().catch(fail);
  let last: readonly Recording[] = [];
  let timer = 0;
  const end = effect(() => {
    const all = recordings.value;
    void stated.value;
    clearTimeout(timer);
    timer = window.setTimeout(() => read().catch(fail), all === last ? TYPED_MS : 0);
    last = all;
  });
  return () => {
    end();
    clearTimeout(timer);
    stopReader?.();
  };
}

export const canFit = computed(() => reads.value.length > 0 && reads.value.every(({ processed }) => processed !== null));

const stem = (name: string) => name.replace(/\.[^.]+$/, "");

let aborting: AbortController | null = null;

/** Makes the loops of the recordings of the last fit; once. */
let loops: (() => Promise<readonly RecordedLoop[]>) | null = null;

function loopsOf(all: readonly Recording[], from: Partial<FitSettings>) {
  let made: Promise<readonly RecordedLoop[]> | null = null;
  const make = async () => {
    const own = await reader();
    try {
      return await own.ask("recorded", all, { ...from, rate: LOOP_HZ });
    } finally {
      own.end();
    }
  };
  return () => (made ??= make());
}

export async function fitAll() {
  const [what, all] = [stated.peek(), recordings.peek()];
  const first = all[0];
  if (!first) return;
  const own = new AbortController();
  aborting = own;
  progress.value = { done: 0, of: 1, text: "begin" };
  const from = { ...settings(what, all), ...conditionsOf(what, all) };
  const known = isLevelKnown.peek();
  const start = performance.now();
  try {
    const result = await fit(all.map(({ name, bytes }) => ({ name, bytes })), {
      ...from,
      name: stem(first.name),
      ...(license.peek() ? { license: license.peek() } : {}),
      ...(known ? {} : LEVEL_UNKNOWN),
      onProgress: (now) => (progress.value = now),
      signal: own.signal,
    });
    performance.measure("fit", { start });
    fitted.peek()?.texture.free();
    fitted.value = { ...result, key: keyOf(what, all), isLevelKnown: known };
    loops = loopsOf(all, from);
    say(`${result.report.ranked.length} models fitted.`, "good");
  } catch (error) {
    if ((error as { code?: string }).code !== "aborted") throw error;
    if (recordings.peek() === all) say("The fit was stopped.");
  } finally {
    if (aborting === own) {
      progress.value = null;
      aborting = null;
    }
  }
}

export function abort() {
  aborting?.abort();
}

/** Puts the fitted texture on the pad, played by a model, with its recorded spectra behind. */
export async function toPad(model?: string) {
  const [result, make, all] = [fitted.peek(), loops, recordings.peek()];
  await theAuthor();
  if (!result || !make) return;
  const bytes = result.texture.toBytes();
  const { report } = result;
  const conditions = report.conditions.map((condition) => ({ speed: (condition["speed_mm_s"] as number | undefined) ?? null, force: (condition["force_n"] as number | undefined) ?? null }));
  recordedWork.value = { bytes, names: all.map(({ name }) => name), loops: make, report, conditions };
  await begin(bytes, "fit a recording", model ?? rankedBy(report, result.isLevelKnown).ranked[0]);
  screen.value = "shape";
}
