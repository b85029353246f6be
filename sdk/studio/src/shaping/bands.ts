// Bands: a bar for each knot.

import type { Author } from "htex";

import { macroGain, macroRatio, type Bench, type Drawn, type Handle, type Macros, type Shaper } from "./shaper.ts";
import { anchored, change, clamp, decibels, list, motionOf, pointDecibels, scalar, type Frame, type Parameters, type Spec } from "./spec.ts";

export const BANDS = "org.htex.bands";
/** Most steps below the highest knot. */
const MOST_STEPS = 255;
/** What another model is redrawn with: as many knots as are fitted by default. */
const REDRAWN = { knots: 30, step_db: 1, layout: 1 };
const SEARCHED = Float64Array.from({ length: 600 }, (_, i) => 20 * 50 ** (i / 599));

const knotCache = new Map<string, number[]>();

/** Frequencies of the knots: where a knot's change is greatest. The model is asked, which alone knows its axis. */
export function knots(author: Author, frame: Frame, parameters: Parameters): number[] {
  const count = list(parameters, "below_highest").length;
  const key = `${count} ${scalar(parameters, "layout")} ${frame.from.band.join(" ")}`;
  const cached = knotCache.get(key);
  if (cached) return cached;
  const found = Array.from({ length: count }, (_, knot) => {
    const below = Array.from({ length: count }, (_, i) => (i === knot ? 0 : 20));
    const probe = { model: BANDS, points: [{ speed: null, force: null, level: 1, parameters: { ...parameters, below_highest: below, step_db: 1 } }] };
    const [curve = []] = decibels(author, frame, probe, SEARCHED);
    return SEARCHED[curve.indexOf(Math.max(...curve))] ?? 20;
  });
  knotCache.set(key, found);
  return found;
}

/** Steps with the highest knot at 0, whole and in range. */
function normalised(below: readonly number[]): number[] {
  const highest = Math.min(...below);
  return below.map((steps) => clamp(Math.round(steps - highest), 0, MOST_STEPS));
}

/** Raises each knot of each point by decibels, and leaves the rest of the curve where it was. */
function raised(bench: Bench, spec: Spec, gain: (knot: number, hz: number) => number): Spec {
  const first = spec.points[bench.shown]?.parameters ?? {};
  const hz = knots(bench.author, bench, first);
  const before = decibels(bench.author, bench, spec, hz);
  const after = change(spec, (parameters) => {
    const step = scalar(parameters, "step_db");
    const below = list(parameters, "below_highest").map((steps, knot) => steps - Math.round(gain(knot, hz[knot] ?? 20) / step));
    return { below_highest: normalised(below) };
  });
  // The highest of the knots that moved least is what the curve is held by.
  const steady = hz.map((f, knot) => Math.abs(gain(knot, f)));
  const least = Math.min(...steady);
  const shownDb = before[bench.shown] ?? [];
  const candidates = hz.map((_, knot) => knot).filter((knot) => (steady[knot] ?? 0) <= least + 1e-9);
  const anchor = candidates.reduce((best, knot) => ((shownDb[knot] ?? -999) > (shownDb[best] ?? -999) ? knot : best), candidates[0] ?? 0);
  const moved = spec.points.map(({ parameters }, i) => {
    const step = scalar(parameters, "step_db");
    return (before[i]?.[anchor] ?? 0) + step * Math.round(gain(anchor, hz[anchor] ?? 20) / step);
  });
  return anchored(bench.author, bench, after, hz[anchor] ?? 100, moved);
}

/** Another model's curve as Bands. */
export function redrawn(bench: Bench, spec: Spec): Spec {
  const frame = { below_highest: new Array<number>(REDRAWN.knots).fill(0), step_db: REDRAWN.step_db, layout: REDRAWN.layout };
  const hz = knots(bench.author, bench, frame);
  const curves = spec.points.map((point) => pointDecibels(bench.from, spec.model, point, hz));
  const points = spec.points.map((point, i) => {
    const curve = curves[i] ?? [];
    const highest = Math.max(...curve);
    return { ...point, parameters: { ...frame, below_highest: normalised(curve.map((db) => (highest - db) / REDRAWN.step_db)) } };
  });
  return { model: BANDS, points };
}

/** Decibels of a curve between its knots, over the logarithm of frequency. */
function between(hz: readonly number[], db: readonly number[], at: number) {
  const next = hz.findIndex((f) => f >= at);
  if (next === 0) return db[0] ?? 0;
  if (next < 0) return db.at(-1) ?? 0;
  const [f, g] = [hz[next - 1] ?? 1, hz[next] ?? 1];
  const part = Math.log(at / f) / Math.log(g / f);
  return (db[next - 1] ?? 0) + part * ((db[next] ?? 0) - (db[next - 1] ?? 0));
}

/** Bars that are drawn to new decibels. */
function drawn(bench: Bench, spec: Spec, handles: readonly Handle[], all: readonly Drawn[]): Spec {
  const gains = new Map(all.map(({ handle, db }) => [handle, db - (handles[handle]?.db ?? db)]));
  return raised(bench, spec, (knot) => gains.get(knot) ?? 0);
}

export const bandsShaper: Shaper = {
  handles(bench, spec): Handle[] {
    const point = spec.points[bench.shown];
    if (!point) return [];
    const hz = knots(bench.author, bench, point.parameters);
    const db = pointDecibels(bench.from, spec.model, { ...point, ...motionOf(point) }, hz);
    return hz.map((f, i) => ({ name: `Band ${i + 1}`, hz: f, db: db[i] ?? 0, moves: "level" }));
  },

  move(bench, spec, handle, _, db) {
    return drawn(bench, spec, this.handles(bench, spec), [{ handle, db }]);
  },

  draw(bench, spec, all) {
    return drawn(bench, spec, this.handles(bench, spec), all);
  },

  macros(bench, spec, macros: Macros) {
    const point = spec.points[bench.shown];
    if (!point) return spec;
    const hz = knots(bench.author, bench, point.parameters);
    const db = pointDecibels(bench.from, spec.model, point, hz);
    const ratio = macroRatio(macros);
    return raised(bench, spec, (knot, f) => macroGain(macros, f) + between(hz, db, f / ratio) - (db[knot] ?? 0));
  },
};
