// The axes of the spectrum: logarithm of frequency, and decibels.

export const [LOW_HZ, HIGH_HZ] = [20, 1000];
export const TICKS_HZ = [20, 50, 100, 200, 500, 1000];

export interface Scale {
  readonly left: number;
  readonly top: number;
  readonly width: number;
  readonly height: number;
  /** Decibels at the lower and at the upper edge. */
  readonly floor: number;
  readonly ceiling: number;
}

export const toX = (scale: Scale, hz: number) => scale.left + (scale.width * Math.log(hz / LOW_HZ)) / Math.log(HIGH_HZ / LOW_HZ);
export const toY = (scale: Scale, db: number) => scale.top + (scale.height * (scale.ceiling - db)) / (scale.ceiling - scale.floor);
export const toHz = (scale: Scale, x: number) => LOW_HZ * (HIGH_HZ / LOW_HZ) ** Math.min(Math.max((x - scale.left) / scale.width, 0), 1);
export const toDb = (scale: Scale, y: number) => scale.ceiling - Math.min(Math.max((y - scale.top) / scale.height, 0), 1) * (scale.ceiling - scale.floor);

/** Whether a place is below the curves, on the axis of frequencies. */
export const isOnAxis = (scale: Scale, [, y]: readonly [number, number]) => y > scale.top + scale.height;

/** Where a handle is painted. A handle beyond the axes is painted at their edge. */
export const placeOf = (scale: Scale, { hz, db }: { readonly hz: number; readonly db: number }): [number, number] => [
  toX(scale, Math.min(Math.max(hz, LOW_HZ), HIGH_HZ)),
  toY(scale, Math.min(Math.max(db, scale.floor), scale.ceiling)),
];

/**
 * The range of decibels that is shown: it covers the curves, in steps of 10 dB, and is at least 50
 * dB.
 */
export function rangeOf(curves: readonly (readonly number[])[]): { floor: number; ceiling: number } {
  const all = curves.flat().filter(Number.isFinite);
  const highest = all.length > 0 ? Math.max(...all) : 0;
  const ceiling = 10 * Math.ceil((highest + 6) / 10);
  const lowest = Math.min(...all.filter((db) => db > highest - 60), highest);
  return { floor: Math.min(10 * Math.floor((lowest - 4) / 10), ceiling - 50), ceiling };
}
