// The shaping that is going on: the specification of the present texture, and how edits become steps of its history.

import { effect, signal } from "@preact/signals";
import type { Texture } from "htex";

import { author, theAuthor } from "../author.ts";
import { finish } from "../first-steps.ts";
import { titleOf } from "../model-words.ts";
import { edit, fail, say, settle, texture } from "../state.ts";
import { BANDS, redrawn } from "./bands.ts";
import { limits, limitsSet, lock } from "./limits.ts";
import { isFree, isInRange, MACRO_DB, NO_LIMITS, type Bench, type Drawn, type Macros, type Shaper } from "./shaper.ts";
import { shaperOf } from "./shapers.ts";
import { clamp, fromDecibels, make, type Spec } from "./spec.ts";
import { handles, model, shown, spec } from "./subject.ts";

export { handles, model, shown, spec };

export const NO_MACROS: Macros = { rougher: 0, brighter: 0, peak: 0, level: 0 };
export const macros = signal<Macros>(NO_MACROS);

function bench(from: Texture, of: Spec): Bench | null {
  const made = author.peek();
  return made ? { author: made, from, of, shown: shown.peek(), limits: limits.peek() } : null;
}

/** What the macros start from: a texture of one's own, since the present one is freed with each step. */
let base: { texture: Texture; spec: Spec; made: Texture | null } | null = null;

function forgetBase() {
  base?.texture.free();
  base = null;
  if (macros.peek() !== NO_MACROS) macros.value = NO_MACROS;
}

/** If anything else changes the texture, the macros begin anew. */
effect(() => {
  const now = texture.value;
  if (base && now !== base.made) forgetBase();
});

/** With other limits, the macros begin anew, and what they changed before stays. */
effect(() => {
  void limitsSet.value;
  forgetBase();
});

/** Takes an edited texture, which has only the edited model, as a step. */
function step(edited: Texture, kept: string, change: string, gesture: string | null) {
  const gone = texture.peek()?.models.filter((id) => id !== kept) ?? [];
  edit({ texture: edited, bytes: edited.toBytes(), model: kept, change }, gesture);
  // Who changes it hears it.
  finish("touch");
  finish("change");
  if (gone.length > 0) say(`The texture now has one model: ${titleOf(kept)}. Undo brings back the others.`);
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

/** Whether an edit on the curve may change a handle. If a lock or the range forbids it, says why. */
function mayMove(handle: number): boolean {
  const [one, what] = [handles.peek()[handle], spec.peek()];
  const { locked, range } = limits.peek();
  if (!one || !what) return false;
  if (locked.has(handle)) say(`${one.name} is locked. Unlock it to move it.`);
  else if (range && !shaperOf(what.model)?.isLocal) say(`${titleOf(what.model)} cannot change only a range. Redraw it as a free curve, or change all frequencies.`);
  else if (!isInRange(limits.peek(), one.hz)) say(`${one.name} is outside the range that may change.`);
  else return true;
  return false;
}

/** Moves a handle; calls of one gesture are one step. */
export function moveHandle(handle: number, hz: number, db: number, gesture: string) {
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    const shaper = what && shaperOf(what.model);
    if (!place || !what || !shaper || !mayMove(handle)) return;
    const { range } = limits.peek();
    const moved = shaper.move(place, what, handle, range ? clamp(hz, ...range) : hz, db);
    const name = handles.peek()[handle]?.name ?? "a handle";
    if (moved === what) say(`${name} cannot move while another handle is locked.`);
    else take(moved, `move ${name.toLowerCase()}`, gesture);
  });
}

/** Draws across bars; calls of one gesture are one step. Locked bars, and bars outside the range, stay. */
export function drawHandles(all: readonly Drawn[], gesture: string) {
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    const free = all.filter(({ handle }) => isFree(limits.peek(), handle, handles.peek()[handle]?.hz ?? 0));
    const [first] = all;
    if (all.length === 1 && free.length === 0 && first) return void mayMove(first.handle);
    const shaped = place && what && free.length > 0 && shaperOf(what.model)?.draw?.(place, what, free);
    if (shaped) take(shaped, "draw bars", gesture);
  });
}

export function addHandle(hz: number, db: number) {
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    const { locked, range } = limits.peek();
    const added = place && what && shaperOf(what.model)?.add?.(place, what, range ? clamp(hz, ...range) : hz, db);
    if (!added || added === what) return;
    take(added, "add a peak", null);
    lock(locked);
  });
}

export function removeHandle(handle: number) {
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    const { locked } = limits.peek();
    if (!mayMove(handle)) return;
    const left = place && what && shaperOf(what.model)?.remove?.(place, what, handle);
    if (!left || left === what) return;
    take(left, "remove a peak", null);
    // The handles after it have another index now.
    lock([...locked].map((one) => (one > handle ? one - 1 : one)));
  });
}

/** Draws the curve of another model as Bands, whose curve is free. */
export async function redraw() {
  await theAuthor();
  attempt(() => {
    const [now, what] = [texture.peek(), spec.peek()];
    const place = now && what && bench(now, what);
    if (place && what && what.model !== BANDS) take(redrawn(place, what), "redraw as a free curve", null);
  });
}

/** Whether a macro can change a model's curve as it is. Otherwise the curve is redrawn as Bands first. */
function suits(shaper: Shaper | undefined, name: keyof Macros) {
  const { range } = limits.peek();
  return shaper ? shaper.isLocal || !range : name === "level" && !range;
}

/** Whether a macro can change something, or locked handles prevent it. */
export function canTurn(name: keyof Macros): boolean {
  const { locked, range } = limits.value;
  if (locked.size === 0) return true;
  const shaper = shaperOf(model.value ?? "");
  if (range && !shaper?.isLocal) return true;
  if (shaper?.turns) return shaper.turns(name, locked);
  return handles.value.some(({ hz }, i) => isFree(limits.value, i, hz));
}

/** Sets a macro; all that change within one gesture is one step. */
export function setMacro(name: keyof Macros, value: number) {
  attempt(() => {
    const [now, what, made] = [texture.peek(), spec.peek(), author.peek()];
    if (!now || !what || !made) return;
    base ??= { texture: make(made, { from: now }, what), spec: what, made: null };
    if (!suits(shaperOf(base.spec.model), name)) {
      const before = base.texture;
      const start = redrawn({ author: made, from: before, of: base.spec, shown: shown.peek() }, base.spec);
      base = { ...base, texture: make(made, { from: before }, start), spec: start };
      before.free();
    }
    const next = { ...macros.peek(), [name]: value };
    // Locks are of the handles of the model that was redrawn.
    const set = limits.peek();
    const only = base.spec.model === what.model || set === NO_LIMITS ? set : { ...set, locked: NO_LIMITS.locked };
    const place = { author: made, from: base.texture, of: base.spec, shown: shown.peek(), limits: only };
    const shaped = shaperOf(base.spec.model)?.macros(place, base.spec, next) ?? base.spec;
    // With limits, the shaper has changed the level of what may change.
    const factor = only === NO_LIMITS ? fromDecibels(MACRO_DB * next.level) : 1;
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
