// The shaping that is going on: the specification of the present texture, and how edits become steps of its history.

import { computed, effect, signal } from "@preact/signals";
import type { Texture } from "htex";

import { author, nameOf, theAuthor } from "../author.ts";
import { near } from "../conditions.ts";
import { sliders } from "../motion.ts";
import { edit, fail, present, say, settle, texture } from "../state.ts";
import { BANDS, redrawn } from "./bands.ts";
import type { Bench, Drawn, Handle, Macros } from "./shaper.ts";
import { shaperOf } from "./shapers.ts";
import { fromDecibels, make, read, type Spec } from "./spec.ts";
import { MACRO_DB } from "./shaper.ts";

export const NO_MACROS: Macros = { rougher: 0, brighter: 0, peak: 0, level: 0 };
export const macros = signal<Macros>(NO_MACROS);

/** The model that is shaped. */
export const model = computed(() => {
  const [now, document] = [texture.value, present.value];
  if (!now || !document) return null;
  return now.models.includes(document.model) ? document.model : now.models[0] ?? null;
});

export const spec = computed<Spec | null>(() => {
  const [now, name] = [texture.value, model.value];
  return now && name ? read(now, name) : null;
});

/** The point whose condition is nearest to what the sliders of the pad are set to; it stays while the finger moves. */
export const shown = computed(() => {
  const [now, name] = [texture.value, model.value];
  return now && name ? near(now, name, sliders.value).place : 0;
});

function bench(from: Texture, of: Spec): Bench | null {
  const made = author.peek();
  return made ? { author: made, from, of, shown: shown.peek() } : null;
}

export const handles = computed<Handle[]>(() => {
  const [now, what, made] = [texture.value, spec.value, author.value];
  if (!now || !what || !made) return [];
  return shaperOf(what.model)?.handles({ author: made, from: now, of: what, shown: shown.value }, what) ?? [];
});

/** What the macros start from: a texture of one's own, since the present one is freed with each step. */
let base: { texture: Texture; spec: Spec; made: Texture | null } | null = null;

function forgetBase() {
  base?.texture.free();
  base = null;
  if (macros.peek() !== NO_MACROS) macros.value = NO_MACROS;
}

/** Whatever else becomes of the texture, the macros begin anew. */
effect(() => {
  const now = texture.value;
  if (base && now !== base.made) forgetBase();
});

/** Takes an edited texture, which has only the edited model, as a step. */
function step(edited: Texture, kept: string, change: string, gesture: string | null) {
  const gone = texture.peek()?.models.filter((id) => id !== kept) ?? [];
  edit({ texture: edited, bytes: edited.toBytes(), model: kept, change }, gesture);
  if (gone.length > 0) say(`The edit kept only ${nameOf(kept)}, and removed ${gone.map(nameOf).join(", ")}. Undo brings them back.`);
}

function take(what: Spec, change: string, gesture: string | null) {
  const [now, made] = [texture.peek(), author.peek()];
  if (now && made) step(make(made, { from: now }, what), what.model, change, gesture);
}

function attempt(run: () => void) {
  try {
    run();
  } catch (error) {
    fail(error);
  }
}

/** Moves a handle; calls of one gesture are one step. */
export function moveHandle(handle: number, hz: number, db: number, gesture: string) {
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    const shaper = what && shaperOf(what.model);
    const name = handles.peek()[handle]?.name.toLowerCase();
    if (place && what && shaper) take(shaper.move(place, what, handle, hz, db), `move ${name ?? "a handle"}`, gesture);
  });
}

/** Draws across bars; calls of one gesture are one step. */
export function drawHandles(all: readonly Drawn[], gesture: string) {
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    const shaped = place && what && shaperOf(what.model)?.draw?.(place, what, all);
    if (shaped) take(shaped, "draw bars", gesture);
  });
}

export function addHandle(hz: number, db: number) {
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    const added = place && what && shaperOf(what.model)?.add?.(place, what, hz, db);
    if (added) take(added, "add a peak", null);
  });
}

export function removeHandle(handle: number) {
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    const left = place && what && shaperOf(what.model)?.remove?.(place, what, handle);
    if (left && left !== what) take(left, "remove a peak", null);
  });
}

/** Draws the curve of another model as Bands, which can be shaped. */
export async function redraw() {
  await theAuthor();
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    if (place && what && what.model !== BANDS) take(redrawn(place, what), "redraw as bands", null);
  });
}

/** Sets a macro; all that change within one gesture is one step. */
export function setMacro(name: keyof Macros, value: number) {
  attempt(() => {
    const [now, what, made] = [texture.peek(), spec.peek(), author.peek()];
    if (!now || !what || !made) return;
    if (!base) {
      const place = { author: made, from: now, of: what, shown: shown.peek() };
      // What cannot be drawn is redrawn first; its level alone can be changed as it is.
      const start = shaperOf(what.model) || name === "level" ? what : redrawn(place, what);
      base = { texture: make(made, { from: now }, start), spec: start, made: null };
    }
    const next = { ...macros.peek(), [name]: value };
    const place = { author: made, from: base.texture, of: base.spec, shown: shown.peek() };
    const shaped = shaperOf(base.spec.model)?.macros(place, base.spec, next) ?? base.spec;
    const factor = fromDecibels(MACRO_DB * next.level);
    const levelled = { ...shaped, points: shaped.points.map((point) => ({ ...point, level: point.level * factor })) };
    const edited = make(made, { from: now }, levelled);
    base.made = edited;
    step(edited, levelled.model, `change ${name}`, `macro ${name}`);
    macros.value = next;
  });
}

/** Sets a parameter by its number. */
export function setParameter(name: string, index: number | null, value: number, gesture: string) {
  attempt(() => {
    const what = spec.peek();
    if (!what) return;
    const points = what.points.map((point, i) => {
      if (i !== shown.peek()) return point;
      const now = point.parameters[name];
      const next = Array.isArray(now) && index !== null ? now.map((x, at) => (at === index ? value : x)) : value;
      return { ...point, parameters: { ...point.parameters, [name]: next } };
    });
    take({ ...what, points }, `set ${name}`, gesture);
  });
}

export const endGesture = settle;
