// The shapers of sSlope, sBeta and sPeak. Frequencies and decibels are those that the model itself answers with.

import { bandsShaper, BANDS } from "./bands.ts";
import { macroGain, macroRatio, solve, type Bench, type Handle, type Shaper } from "./shaper.ts";
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

const slopeShaper: Shaper = {
  handles(bench, spec): Handle[] {
    const peak = scalar(spec.points[bench.shown]?.parameters ?? {}, "peak_hz");
    const places = [peak, Math.max(peak / ARM, 21), Math.min(peak * ARM, 990)];
    const db = at(bench, spec, places);
    const names = ["Peak", "Slope below", "Slope above"];
    return places.map((hz, i) => ({ name: names[i] ?? "", hz, db: db[i] ?? 0, moves: i === 0 ? "both" : "level" }));
  },

  move(bench, spec, handle, hz, db) {
    const [peak, low, high] = this.handles(bench, spec);
    if (!peak || !low || !high) return spec;
    if (handle > 0) {
      const grip = handle === 1 ? low : high;
      return byDifference(bench, spec, handle === 1 ? "order_high_pass" : "order_low_pass", ORDERS, grip.hz, peak.hz, Math.min(db - peak.db, -0.5));
    }
    const place = clamp(hz, ...PEAK_HZ);
    const before = decibels(bench.author, bench, spec, [peak.hz]).map(([now]) => (now ?? 0) + db - peak.db);
    const moved = change(spec, (parameters) => ({ peak_hz: clamp((scalar(parameters, "peak_hz") * place) / peak.hz, ...PEAK_HZ) }));
    return anchored(bench.author, bench, moved, place, before);
  },

  macros(_, spec, macros) {
    return change(spec, (parameters) => ({
      peak_hz: clamp(scalar(parameters, "peak_hz") * macroRatio(macros), ...PEAK_HZ),
      order_high_pass: clamp(scalar(parameters, "order_high_pass") * 2 ** -macros.rougher, ...ORDERS),
      order_low_pass: clamp(scalar(parameters, "order_low_pass") * 2 ** -macros.brighter, ...ORDERS),
    }));
  },
};

const betaShaper: Shaper = {
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

  macros(_, spec, macros) {
    return change(spec, (parameters) => ({
      alpha: clamp(scalar(parameters, "alpha") * 2 ** (macros.peak - macros.rougher), ...SHAPES),
      beta: clamp(scalar(parameters, "beta") * 2 ** (-macros.peak - macros.brighter), ...SHAPES),
    }));
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
  const others = hz.map((_, i) => i).filter((i) => i !== changed);
  const anchor = others.reduce((best, i) => ((db[i] ?? -999) > (db[best] ?? -999) ? i : best), others[0] ?? -1);
  const after = change(spec, (parameters) => {
    const [frequencies, amplitudes] = of(list(parameters, "frequency_hz"), list(parameters, "amplitude"));
    return { frequency_hz: frequencies, amplitude: amplitudes.map((a) => clamp(a, ...AMPLITUDES)) };
  });
  if (anchor < 0) {
    return { ...after, points: after.points.map((point) => ({ ...point, level: point.level * fromDecibels(gainDb) })) };
  }
  const place = hz[anchor] ?? 100;
  return anchored(bench.author, bench, after, place, decibels(bench.author, bench, spec, [place]).map(([now]) => now ?? 0));
}

const peakShaper: Shaper = {
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

  macros(_, spec, macros) {
    const ratio = macroRatio(macros);
    return change(spec, (parameters) => {
      const hz = list(parameters, "frequency_hz");
      return {
        frequency_hz: hz.map((f) => clamp(f * ratio, ...PEAK_HZ)),
        amplitude: list(parameters, "amplitude").map((a, i) => clamp(a * fromDecibels(macroGain(macros, hz[i] ?? 100)), ...AMPLITUDES)),
      };
    });
  },
};

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
