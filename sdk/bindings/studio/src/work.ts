// The history as the browser stores it: it survives a reload, and all tabs of the page share it.
//
// A tab writes at the end of each gesture. In one transaction it reads what other tabs wrote since, appends its own new steps, and stores
// the result, so the steps of all tabs are kept in the order in which they were written. If two tabs change the history at the same time,
// both then show the later step, and *Undo* leads to the earlier one. Undo and redo give way to a step of another tab. All this is so for
// each version of the work, A and B. Which one is on the pad is stored as well: all tabs show the one that was chosen last.

import { effect } from "@preact/signals";

import { NO_WORK, SLOTS, active, append, documents, isSameWork, otherThan, type Document, type History, type Opened, type Slot, type Work } from "./history.ts";
import { begin, fail, go, history, work } from "./state.ts";
import { ask, putAtOnce, transact } from "./store.ts";
import { onTold, tell } from "./tabs.ts";

/** Milliseconds after the last change at which a gesture that has not ended is written. */
const GESTURE_MS = 1000;

/** A history as it is stored: ids of its documents. */
type Ids = Readonly<Record<"past" | "present" | "future", readonly string[]>>;

interface Stored extends Readonly<Record<Slot, Ids>> {
  /** Another one after each time of writing. */
  readonly revision: string;
  readonly slot: Slot;
}

/** A document as it is stored: without its origin, and without bytes that are those of its origin. */
interface Step extends Omit<Document, "bytes" | "origin"> {
  readonly bytes: Uint8Array | null;
  readonly origin: string;
}

const STORED = "versions";
const stepKey = (id: string) => `step ${id}`;
const originKey = (id: string) => `origin ${id}`;

/** What a tab could not write in time before it was closed: new steps, and the version that it put on the pad. */
interface Left extends Readonly<Record<Slot, readonly Document[]>> {
  readonly slot: Slot | null;
}

const LEFT = "closed ";

/** The stored work as this tab knows it, and its revision. */
let known = NO_WORK;
let revision = "";
/** Id of the texture that is on the pad until the user does something. It is not stored. */
let untouched: string | null = null;

const idsOf = (of: readonly Document[]) => new Set(of.map(({ id }) => id));

/** The documents of both versions, each once: a version that began as a copy shares documents with the other. */
const all = (of: Work) => [...new Map(SLOTS.flatMap((slot) => documents(of[slot])).map((document) => [document.id, document])).values()];

/** The steps of this tab that are not among others. */
function fresh(mine: History, ...others: readonly (readonly Document[])[]): Document[] {
  const steps = documents({ ...mine, future: [] });
  if (steps.length === 1 && steps[0]?.id === untouched) return [];
  const there = idsOf(others.flat());
  return steps.filter(({ id }) => !there.has(id));
}

/** The version that a tab has put on the pad since; null if it is the same. */
const choice = (mine: Work, before: Work) => (mine.slot === before.slot ? null : mine.slot);

/** Appends new steps to both versions, and puts the chosen version on the pad, unless only the other one has a texture. */
function joined(to: Work, { slot, a, b }: Left): Work {
  const both = { a: append(to.a, a), b: append(to.b, b) };
  const wanted = slot ?? to.slot;
  const other = otherThan(wanted);
  return { ...both, slot: !both[wanted].present && both[other].present ? other : wanted };
}

async function load(store: IDBObjectStore, stored: Stored, mine: Work): Promise<Work> {
  const here = [...all(known), ...all(mine)];
  const found = new Map(here.map((document) => [document.id, document]));
  const origins = new Map(here.map(({ origin }) => [origin.id, origin]));
  const ids = new Set(SLOTS.flatMap((slot) => [...stored[slot].past, ...stored[slot].present, ...stored[slot].future]));
  const missing = [...ids].filter((id) => !found.has(id));
  const steps = (await Promise.all(missing.map((id) => ask<Step | undefined>(store.get(stepKey(id)))))).filter((step) => step !== undefined);
  const wanted = [...new Set(steps.map(({ origin }) => origin))].filter((id) => !origins.has(id));
  for (const origin of await Promise.all(wanted.map((id) => ask<Opened | undefined>(store.get(originKey(id)))))) {
    if (origin) origins.set(origin.id, origin);
  }
  for (const step of steps) {
    const origin = origins.get(step.origin);
    if (origin) found.set(step.id, { ...step, bytes: step.bytes ?? origin.bytes, origin });
  }
  const documentsOf = (some: readonly string[]) => some.map((id) => found.get(id)).filter((document) => document !== undefined);
  const of = ({ past, present, future }: Ids): History => ({ past: documentsOf(past), present: documentsOf(present)[0] ?? null, future: documentsOf(future), gesture: null });
  return { slot: stored.slot, a: of(stored.a), b: of(stored.b) };
}

/** Stores a state of the work in the place of another. */
function save(store: IDBObjectStore, next: Work, before: Work, revision: string) {
  const [now, then] = [all(next), all(before)];
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
  const of = ({ past, present, future }: History): Ids => ({ past: ids(past), present: ids(present ? [present] : []), future: ids(future) });
  store.put({ revision, slot: next.slot, a: of(next.a), b: of(next.b) } satisfies Stored, STORED);
}

interface Exchanged {
  /** The work that is stored now. */
  readonly stored: Work;
  readonly revision: string;
  /** Whether another tab's changes are in it. */
  readonly hasOthers: boolean;
  readonly isWritten: boolean;
}

/** Joins a tab's work with what is stored; within one transaction. */
async function join(store: IDBObjectStore, mine: Work): Promise<Exchanged> {
  const range = IDBKeyRange.bound(LEFT, `${LEFT}\uffff`);
  const [stored, lefts] = await Promise.all([ask<Stored | undefined>(store.get(STORED)), ask<Left[]>(store.getAll(range))]);
  const isKnown = (stored?.revision ?? "") === revision;
  const before = isKnown ? known : stored ? await load(store, stored, mine) : NO_WORK;
  const missing = (of: readonly Document[], slot: Slot) => of.filter(({ id }) => !idsOf(documents(before[slot])).has(id));
  const theirs = lefts.reduce((to, { slot, a, b }) => joined(to, { slot, a: missing(a, "a"), b: missing(b, "b") }), before);
  const hasOthers = (!isKnown && stored !== undefined) || !isSameWork(theirs, before);
  const added = (slot: Slot) => fresh(mine[slot], stored ? documents(known[slot]) : [], documents(theirs[slot]));
  const own: Left = { slot: choice(mine, known), a: added("a"), b: added("b") };
  const hasChanged = own.a.length + own.b.length > 0 || (active(before).present !== null && !isSameWork(mine, known));
  const next = hasOthers ? joined(theirs, own) : hasChanged ? mine : before;
  const isWritten = !isSameWork(next, before);
  const current = isWritten ? crypto.randomUUID() : stored?.revision ?? "";
  if (isWritten) save(store, next, before, current);
  if (lefts.length > 0) store.delete(range);
  return { stored: next, revision: current, hasOthers, isWritten };
}

async function exchange() {
  const mine = work.peek();
  // If it fails, the store's `refusal` says so.
  const told = await transact("session", "readwrite", (store) => join(store, mine)).catch(() => null);
  if (!told) return;
  const { stored } = told;
  const since = (now: Work, slot: Slot) => fresh(now[slot], documents(mine[slot]), documents(stored[slot]));
  if (told.isWritten) tell("work");
  if (told.hasOthers) await go((now) => (isSameWork(now, mine) ? stored : joined(stored, { slot: choice(now, mine), a: since(now, "a"), b: since(now, "b") })));
  // A texture that cannot be opened is not known: it stays stored, and the next step is appended to it.
  known = stored;
  revision = told.revision;
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
    const { gesture } = active(work.value);
    clearTimeout(timer);
    if (gesture === null) void keep();
    else timer = window.setTimeout(keep, GESTURE_MS);
  });
  // A gesture that goes on is written when it ends, and joined with the others then.
  onTold("work", () => history.peek().gesture === null && void keep());
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && void keep());
  const key = LEFT + crypto.randomUUID();
  addEventListener("pagehide", () => {
    const now = work.peek();
    const left: Left = { slot: choice(now, known), a: fresh(now.a, documents(known.a)), b: fresh(now.b, documents(known.b)) };
    if (left.slot === null && left.a.length + left.b.length === 0) return;
    // There is no time to read first. The next tab that writes appends the steps.
    putAtOnce(left, key);
    tell("work");
  });
}
