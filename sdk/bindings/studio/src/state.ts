// What the page shows: the present texture with its history, the screen, and what was said last.

import { batch, computed, signal } from "@preact/signals";
import { open, type Texture } from "htex";

/** A texture at one moment of the work. Nothing of it changes. */
export interface Document {
  readonly bytes: Uint8Array;
  readonly name: string;
  /** Id of the model that plays. */
  readonly model: string;
  /** What was done to come here, in a few words. */
  readonly change: string;
}

export type Screen = "shelf" | "shape" | "mix" | "vary" | "compare" | "record" | "give";

export interface Notice {
  text: string;
  kind: "good" | "bad" | "plain";
}

/** Most steps that can be undone. */
export const STEPS = 500;

interface History {
  readonly past: readonly Document[];
  readonly present: Document | null;
  readonly future: readonly Document[];
  /** The gesture that made the present document; the next step of the same gesture replaces it. */
  readonly gesture: string | null;
}

const history = signal<History>({ past: [], present: null, future: [], gesture: null });

export const screen = signal<Screen>("shelf");
export const notice = signal<Notice | null>(null);
/** The present texture, opened. It trails the document by the time of opening. */
export const texture = signal<Texture | null>(null);
/** The document as it was when it came to the desk: what edits are compared with. */
export const origin = signal<Document | null>(null);
export const present = computed(() => history.value.present);
export const undoable = computed(() => history.value.past.at(-1) && history.value.present?.change);
export const redoable = computed(() => history.value.future[0]?.change);
export const depth = computed(() => history.value.past.length);

/** Milliseconds after which a message goes; one of an error stays. */
const SHOWN_MS = 6000;

export function say(text: string, kind: Notice["kind"] = "plain") {
  const told = { text, kind };
  notice.value = told;
  if (kind !== "bad") setTimeout(() => notice.peek() === told && (notice.value = null), SHOWN_MS);
}

export function fail(error: unknown) {
  say(error instanceof Error ? error.message : String(error), "bad");
}

/** Shows a texture; the one before it is freed when nobody looks at it any more. */
function show(opened: Texture) {
  const before = texture.peek();
  texture.value = opened;
  if (before && before !== opened) queueMicrotask(() => before.free());
}

let opening = 0;

/** Opens the present document; a later call wins. */
async function reopen() {
  const document = history.peek().present;
  opening += 1;
  const ticket = opening;
  if (!document) return;
  const opened = await open(document.bytes);
  if (ticket === opening) show(opened);
  else opened.free();
}

/** Puts a texture on the desk as a new piece of work. */
export async function begin(bytes: Uint8Array, change: string, model?: string) {
  const opened = await open(bytes);
  const document = { bytes, name: opened.name, model: model ?? best(opened), change };
  opening += 1;
  const { past, present: before } = history.peek();
  batch(() => {
    history.value = { past: before ? keep([...past, before]) : past, present: document, future: [], gesture: null };
    origin.value = document;
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

function keep(past: readonly Document[]) {
  return past.slice(-STEPS);
}

/** Takes an edited texture. Steps of the same gesture, such as one drag, are undone together. */
export function edit(made: { texture: Texture; bytes: Uint8Array; model: string; change: string }, gesture: string | null = null) {
  const { past, present: before, gesture: last } = history.peek();
  const document = { bytes: made.bytes, name: made.texture.name, model: made.model, change: made.change };
  const continues = gesture !== null && gesture === last;
  const kept = continues || !before ? past : keep([...past, before]);
  opening += 1;
  batch(() => {
    history.value = { past: kept, present: document, future: [], gesture };
    show(made.texture);
  });
}

/** Plays another of the texture's models. */
export function choose(model: string) {
  const { present: before } = history.peek();
  if (!before || before.model === model) return;
  const { past } = history.peek();
  history.value = { past: keep([...past, before]), present: { ...before, model, change: "choose a model" }, future: [], gesture: null };
}

/** Ends a gesture: what follows is a step of its own. */
export function settle() {
  if (history.peek().gesture !== null) history.value = { ...history.peek(), gesture: null };
}

export async function undo() {
  const { past, present: now, future } = history.peek();
  const before = past.at(-1);
  if (!before || !now) return;
  history.value = { past: past.slice(0, -1), present: before, future: [now, ...future], gesture: null };
  say(`Undone: ${now.change}`);
  await reopen();
}

export async function redo() {
  const { past, present: now, future } = history.peek();
  const next = future[0];
  if (!next || !now) return;
  history.value = { past: [...past, now], present: next, future: future.slice(1), gesture: null };
  say(`Redone: ${next.change}`);
  await reopen();
}
