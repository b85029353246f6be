// What the page shows: the present texture with its history, the screen, and what was said last.

import { batch, computed, signal } from "@preact/signals";
import { open, type Texture } from "htex";

import { NO_WORK, active, at, back, forth, isSameWork, step, withActive, type Document, type History, type Work } from "./history.ts";
import { usualGain } from "./loudness.ts";
import { troubleOf } from "./trouble.ts";

export type Screen = "shelf" | "shape" | "mix" | "vary" | "compare" | "record" | "give";

export interface Notice {
  text: string;
  kind: "good" | "bad" | "plain";
  /** The exact words, behind *Details*. */
  details?: string;
  /** Takes back what the message says. */
  undo?: (() => unknown) | undefined;
}

/** Both versions of the work. */
export const work = signal<Work>(NO_WORK);
/** The history of the version that is on the pad. */
export const history = computed(() => active(work.value));

export const screen = signal<Screen>("shelf");
export const notice = signal<Notice | null>(null);
/** The present texture, opened. It changes together with the present document. */
export const texture = signal<Texture | null>(null);
export const present = computed(() => history.value.present);
/** The texture as it was opened: what edits are compared with. */
export const origin = computed(() => history.value.present?.origin ?? null);
export const undoable = computed(() => history.value.past.at(-1) && history.value.present?.change);
export const redoable = computed(() => history.value.future[0]?.change);
export const depth = computed(() => history.value.past.length);

/** Milliseconds after which a message goes. A message of an error stays, and one that offers Undo. */
const SHOWN_MS = 6000;

export function say(text: string, kind: Notice["kind"] = "plain", more: Pick<Notice, "details" | "undo"> = {}) {
  const told: Notice = { text, kind, ...more };
  notice.value = told;
  if (kind !== "bad" && !more.undo) setTimeout(() => notice.peek() === told && (notice.value = null), SHOWN_MS);
  return told;
}

export function fail(error: unknown) {
  notice.value = { ...troubleOf(error), kind: "bad" };
}

/** Shows a texture; the one before it is freed when nobody looks at it any more. */
function show(opened: Texture) {
  const before = texture.peek();
  texture.value = opened;
  if (before && before !== opened) queueMicrotask(() => before.free());
}

/** Goes to another state of the work. Its texture is opened first, so that it and the document change together. Returns where this began, or null. */
export async function go(to: (now: Work) => Work | null): Promise<Work | null> {
  const from = work.peek();
  const next = to(from);
  const document = next && active(next).present;
  if (!document || next === from) return null;
  const opened = document === active(from).present ? null : await open(document.bytes);
  // An edit came first: from there, the way may be another.
  if (!isSameWork(work.peek(), from)) {
    opened?.free();
    return go(to);
  }
  batch(() => {
    work.value = next;
    if (opened) show(opened);
  });
  return from;
}

/** Goes along the history of the version that is on the pad. Returns the history before, or null. */
async function along(way: (now: History) => History | null) {
  const from = await go((now) => {
    const next = way(active(now));
    return next && withActive(now, next);
  });
  return from && active(from);
}

/** Takes a step in the version that is on the pad. */
function record(document: Document, gesture: string | null) {
  work.value = withActive(work.peek(), step(history.peek(), document, gesture));
}

/** Puts a texture on the desk as a new piece of work. */
export async function begin(bytes: Uint8Array, change: string, model?: string) {
  const opened = await open(bytes);
  const plays = model && opened.models.includes(model) ? model : best(opened);
  const origin = { id: crypto.randomUUID(), bytes, model: plays, gain: usualGain(opened, plays) };
  const document = { id: origin.id, bytes, name: opened.name, model: plays, change, origin };
  batch(() => {
    record(document, null);
    show(opened);
  });
}

/** The model that plays unless another is chosen: the one of least error. */
function best(opened: Texture): string {
  const voice = opened.voice();
  const { model } = voice;
  voice.free();
  return model;
}

/** Takes an edited texture. Steps of the same gesture, such as one drag, are undone together. */
export function edit(made: { texture: Texture; bytes: Uint8Array; model: string; change: string }, gesture: string | null = null) {
  const { present: before } = history.peek();
  if (!before) return;
  const { bytes, model, change } = made;
  const document = { id: crypto.randomUUID(), bytes, name: made.texture.name, model, change, origin: before.origin };
  batch(() => {
    record(document, gesture);
    show(made.texture);
  });
}

/** Plays another of the texture's models. */
export function choose(model: string) {
  const { present: before } = history.peek();
  if (!before || before.model === model) return;
  record({ ...before, id: crypto.randomUUID(), model, change: "choose a model" }, null);
}

/** Ends a gesture: what follows is a step of its own. */
export function settle() {
  const now = history.peek();
  if (now.gesture !== null) work.value = withActive(work.peek(), { ...now, gesture: null });
}

export async function undo() {
  const from = await along(back);
  if (from) say(`Undone: ${from.present?.change}`);
}

export async function redo() {
  if (await along(forth)) say(`Redone: ${history.peek().present?.change}`);
}

/** Goes to one of the steps: undoes or redoes all between. */
export async function visit(id: string) {
  const from = await along((now) => at(now, id));
  if (!from) return;
  const steps = history.peek().past.length - from.past.length;
  say(`${Math.abs(steps)} ${Math.abs(steps) === 1 ? "step" : "steps"} ${steps < 0 ? "undone" : "redone"}.`);
}
