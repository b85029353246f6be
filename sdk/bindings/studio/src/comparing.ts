// Two sides that are compared, with levels matched; and blind trials.

import { batch, computed, effect, signal } from "@preact/signals";
import type { RecordedLoop, Texture } from "htex";

import { tried } from "./engine.ts";
import { isolated } from "./names.ts";
import { opened, presentWork, recordedLoop } from "./reference.ts";
import { motion } from "./shadow.ts";
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

interface Played {
  readonly name: string;
  readonly texture: Texture;
  readonly model: string;
  /** The recording, which sounds in place of the texture. */
  readonly loop?: RecordedLoop;
}

const RECORDING = "recording ";

export const choices = computed(() => {
  const models = texture.value?.models ?? [];
  const own = models.length > 1 ? models.map((id) => ({ id: `model ${id}`, name: `This texture by ${id.replace("org.htex.", "")}` })) : [];
  const recorded = presentWork.value?.names.map((name) => ({ id: RECORDING + name, name: `The recording ${isolated(name)}` })) ?? [];
  return [{ id: "present", name: `${present.value ? isolated(present.value.name) : "The present texture"}, now` }, { id: "opened", name: "As it was opened" }, ...recorded, ...own, ...items.value.map(({ id, name }) => ({ id, name: `Shelf: ${isolated(name)}` }))];
});

function played(id: string): Played | null {
  const [now, document] = [texture.value, present.value];
  if (!now || !document) return null;
  const loop = id.startsWith(RECORDING) ? recordedLoop(id.slice(RECORDING.length)) : null;
  if (loop === undefined) return null;
  if (loop) return { name: `the recording ${loop.recording}`, texture: now, model: modelOf(now, document.model), loop };
  if (id === "opened" && opened.value) return { name: "as it was opened", ...opened.value };
  const model = id.startsWith("model ") ? id.slice(6) : null;
  if (model && now.models.includes(model)) return { name: model.replace("org.htex.", ""), texture: now, model };
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

export const both = computed(() => ({ a: played(sides.value.a), b: played(sides.value.b) }));

/** The level of a side at the motion of the pad's sliders. A recording has its own level. */
function levelOf({ texture: of, model, loop }: Played) {
  if (loop) return loop.level_rms;
  const { speed, force } = motion.peek();
  return of.level({ model, at: { speed, force } });
}

/** Plays a side. A comes as loud as the piece of work, B as loud as A if levels are matched. */
export function play(side: Side | "x", actual: Side = side === "x" ? "a" : side) {
  const { a, b } = both.peek();
  const chosen = actual === "a" ? a : b;
  if (!a || !b || !chosen) return;
  const factor = actual === "b" && isMatched.peek() ? levelOf(a) / Math.max(levelOf(b), 1e-12) : 1;
  batch(() => {
    tried.value = { texture: chosen.texture, model: chosen.model, gain: factor, loop: chosen.loop };
    heardSide.value = side;
  });
}

export function stop() {
  tried.value = null;
  heardSide.value = null;
}

/** Trials of ABX: X is A or B, drawn each time. */
export const TRIALS = 10;

export interface Trial {
  readonly x: Side;
  readonly answer: Side;
  readonly seconds: number;
}

export const trials = signal<readonly Trial[]>([]);
/** What X is now; null when no test is going on. */
const hidden = signal<Side | null>(null);
export const isTesting = computed(() => hidden.value !== null);
let began = 0;

function draw() {
  const [bit = 0] = crypto.getRandomValues(new Uint8Array(1));
  hidden.value = bit % 2 === 0 ? "a" : "b";
  began = performance.now();
}

export function beginTest() {
  trials.value = [];
  draw();
  play("x", hidden.peek() ?? "a");
}

export function playX() {
  const x = hidden.peek();
  if (x) play("x", x);
}

export function answer(given: Side) {
  const x = hidden.peek();
  if (!x) return;
  trials.value = [...trials.peek(), { x, answer: given, seconds: (performance.now() - began) / 1e3 }];
  if (trials.peek().length === TRIALS) {
    hidden.value = null;
    return stop();
  }
  draw();
  playX();
}

export function abandon() {
  hidden.value = null;
  stop();
}

export const correct = computed(() => trials.value.filter(({ x, answer: given }) => x === given).length);

/** Probability of at least as many right answers by guessing: a one-sided binomial test. */
export function chance(right: number, of: number) {
  let [sum, ways] = [0, 1];
  for (let k = 0; k <= of; k++) {
    if (k >= right) sum += ways;
    ways = (ways * (of - k)) / (k + 1);
  }
  return sum / 2 ** of;
}

/** The trials as a table. */
export function toCsv() {
  const { a, b } = both.peek();
  const quoted = (text: string) => `"${text.replaceAll('"', '""')}"`;
  const rows = trials.peek().map(({ x, answer: given, seconds }, i) => [i + 1, x, given, Number(x === given), seconds.toFixed(2), quoted(a?.name ?? ""), quoted(b?.name ?? ""), Number(isMatched.peek())].join(","));
  return ["trial,x,answer,correct,seconds,a,b,levels_matched", ...rows, ""].join("\n");
}
