// A small spectrum: dB over the logarithm of frequency, 20 to 1000 Hz.

import { computed } from "@preact/signals";
import { useMemo } from "preact/hooks";
import type { Texture } from "htex";

import { near, type Slid } from "../conditions.ts";
import { sliders } from "../motion.ts";

const POINTS = 72;
/** Frequencies that are looked at for each point, so that no line of a spectrum is missed. */
const FINE = 8;
const HZ = Float64Array.from({ length: POINTS * FINE }, (_, i) => 20 * 50 ** (i / (POINTS * FINE - 1)));
/** Range that is drawn below the largest value, dB. */
const RANGE_DB = 45;
const [WIDTH, HEIGHT] = [160, 44];

/** The outline of a spectrum as a path, closed at the bottom. */
export function outline(texture: Texture, model: string, at: Slid): string {
  const fine = texture.spectrum(HZ, { model, at });
  const decibels = Array.from({ length: POINTS }, (_, i) => 20 * Math.log10(Math.max(1e-12, ...fine.subarray(i * FINE, (i + 1) * FINE))));
  const top = Math.max(...decibels);
  const points = decibels.map((db, i) => {
    const part = Math.min(Math.max((top - db) / RANGE_DB, 0), 1);
    return `${((i / (POINTS - 1)) * WIDTH).toFixed(1)} ${(3 + part * (HEIGHT - 4)).toFixed(1)}`;
  });
  return `M0 ${HEIGHT}L${points.join("L")}L${WIDTH} ${HEIGHT}Z`;
}

/** The place of a spectrum that is not yet there. */
export function NoSparkline() {
  return <svg class="sparkline" aria-hidden="true" />;
}

export function Sparkline({ texture, model }: { texture: Texture; model: string }) {
  // Drawn anew only when the sliders choose another condition.
  const place = useMemo(() => computed(() => near(texture, model, sliders.value).place), [texture, model]).value;
  const path = useMemo(() => outline(texture, model, near(texture, model, sliders.peek()).at), [texture, model, place]);
  return <Outline path={path} />;
}

/** An outline whose texture need not be open any more. */
export function Outline({ path }: { path: string }) {
  return (
    <svg class="sparkline" viewBox={`0 0 ${WIDTH} ${HEIGHT}`} preserveAspectRatio="none" aria-hidden="true">
      <path d={path} />
    </svg>
  );
}
