// The two sides that are compared, and how loud each one plays.

import { batch, computed, effect, signal } from "@preact/signals";
import type { RecordedLoop, Texture } from "htex";

import { near } from "./conditions.ts";
import { tried } from "./engine.ts";
import { LOUDNESS } from "./loudness.ts";
import { sliders } from "./motion.ts";
import { titleOf } from "./model-words.ts";
import { isolated } from "./names.ts";
import { opened, presentWork, recordedLoop } from "./reference.ts";
import { items } from "./shelf.ts";
import { fail, present, texture } from "./state.ts";

export type Side = "a" | "b";

/** What a side is: "present", "opened", "model ID" of the present texture, "recording NAME" that it was fitted to, or an item of the shelf. */
export const sides = signal<Record<Side, string>>({ a: "present", b: "opened" });
export const isMatched = signal(true);
export const heardSide = signal<Side | "x" | null>(null);

/** Escape or another screen also silences this one. */
effect(() => {
  if (!tried.value) heardSide.value = null;
});

/** What plays on a side. */
export interface Played {
  readonly name: string;
  readonly texture: Texture;
  readonly model: string;
  /** The recording, which sounds in place of the texture. */
  readonly loop?: RecordedLoop;
}

const RECORDING = "recording ";

export const choices = computed(() => {
  const models = texture.value?.models ?? [];
  const own = models.length > 1 ? models.map((id) => ({ id: `model ${id}`, name: `This texture: ${titleOf(id)}` })) : [];
  const recorded = presentWork.value?.names.map((name) => ({ id: RECORDING + name, name: `The recording ${isolated(name)}` })) ?? [];
  return [{ id: "present", name: `${present.value ? isolated(present.value.name) : "The present texture"}, now` }, { id: "opened", name: "As it was opened" }, ...recorded, ...own, ...items.value.map(({ id, name }) => ({ id, name: `Shelf: ${isolated(name)}` }))];
});

function played(id: string): Played | null {
  const [now, document] = [texture.value, present.value];
  if (!now || !document) return null;
  const loop = id.startsWith(RECORDING) ? recordedLoop(id.slice(RECORDING.length)) : null;
  if (loop === undefined) return null;
  if (loop) return { name: `the recording ${loop.recording}`, texture: now, model: modelOf(now, document.model), loop };
  if (id === "opened" && opened.value) return { name: `${opened.value.texture.name}, as it was opened`, ...opened.value };
  const model = id.startsWith("model ") ? id.slice(6) : null;
  if (model && now.models.includes(model)) return { name: `${document.name} by ${model.replace("org.htex.", "")}`, texture: now, model };
  const item = items.value.find((one) => one.id === id);
  if (item) {
    // Until it is open there is nothing to play; then this is asked again.
    item.open().catch(fail);
    return item.opened.value && { name: item.name, ...item.opened.value };
  }
  return { name: document.name, texture: now, model: modelOf(now, document.model) };
}

function modelOf({ models }: Texture, wanted: string) {
  return models.includes(wanted) ? wanted : models[0] ?? "";
}

/** Both sides with their gains, and whether the gains match their levels. */
export interface Pair {
  readonly a: Played;
  readonly b: Played;
  readonly gains: Readonly<Record<Side, number>>;
  readonly isMatched: boolean;
}

/** The sides that the user has chosen. */
export const chosen = computed(() => ({ a: played(sides.value.a), b: played(sides.value.b) }));
/** The pair of the running blind test. Edits and choices do not change it. */
export const frozen = signal<Pair | null>(null);
/** Whether a blind test is running. Until it ends, nothing on the page may show what sounds. */
export const isBlind = computed(() => frozen.value !== null);
export const both = computed(() => frozen.value ?? chosen.value);

/** The level of a side at the motion of the pad's sliders. A recording has its own level. */
function levelOf({ texture: of, model, loop }: Played) {
  if (loop) return loop.level_rms;
  const at = sliders.peek();
  return of.level({ model, at }) || near(of, model, at).level;
}

/**
 * The pair that plays now. Each side has the usual loudness. If levels are not matched, only the
 * stronger side has it.
 */
export function pair(): Pair | null {
  const { a, b } = chosen.peek();
  if (frozen.peek() || !a || !b) return frozen.peek();
  const levels = [levelOf(a), levelOf(b)];
  const [ofA = 0, ofB = 0] = levels.map((level) => LOUDNESS / (isMatched.peek() ? level : Math.max(...levels)));
  const finite = (gain: number) => (Number.isFinite(gain) ? gain : 0);
  return { a, b, gains: { a: finite(ofA), b: finite(ofB) }, isMatched: isMatched.peek() };
}

/** Plays a side. */
export function play(side: Side | "x", actual: Side = side === "x" ? "a" : side) {
  const now = pair();
  if (!now) return;
  const { texture: of, model, loop } = now[actual];
  batch(() => {
    tried.value = { texture: of, model, gain: now.gains[actual], loop };
    heardSide.value = side;
  });
}

export function stop() {
  tried.value = null;
  heardSide.value = null;
}
