// The shapers of sSlope, sBeta and sPeak. Frequencies and decibels are those that the model itself answers with.

import { bandsShaper, BANDS } from "./bands.ts";
import { isFree, isLimited, MACRO_DB, macroGain, macroRatio, NO_LIMITS, solve, type Bench, type Handle, type Macros, type Shaper } from "./shaper.ts";
import { anchored, change, clamp, decibels, fromDecibels, list, scalar, type Spec } from "./spec.ts";

/** How far the grips of sSlope are from its peak, as a ratio. */
const ARM = 2;
const ORDERS = [0.1, 12] as const;
/** Where the two grips of sBeta are, Hz, and the range of its parameters that a grip reaches. */
const GRIPS_HZ = [45, 480] as const;
const SHAPES = [0.55, 60] as const;
const PEAK_HZ = [20, 1000] as const;

function at(bench: Bench, spec: Spec, hz: readonly number[]) {
  return decibels(bench.author, bench, spec, hz)[bench.shown] ?? [];
}

/** Changes a parameter of all points by the ratio that brings the shown point's difference between two frequencies to a value. */
function byDifference(bench: Bench, spec: Spec, name: string, [low, high]: readonly [number, number], hz: number, from: number, wanted: number): Spec {
  const now = scalar(spec.points[bench.shown]?.parameters ?? {}, name);
  const scaled = (value: number) => change(spec, (parameters) => ({ [name]: clamp((scalar(parameters, name) * value) / now, low, high) }));
  const difference = (value: number) => {
    const [a = 0, b = 0] = at(bench, scaled(value), [hz, from]);
    return a - b;
  };
  const before = decibels(bench.author, bench, spec, [from]).map(([db]) => db ?? 0);
  return anchored(bench.author, bench, scaled(solve(difference, wanted, low, high)), from, before);
}

/** The parameter of each grip of sSlope. */
const SLOPES = [[1, "order_high_pass"], [2, "order_low_pass"]] as const;

const lockedIn = ({ limits = NO_LIMITS }: Bench) => limits.locked;

/**
 * Gives the locked slopes of a changed curve the steepness that they had, because each slope also
 * changes the other one a little. Then the first locked handle has its decibels again.
 */
function withLockedSlopes(bench: Bench, all: readonly Handle[], before: Spec, changed: Spec): Spec {
  const locked = lockedIn(bench);
  const [peak] = all;
  const held = all.find((_, i) => locked.has(i));
  if (!peak || !held) return changed;
  let after = changed;
  for (const [i, name] of SLOPES) {
    const grip = all[i];
    if (grip && locked.has(i)) after = byDifference(bench, after, name, ORDERS, grip.hz, peak.hz, grip.db - peak.db);
  }
  return anchored(bench.author, bench, after, held.hz, decibels(bench.author, bench, before, [held.hz]).map(([now]) => now ?? 0));
}

const slopeShaper: Shaper = {
  isLocal: false,

  handles(bench, spec): Handle[] {
    const peak = scalar(spec.points[bench.shown]?.parameters ?? {}, "peak_hz");
    const places = [peak, Math.max(peak / ARM, 21), Math.min(peak * ARM, 990)];
    const db = at(bench, spec, places);
    const names = ["Peak", "Slope below", "Slope above"];
    return places.map((hz, i) => ({ name: names[i] ?? "", hz, db: db[i] ?? 0, moves: i === 0 ? "both" : "level" }));
  },

  move(bench, spec, handle, hz, db) {
    const all = this.handles(bench, spec);
    const [peak, low, high] = all;
    if (!peak || !low || !high) return spec;
    if (handle > 0) {
      const grip = handle === 1 ? low : high;
      const moved = byDifference(bench, spec, handle === 1 ? "order_high_pass" : "order_low_pass", ORDERS, grip.hz, peak.hz, Math.min(db - peak.db, -0.5));
      return withLockedSlopes(bench, all, spec, moved);
    }
    // The slopes are beside the peak and move with it.
    if (lockedIn(bench).size > 0) return spec;
    const place = clamp(hz, ...PEAK_HZ);
    const before = decibels(bench.author, bench, spec, [peak.hz]).map(([now]) => (now ?? 0) + db - peak.db);
    const moved = change(spec, (parameters) => ({ peak_hz: clamp((scalar(parameters, "peak_hz") * place) / peak.hz, ...PEAK_HZ) }));
    return anchored(bench.author, bench, moved, place, before);
  },

  turns(macro, locked) {
    if (macro === "peak" || macro === "level") return locked.size === 0;
    return !locked.has(macro === "rougher" ? 1 : 2);
  },

  macros(bench, spec, wanted) {
    const macros = possible(this, bench, wanted);
    const changed = change(spec, (parameters) => ({
      peak_hz: clamp(scalar(parameters, "peak_hz") * macroRatio(macros), ...PEAK_HZ),
      order_high_pass: clamp(scalar(parameters, "order_high_pass") * 2 ** -macros.rougher, ...ORDERS),
      order_low_pass: clamp(scalar(parameters, "order_low_pass") * 2 ** -macros.brighter, ...ORDERS),
    }));
    return withLockedSlopes(bench, this.handles(bench, spec), spec, changed);
  },
};

/** The macros that may change something; the others are 0. */
function possible(shaper: Shaper, bench: Bench, macros: Macros): Macros {
  const value = (macro: keyof Macros) => (shaper.turns?.(macro, lockedIn(bench)) === false ? 0 : macros[macro]);
  return { rougher: value("rougher"), brighter: value("brighter"), peak: value("peak"), level: value("level") };
}

const betaShaper: Shaper = {
  isLocal: false,

  handles(bench, spec): Handle[] {
    const db = at(bench, spec, GRIPS_HZ);
    return GRIPS_HZ.map((hz, i) => ({ name: i === 0 ? "Rise" : "Fall", hz, db: db[i] ?? 0, moves: "level" }));
  },

  move(bench, spec, handle, _, db) {
    const grips = this.handles(bench, spec);
    const [grip, other] = [grips[handle], grips[1 - handle]];
    if (!grip || !other) return spec;
    return byDifference(bench, spec, handle === 0 ? "alpha" : "beta", SHAPES, grip.hz, other.hz, db - other.db);
  },

  turns(macro, locked) {
    if (macro === "peak" || macro === "level") return locked.size === 0;
    return !locked.has(macro === "rougher" ? 0 : 1);
  },

  macros(bench, spec, wanted) {
    const macros = possible(this, bench, wanted);
    const changed = change(spec, (parameters) => ({
      alpha: clamp(scalar(parameters, "alpha") * 2 ** (macros.peak - macros.rougher), ...SHAPES),
      beta: clamp(scalar(parameters, "beta") * 2 ** (-macros.peak - macros.brighter), ...SHAPES),
    }));
    const [locked] = lockedIn(bench);
    const grip = locked === undefined ? undefined : GRIPS_HZ[locked];
    if (grip === undefined) return changed;
    return anchored(bench.author, bench, changed, grip, decibels(bench.author, bench, spec, [grip]).map(([now]) => now ?? 0));
  },
};

/** Most lines of sPeak, and the lowest amplitude. */
const MOST_LINES = 64;
const AMPLITUDES = [1e-6, 4] as const;

/**
 * Changes the lines, and keeps the curve at a line that did not move. If there is only one line,
 * the level grows with it.
 */
function withLines(bench: Bench, spec: Spec, changed: number, of: (hz: readonly number[], amplitude: readonly number[]) => [number[], number[]], gainDb: number): Spec {
  const hz = list(spec.points[bench.shown]?.parameters ?? {}, "frequency_hz");
  const db = at(bench, spec, hz);
  const anchor = strongest(db, (i) => i !== changed);
  const after = change(spec, (parameters) => {
    const [frequencies, amplitudes] = of(list(parameters, "frequency_hz"), list(parameters, "amplitude"));
    return { frequency_hz: frequencies, amplitude: amplitudes.map((a) => clamp(a, ...AMPLITUDES)) };
  });
  if (anchor < 0) return scaled(after, gainDb);
  const place = hz[anchor] ?? 100;
  return anchored(bench.author, bench, after, place, decibels(bench.author, bench, spec, [place]).map(([now]) => now ?? 0));
}

const peakShaper: Shaper = {
  isLocal: true,

  handles(bench, spec): Handle[] {
    const hz = list(spec.points[bench.shown]?.parameters ?? {}, "frequency_hz");
    const db = at(bench, spec, hz);
    return hz.map((f, i) => ({ name: `Peak ${i + 1}`, hz: f, db: db[i] ?? 0, moves: "both" }));
  },

  move(bench, spec, handle, hz, db) {
    const now = this.handles(bench, spec)[handle];
    if (!now) return spec;
    const gain = db - now.db;
    const moved = (frequencies: readonly number[], amplitudes: readonly number[]): [number[], number[]] => [
      frequencies.map((f, i) => (i === handle ? clamp((f * hz) / now.hz, ...PEAK_HZ) : f)),
      amplitudes.map((a, i) => (i === handle ? a * fromDecibels(gain) : a)),
    ];
    return withLines(bench, spec, handle, moved, gain);
  },

  add(bench, spec, hz, db) {
    const count = list(spec.points[bench.shown]?.parameters ?? {}, "frequency_hz").length;
    if (count >= MOST_LINES) return spec;
    const loudest = Math.max(...this.handles(bench, spec).map((handle) => handle.db));
    const amplitude = (all: readonly number[]) => Math.max(...all, 1e-3) * fromDecibels(Math.min(db - loudest, 12));
    return withLines(bench, spec, count, (f, a) => [[...f, hz], [...a, amplitude(a)]], 0);
  },

  remove(bench, spec, handle) {
    if (this.handles(bench, spec).length < 2) return spec;
    const without = (all: readonly number[]) => all.filter((_, i) => i !== handle);
    return withLines(bench, spec, handle, (f, a) => [without(f), without(a)], 0);
  },

  macros(bench, spec, macros) {
    const { limits = NO_LIMITS } = bench;
    const [ratio, among] = [macroRatio(macros), limits.range ?? PEAK_HZ];
    const lines = list(spec.points[bench.shown]?.parameters ?? {}, "frequency_hz");
    const free = lines.map((hz, i) => isFree(limits, i, hz));
    const fixed = strongest(at(bench, spec, lines), (i) => !free[i]);
    // Only ratios of amplitudes count: if all lines may change, the level itself is changed below.
    const levelDb = fixed < 0 ? 0 : MACRO_DB * macros.level;
    const changed = change(spec, (parameters) => {
      const hz = list(parameters, "frequency_hz");
      return {
        frequency_hz: hz.map((f, i) => (free[i] ? clamp(f * ratio, ...among) : f)),
        amplitude: list(parameters, "amplitude").map((a, i) => (free[i] ? clamp(a * fromDecibels(macroGain(macros, hz[i] ?? 100) + levelDb), ...AMPLITUDES) : a)),
      };
    });
    if (!isLimited(bench)) return changed;
    if (fixed < 0) return scaled(changed, MACRO_DB * macros.level);
    const place = lines[fixed] ?? 100;
    return anchored(bench.author, bench, changed, place, decibels(bench.author, bench, spec, [place]).map(([now]) => now ?? 0));
  },
};

/** Index of the strongest of some lines; -1 if there is none. */
const strongest = (db: readonly number[], isOne: (index: number) => boolean) => db.reduce((best, now, i) => (isOne(i) && now > (db[best] ?? -Infinity) ? i : best), -1);

/** A specification whose level is changed by decibels. */
const scaled = (spec: Spec, db: number): Spec => ({ ...spec, points: spec.points.map((point) => ({ ...point, level: point.level * fromDecibels(db) })) });

const SHAPERS: Record<string, Shaper> = {
  [BANDS]: bandsShaper,
  "org.htex.sslope": slopeShaper,
  "org.htex.sbeta": betaShaper,
  "org.htex.speak": peakShaper,
};

/** The shaper of a model; none for models whose numbers cannot be drawn. */
export function shaperOf(model: string): Shaper | undefined {
  return SHAPERS[model];
}
