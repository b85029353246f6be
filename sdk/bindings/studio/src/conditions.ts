// The recorded condition that the page shows, and from which it sets the loudness: the condition
// nearest to the sliders.

import type { Texture } from "htex";

/** Speed, mm/s, and force, N. */
export interface Slid {
  readonly speed: number;
  readonly force: number;
}

/** A recorded condition. A number that is not known is NaN or null. */
interface Recorded {
  readonly speed: number | null;
  readonly force: number | null;
}

/** Lowest speed of a finger that slides, mm/s, and lowest force of a finger on a surface, N. */
const [LEAST_MM_S, LEAST_N] = [0.5, 1e-6];
/** The speed and the force that the command assumes if a texture does not state them. */
export const USUAL: Slid = { speed: 80, force: 0.4 };

const isKnown = (x: number | null): x is number => x !== null && !Number.isNaN(x);

/**
 * Distance of a recorded number from the wanted one, as the logarithm of their ratio. An unknown
 * number fits every other. A finger that does not slide is farther away than any other.
 */
function far(recorded: number | null, least: number, wanted: number) {
  if (!isKnown(recorded)) return 0;
  return recorded < least ? Infinity : Math.abs(Math.log(wanted / recorded));
}

/** Index of the condition nearest to a motion; null if the finger slides at none of them. */
export function nearest(conditions: readonly Recorded[], { speed, force }: Slid): number | null {
  const all = conditions.map((one) => far(one.speed, LEAST_MM_S, speed) + far(one.force, LEAST_N, force));
  const least = Math.min(...all);
  return least < Infinity ? all.indexOf(least) : null;
}

/**
 * The condition of a model that is nearest to a motion: its index in the model's list, its level,
 * and a motion at which the texture plays it. If the nearest condition is silent, returns the
 * condition at which the command plays by default.
 */
export function near(texture: Texture, model: string, wanted: Slid): { place: number; level: number; at: Slid } {
  const { manifest, conditions } = texture;
  const at = manifest.representations.find((one) => one.model === model)?.at ?? [];
  const unknown = { speed: null, force: null };
  const own = at.map(({ condition }) => conditions[condition] ?? unknown);
  const found = nearest(own, wanted);
  const isSilent = found === null || !((at[found]?.level_rms ?? 0) > 0);
  const usual = isSilent ? texture.defaultCondition(model) : 0;
  const place = isSilent ? Math.max(at.findIndex(({ condition }) => condition === usual), 0) : found;
  return { place, level: at[place]?.level_rms ?? 0, at: sliding(own[place] ?? unknown) };
}

/** The recorded range of a model: lowest and highest speed and force; null where nothing is known. */
export function recordedRange({ manifest, conditions }: Texture, model: string) {
  const at = manifest.representations.find((one) => one.model === model)?.at ?? [];
  const recorded = (condition: number) => (manifest.conditions[condition]?.segments === 0 ? undefined : conditions[condition]);
  const range = (name: "speed" | "force", least: number): readonly [number, number] | null => {
    const known = at.map(({ condition }) => recorded(condition)?.[name] ?? NaN).filter((x) => x >= least);
    return known.length > 0 ? [Math.min(...known), Math.max(...known)] : null;
  };
  return { speed: range("speed", LEAST_MM_S), force: range("force", LEAST_N) };
}

/** A motion at which a condition plays. It slides a little at least: nothing plays at rest. */
export function sliding({ speed, force }: Recorded): Slid {
  return { speed: Math.max(isKnown(speed) ? speed : USUAL.speed, LEAST_MM_S), force: Math.max(isKnown(force) ? force : USUAL.force, LEAST_N) };
}
