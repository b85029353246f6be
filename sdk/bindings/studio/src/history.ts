// The history: the present texture, the textures before it, and the undone ones. There are two versions of the work, A and B, each with
// its own history. Nothing here changes a history; each function returns a new one.

/** A texture as it was opened: what edits of it are compared with, and what sets their loudness. */
export interface Opened {
  readonly id: string;
  readonly bytes: Uint8Array;
  readonly model: string;
  /** Gain at which this texture has the usual loudness. Its edits play with the same gain, so that a change of level is heard. */
  readonly gain: number;
}

/** A texture at one moment of the work. */
export interface Document {
  readonly id: string;
  readonly bytes: Uint8Array;
  readonly name: string;
  /** Id of the model that plays. */
  readonly model: string;
  /** What made this texture of the one before, in a few words. */
  readonly change: string;
  /** The texture that was opened and then edited to this one. */
  readonly origin: Opened;
}

export interface History {
  readonly past: readonly Document[];
  readonly present: Document | null;
  readonly future: readonly Document[];
  /** The gesture that made the present document; the next step of the same gesture replaces it. */
  readonly gesture: string | null;
}

/** Most steps that can be undone. */
export const STEPS = 500;
/** Most bytes of textures in a history. At least one step can be undone however large the textures are. */
export const BYTES = 16 * 2 ** 20;

export const EMPTY: History = { past: [], present: null, future: [], gesture: null };

/** All documents, the oldest first. */
export function documents({ past, present, future }: History): Document[] {
  return present ? [...past, present, ...future] : [];
}

/** The last of the documents before a present one, as many as a history holds. */
function bounded(past: readonly Document[], present: Document): readonly Document[] {
  const counted = new Set<Uint8Array>();
  let total = 0;
  // Documents share the bytes of their origin, and of the document before if only the model was chosen.
  const count = (bytes: Uint8Array) => {
    if (!counted.has(bytes)) total += bytes.length;
    counted.add(bytes);
  };
  const size = ({ bytes, origin }: Document) => (count(bytes), count(origin.bytes), total);
  size(present);
  let first = past.length;
  for (; first > Math.max(past.length - STEPS, 0); first--) {
    const before = past[first - 1];
    if (before && size(before) > BYTES && first < past.length) break;
  }
  return first === 0 ? past : past.slice(first);
}

/** Adds documents after the present one, as steps. */
export function append(history: History, added: readonly Document[]): History {
  const last = added.at(-1);
  if (!last) return history;
  const before = history.present ? [...history.past, history.present] : history.past;
  return { past: bounded([...before, ...added.slice(0, -1)], last), present: last, future: [], gesture: null };
}

/** Adds a step. If it belongs to the gesture that made the present document, it replaces that document. */
export function step(history: History, document: Document, gesture: string | null): History {
  if (gesture === null || gesture !== history.gesture) return { ...append(history, [document]), gesture };
  return { past: bounded(history.past, document), present: document, future: [], gesture };
}

export function back({ past, present, future }: History): History | null {
  const before = past.at(-1);
  return before && present ? { past: past.slice(0, -1), present: before, future: [present, ...future], gesture: null } : null;
}

export function forth({ past, present, future }: History): History | null {
  const next = future[0];
  return next && present ? { past: [...past, present], present: next, future: future.slice(1), gesture: null } : null;
}

/** Goes to one of the documents: undoes or redoes all steps between. */
export function at(history: History, id: string): History | null {
  const all = documents(history);
  const place = all.findIndex((document) => document.id === id);
  const present = all[place];
  if (!present || place === history.past.length) return null;
  return { past: all.slice(0, place), present, future: all.slice(place + 1), gesture: null };
}

/** Whether two histories have the same documents. */
export function isSame(a: History, b: History) {
  return a.past === b.past && a.present === b.present && a.future === b.future;
}

export type Slot = "a" | "b";
export const SLOTS: readonly Slot[] = ["a", "b"];

/** Both versions, and the one that is on the pad. A version that was never used has an empty history. */
export interface Work extends Readonly<Record<Slot, History>> {
  readonly slot: Slot;
}

export const NO_WORK: Work = { slot: "a", a: EMPTY, b: EMPTY };

export const otherThan = (slot: Slot): Slot => (slot === "a" ? "b" : "a");

/** The history of the version that is on the pad. */
export const active = (work: Work): History => work[work.slot];

/** The same work with another history of the version that is on the pad. */
export const withActive = (work: Work, history: History): Work => ({ ...work, [work.slot]: history });

/** Puts a version on the pad. A version that was never used begins as a copy, with the history. */
export function swapped(work: Work, slot: Slot): Work {
  if (slot === work.slot) return work;
  // A gesture does not go on in another version.
  const left = { ...active(work), gesture: null };
  return { ...withActive(work, left), slot, [slot]: work[slot].present ? work[slot] : left };
}

/** Copies the present texture to the other version, as a step of that version: undo leads back to what it was. */
export function copied(work: Work): Work {
  const { present } = active(work);
  if (!present) return work;
  const other = otherThan(work.slot);
  const copy = { ...present, id: crypto.randomUUID(), change: `copy of ${work.slot.toUpperCase()}` };
  return { ...work, [other]: step(work[other], copy, null) };
}

/** Whether two states of the work have the same documents, and the same version is on the pad. */
export function isSameWork(one: Work, other: Work) {
  return one.slot === other.slot && SLOTS.every((slot) => isSame(one[slot], other[slot]));
}
