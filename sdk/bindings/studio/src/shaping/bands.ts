// Bands: a bar for each knot.

import type { Author } from "htex";

import { isFree, isLimited, MACRO_DB, macroGain, macroRatio, NO_LIMITS, type Bench, type Drawn, type Handle, type Macros, type Shaper } from "./shaper.ts";
import { clamp, decibels, fromDecibels, list, make, pointDecibels, scalar, type Frame, type Parameters, type Spec } from "./spec.ts";

export const BANDS = "org.htex.bands";
/** Most steps below the highest knot. */
const MOST_STEPS = 255;
/** What another model is redrawn with: as many knots as are fitted by default. */
const REDRAWN = { knots: 30, step_db: 1, layout: 1 };
const SEARCHED = Float64Array.from({ length: 600 }, (_, i) => 20 * 50 ** (i / 599));
/** Decibels by which the other knots are lowered in a probe. */
const PROBE_DB = 20;
/** Distance of the bins over which a level is the RMS, Hz. */
const BIN_HZ = 5;

/** Where a model's knots are, and what each adds to the curve. */
interface Axis {
  /** Frequencies of the knots, Hz. */
  readonly hz: readonly number[];
  /** For each bin of the band the part of each knot's decibels in the curve's: the curve is piecewise linear. */
  readonly parts: readonly (readonly (readonly [knot: number, part: number])[])[];
}

/** Frequencies as near to one as its neighbours in the search, a hundred times as dense. */
const around = (hz: number) => Float64Array.from({ length: 201 }, (_, i) => Math.min(Math.max(hz * 50 ** ((i - 100) / 100 / 599), 20), 1000));

/** The frequency at which a curve is highest. */
const highest = (hz: ArrayLike<number>, curve: readonly number[]) => hz[curve.slice(0, hz.length).reduce((best, db, i) => (db > (curve[best] ?? -Infinity) ? i : best), 0)] ?? 20;

const axes = new Map<string, Axis>();

/** The axis of bands: a knot is where its own change is greatest. The model is asked, which alone knows it. */
function axisOf(author: Author, frame: Frame, parameters: Parameters): Axis {
  const count = list(parameters, "below_highest").length;
  const [low = 20, high = 1000] = frame.from.band;
  const key = `${count} ${scalar(parameters, "layout")} ${low} ${high}`;
  const cached = axes.get(key);
  if (cached) return cached;
  const bins = Array.from({ length: Math.floor((high - low) / BIN_HZ) + 1 }, (_, i) => low + BIN_HZ * i);
  const asked = Float64Array.from([...SEARCHED, ...bins]);
  const hz: number[] = [];
  const parts: [number, number][][] = bins.map(() => []);
  for (let knot = 0; knot < count; knot++) {
    const below = Array.from({ length: count }, (_, i) => (i === knot ? 0 : PROBE_DB));
    const point = { speed: null, force: null, level: 1, parameters: { ...parameters, below_highest: below, step_db: 1 } };
    const probe = make(author, frame, { model: BANDS, points: [point] });
    const curve = pointDecibels(probe, BANDS, point, asked);
    const near = around(highest(SEARCHED, curve));
    hz.push(highest(near, pointDecibels(probe, BANDS, point, near)));
    probe.free();
    const inBins = curve.slice(SEARCHED.length);
    const least = Math.min(...inBins);
    inBins.forEach((db, bin) => db - least > 1e-9 && parts[bin]?.push([knot, (db - least) / PROBE_DB]));
  }
  const axis = { hz, parts };
  axes.set(key, axis);
  return axis;
}

export const knots = (author: Author, frame: Frame, parameters: Parameters) => axisOf(author, frame, parameters).hz;

/** Decibels of the RMS over the bins of a curve with given decibels at its knots, up to a constant. */
function levelDb({ parts }: Axis, knotDb: readonly number[]) {
  const power = parts.reduce((sum, bin) => sum + 10 ** (bin.reduce((db, [knot, part]) => db + part * (knotDb[knot] ?? 0), 0) / 10), 0);
  return 10 * Math.log10(power);
}

/** Decibels of the knots below the highest, as they are stored. */
const stored = (parameters: Parameters) => list(parameters, "below_highest").map((steps) => -scalar(parameters, "step_db") * steps);

/** Steps with the highest knot at 0, whole and in range. */
function normalised(below: readonly number[]): number[] {
  const highest = Math.min(...below);
  return below.map((steps) => clamp(Math.round(steps - highest), 0, MOST_STEPS));
}

/** Raises each knot of each point by decibels, and leaves the rest of the curve where it was. */
function raised(bench: Bench, spec: Spec, gain: (knot: number, hz: number) => number): Spec {
  const shown = spec.points[bench.shown]?.parameters ?? {};
  const axis = axisOf(bench.author, bench, shown);
  const gains = axis.hz.map((f, knot) => gain(knot, f));
  // The highest of the knots that moved least is what the curve is held by.
  const least = Math.min(...gains.map(Math.abs));
  const shownDb = stored(shown);
  const candidates = gains.map((_, knot) => knot).filter((knot) => Math.abs(gains[knot] ?? 0) <= least + 1e-9);
  const anchor = candidates.reduce((best, knot) => ((shownDb[knot] ?? -999) > (shownDb[best] ?? -999) ? knot : best), candidates[0] ?? 0);
  const points = spec.points.map((point) => {
    const step = scalar(point.parameters, "step_db");
    const moved = gains.map((db) => Math.round(db / step));
    const steps = list(point.parameters, "below_highest");
    const parameters = { ...point.parameters, below_highest: normalised(steps.map((own, knot) => own - (moved[knot] ?? 0))) };
    const [before, after] = [stored(point.parameters), stored(parameters)];
    const held = (before[anchor] ?? 0) + step * (moved[anchor] ?? 0) - (after[anchor] ?? 0);
    return { ...point, parameters, level: point.level * fromDecibels(held + levelDb(axis, after) - levelDb(axis, before)) };
  });
  return { ...spec, points };
}

/**
 * The curves of all points. Silent points are raised first, because their shapes count between
 * conditions.
 */
function shapesOf(bench: Bench, spec: Spec, hz: readonly number[]) {
  const strongest = Math.max(...spec.points.map(({ level }) => level));
  if (spec.points.every(({ level }) => level > 0)) return spec.points.map((point) => pointDecibels(bench.from, spec.model, point, hz));
  return decibels(bench.author, bench, { ...spec, points: spec.points.map((point) => ({ ...point, level: point.level || strongest })) }, hz);
}

/** Another model's curve as Bands. */
export function redrawn(bench: Bench, spec: Spec): Spec {
  const frame = { below_highest: new Array<number>(REDRAWN.knots).fill(0), step_db: REDRAWN.step_db, layout: REDRAWN.layout };
  const hz = knots(bench.author, bench, frame);
  const curves = shapesOf(bench, spec, hz);
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
  isLocal: true,

  handles(bench, spec): Handle[] {
    const point = spec.points[bench.shown];
    if (!point) return [];
    const hz = knots(bench.author, bench, point.parameters);
    const db = pointDecibels(bench.from, spec.model, point, hz);
    const stepDb = scalar(point.parameters, "step_db");
    return hz.map((f, i) => ({ name: `Band ${i + 1}`, hz: f, db: db[i] ?? 0, moves: "level", stepDb }));
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
    const { limits = NO_LIMITS } = bench;
    const levelDb = isLimited(bench) ? MACRO_DB * macros.level : 0;
    const gain = (knot: number, f: number) => macroGain(macros, f) + levelDb + between(hz, db, f / ratio) - (db[knot] ?? 0);
    return raised(bench, spec, (knot, f) => (isFree(limits, knot, f) ? gain(knot, f) : 0));
  },
};
