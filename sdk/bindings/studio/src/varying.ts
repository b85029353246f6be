// Nine textures near the present one.

import { effect, signal } from "@preact/signals";
import type { Author, Texture } from "htex";

import { author, theAuthor } from "./author.ts";
import { near } from "./conditions.ts";
import { sliders } from "./motion.ts";
import { redrawn } from "./shaping/bands.ts";
import { MACRO_DB, type Bench, type Macros, type Shaper } from "./shaping/shaper.ts";
import { shaperOf } from "./shaping/shapers.ts";
import { fromDecibels, make, read, type Spec } from "./shaping/spec.ts";
import { edit, history, present, texture } from "./state.ts";

export interface Variation {
  readonly texture: Texture;
  readonly model: string;
  /** What differs, in words. */
  readonly text: string;
}

const COUNT = 9;
/** Largest macro, and change of single handles, dB, at full reach. */
const MOST_MACRO = 0.8;
const MOST_DB = 14;
const MOVED_HANDLES = 3;

/** How far variations are from the present texture, 0 to 1. */
export const reach = signal(0.5);
export const variations = signal<readonly Variation[]>([]);

const random = () => 2 * Math.random() - 1;

function words(macros: Macros) {
  const strongest = (["rougher", "brighter", "peak", "level"] as const).map((name) => [name, macros[name]] as const).sort(([, a], [, b]) => Math.abs(b) - Math.abs(a));
  const opposite = { rougher: "smoother", brighter: "duller", peak: "coarser", level: "fainter" };
  const plain = { rougher: "rougher", brighter: "crisper", peak: "finer", level: "stronger" };
  const [first, second] = strongest;
  return [first, second].filter((one) => one !== undefined).map(([name, value]) => (value < 0 ? opposite[name] : plain[name])).join(", ");
}

/** Moves one of the handles, if there are some. */
function moved(bench: Bench, spec: Spec, shaper: Shaper, db: number): Spec {
  const between = make(bench.author, bench, spec);
  const place = { ...bench, from: between, of: spec };
  const handles = shaper.handles(place, spec);
  const at = Math.floor(Math.random() * handles.length);
  const handle = handles[at];
  const next = handle && handles.length > 1 ? shaper.move(place, spec, at, handle.hz, handle.db + db) : spec;
  between.free();
  return next;
}

/** One texture near the one of the bench. */
function vary(bench: Bench, spec: Spec, shaper: Shaper): Variation {
  const far = reach.peek();
  const macros = { rougher: MOST_MACRO * far * random(), brighter: MOST_MACRO * far * random(), peak: 0.7 * far * random(), level: 0.3 * far * random() };
  let next = shaper.macros(bench, spec, macros);
  next = { ...next, points: next.points.map((point) => ({ ...point, level: point.level * fromDecibels(MACRO_DB * macros.level) })) };
  for (let i = 0; i < MOVED_HANDLES; i++) next = moved(bench, next, shaper, MOST_DB * far * random());
  return { texture: make(bench.author, bench, next), model: next.model, text: words(macros) };
}

function replace(next: readonly Variation[]) {
  const before = variations.peek();
  variations.value = next;
  for (const { texture: old } of before) old.free();
}

function nine(made: Author, now: Texture, model: string) {
  const name = now.models.includes(model) ? model : now.models[0] ?? model;
  const bench = { author: made, from: now, shown: near(now, name, sliders.peek()).place };
  const read_ = read(now, name);
  const spec = shaperOf(read_.model) ? read_ : redrawn(bench, read_);
  const own = spec === read_ ? null : make(made, bench, spec);
  const shaper = shaperOf(spec.model);
  if (!shaper) return [];
  const place = { ...bench, from: own ?? now, of: spec };
  const found = Array.from({ length: COUNT }, () => vary(place, spec, shaper));
  own?.free();
  return found;
}

/** Makes nine others. */
export async function again() {
  const made = await theAuthor();
  const [now, document] = [texture.peek(), present.peek()];
  if (now && document) replace(nine(made, now, document.model));
}

/** Makes nine others when the present texture has changed and the gesture that changed it is over. Returns what ends this. */
export function keepVarying() {
  theAuthor().catch(() => {});
  let varied: Texture | null = null;
  const end = effect(() => {
    const [now, made, document] = [texture.value, author.value, present.peek()];
    if (history.value.gesture !== null || !now || !made || !document || now === varied) return;
    varied = now;
    replace(nine(made, now, document.model));
  });
  return () => {
    end();
    replace([]);
  };
}

/** Takes a variation as the next step. */
export async function takeVariation({ texture: chosen, model, text }: Variation) {
  const bytes = chosen.toBytes();
  const made = await theAuthor();
  const own = make(made, { from: chosen }, read(chosen, model));
  edit({ texture: own, bytes, model, change: `vary: ${text}` });
}
