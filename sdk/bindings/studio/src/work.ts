// The history as the browser stores it: it survives a reload, and all tabs of the page share it.
//
// A tab writes at the end of each gesture. In one transaction it reads what other tabs wrote since, appends its own new steps, and stores
// the result, so the steps of all tabs are kept in the order in which they were written. If two tabs change the history at the same time,
// both then show the later step, and *Undo* leads to the earlier one. Undo and redo give way to a step of another tab.

import { effect } from "@preact/signals";

import { EMPTY, append, documents, isSame, type Document, type History, type Opened } from "./history.ts";
import { begin, fail, go, history } from "./state.ts";
import { ask, putAtOnce, transact } from "./store.ts";
import { onTold, tell } from "./tabs.ts";

/** Milliseconds after the last change at which a gesture that has not ended is written. */
const GESTURE_MS = 1000;

/** The history as it is stored: ids of its documents. */
interface Stored {
  /** Another one after each time of writing. */
  readonly revision: string;
  readonly past: readonly string[];
  readonly present: string;
  readonly future: readonly string[];
}

/** A document as it is stored: without its origin, and without bytes that are those of its origin. */
interface Step extends Omit<Document, "bytes" | "origin"> {
  readonly bytes: Uint8Array | null;
  readonly origin: string;
}

const STORED = "work";
const stepKey = (id: string) => `step ${id}`;
const originKey = (id: string) => `origin ${id}`;
/** What a tab could not write in time before it was closed. */
const LEFT = "left ";

/** The stored history as this tab knows it, and its revision. */
let known = EMPTY;
let revision = "";
/** Id of the texture that is on the pad until the user does something. It is not stored. */
let untouched: string | null = null;

const idsOf = (of: readonly Document[]) => new Set(of.map(({ id }) => id));

/** The steps of this tab that are not among others. */
function fresh(mine: History, ...others: readonly (readonly Document[])[]): Document[] {
  const steps = documents({ ...mine, future: [] });
  if (steps.length === 1 && steps[0]?.id === untouched) return [];
  const there = idsOf(others.flat());
  return steps.filter(({ id }) => !there.has(id));
}

async function load(store: IDBObjectStore, stored: Stored, mine: History): Promise<History> {
  const here = [...documents(known), ...documents(mine)];
  const all = new Map(here.map((document) => [document.id, document]));
  const origins = new Map(here.map(({ origin }) => [origin.id, origin]));
  const ids = [...stored.past, stored.present, ...stored.future];
  const missing = ids.filter((id) => !all.has(id));
  const steps = (await Promise.all(missing.map((id) => ask<Step | undefined>(store.get(stepKey(id)))))).filter((step) => step !== undefined);
  const wanted = [...new Set(steps.map(({ origin }) => origin))].filter((id) => !origins.has(id));
  for (const origin of await Promise.all(wanted.map((id) => ask<Opened | undefined>(store.get(originKey(id)))))) {
    if (origin) origins.set(origin.id, origin);
  }
  for (const step of steps) {
    const origin = origins.get(step.origin);
    if (origin) all.set(step.id, { ...step, bytes: step.bytes ?? origin.bytes, origin });
  }
  const found = (some: readonly string[]) => some.map((id) => all.get(id)).filter((document) => document !== undefined);
  return { past: found(stored.past), present: all.get(stored.present) ?? null, future: found(stored.future), gesture: null };
}

/** Stores a history in the place of another. */
function save(store: IDBObjectStore, next: History, before: History, revision: string) {
  const [now, then] = [documents(next), documents(before)];
  const [steps, gone] = [idsOf(then), idsOf(now)];
  const originsOf = (some: readonly Document[]) => new Map(some.map(({ origin }) => [origin.id, origin]));
  const [origins, others] = [originsOf(now), originsOf(then)];
  for (const { origin, bytes, ...step } of now) {
    if (!steps.has(step.id)) store.put({ ...step, bytes: bytes === origin.bytes ? null : bytes, origin: origin.id } satisfies Step, stepKey(step.id));
  }
  for (const [id, origin] of origins) if (!others.has(id)) store.put(origin, originKey(id));
  for (const id of steps) if (!gone.has(id)) store.delete(stepKey(id));
  for (const id of others.keys()) if (!origins.has(id)) store.delete(originKey(id));
  const ids = (some: readonly Document[]) => some.map(({ id }) => id);
  const stored: Stored = { revision, past: ids(next.past), present: next.present?.id ?? "", future: ids(next.future) };
  store.put(stored, STORED);
}

interface Exchanged {
  /** The history that is stored now. */
  readonly stored: History;
  readonly revision: string;
  /** Whether another tab's steps are in it. */
  readonly hasOthers: boolean;
  readonly isWritten: boolean;
}

/** Joins a tab's history with what is stored; within one transaction. */
async function join(store: IDBObjectStore, mine: History): Promise<Exchanged> {
  const left = IDBKeyRange.bound(LEFT, `${LEFT}\uffff`);
  const [stored, lefts] = await Promise.all([ask<Stored | undefined>(store.get(STORED)), ask<Document[][]>(store.getAll(left))]);
  const isKnown = (stored?.revision ?? "") === revision;
  const before = isKnown ? known : stored ? await load(store, stored, mine) : EMPTY;
  const steps = lefts.flat().filter(({ id }) => !idsOf(documents(before)).has(id));
  const hasOthers = (!isKnown && stored !== undefined) || steps.length > 0;
  const theirs = append(before, steps);
  const added = fresh(mine, stored ? documents(known) : [], documents(theirs));
  const hasChanged = added.length > 0 || (before.present !== null && !isSame(mine, known));
  const next = hasOthers ? append(theirs, added) : hasChanged ? mine : before;
  const isWritten = next !== before;
  const current = isWritten ? crypto.randomUUID() : stored?.revision ?? "";
  if (isWritten) save(store, next, before, current);
  if (lefts.length > 0) store.delete(left);
  return { stored: next, revision: current, hasOthers, isWritten };
}

async function exchange() {
  const mine = history.peek();
  // If it fails, the store's `refusal` says so.
  const joined = await transact("session", "readwrite", (store) => join(store, mine)).catch(() => null);
  if (!joined) return;
  const { stored } = joined;
  const seen = [...documents(mine), ...documents(stored)];
  if (joined.isWritten) tell("work");
  if (joined.hasOthers) await go((now) => (isSame(now, mine) ? stored : append(stored, fresh(now, seen))));
  // A texture that cannot be opened is not known: it stays stored, and the next step is appended to it.
  known = stored;
  revision = joined.revision;
}

let line = Promise.resolve();
let isQueued = false;

/** Writes what is new in this tab, and reads what is new in others. */
export function keep(): Promise<void> {
  if (!isQueued) {
    isQueued = true;
    line = line.then(() => {
      isQueued = false;
      return exchange();
    }).catch(fail);
  }
  return line;
}

/** Puts a texture on the pad that is not stored before the user does something with it. */
export async function suggest(bytes: Uint8Array, change: string) {
  await begin(bytes, change);
  untouched = history.peek().present?.id ?? null;
}

/** Stores the work from now on, and follows the other tabs. */
export function keepWork() {
  let timer = 0;
  effect(() => {
    const { gesture } = history.value;
    clearTimeout(timer);
    if (gesture === null) void keep();
    else timer = window.setTimeout(keep, GESTURE_MS);
  });
  // A gesture that goes on is written when it ends, and joined with the others then.
  onTold("work", () => history.peek().gesture === null && void keep());
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && void keep());
  const key = LEFT + crypto.randomUUID();
  addEventListener("pagehide", () => {
    const steps = fresh(history.peek(), documents(known));
    if (steps.length === 0) return;
    // There is no time to read first. The next tab that writes appends the steps.
    putAtOnce(steps, key);
    tell("work");
  });
}
