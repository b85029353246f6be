// The spectrum of a texture at one motion, as it is pictured: its outline over the logarithm of
// frequency, 20 to 1000 Hz.

import type { Texture } from "htex";

import type { Slid } from "../conditions.ts";

const POINTS = 72;
/** Frequencies that are looked at for each point of the outline, so that no line of a spectrum is missed. */
const FINE = 8;
const COUNT = POINTS * FINE;
const [LOW_HZ, HIGH_HZ] = [20, 1000];

export const FINE_HZ = Float64Array.from({ length: COUNT }, (_, i) => LOW_HZ * (HIGH_HZ / LOW_HZ) ** (i / (COUNT - 1)));

/** The place of a frequency among `FINE_HZ`, which need not be whole. */
export const fineIndex = (hz: number) => ((COUNT - 1) * Math.log(hz / LOW_HZ)) / Math.log(HIGH_HZ / LOW_HZ);

/** A texture never changes, and a card and a picture ask for the same spectrum. */
const known = new WeakMap<Texture, Map<string, Float64Array>>();

/** Magnitudes at `FINE_HZ`, in the texture's unit. */
export function fineSpectrum(texture: Texture, model: string, at: Slid): Float64Array {
  const own = known.get(texture) ?? new Map<string, Float64Array>();
  known.set(texture, own);
  const key = `${model} ${at.speed} ${at.force}`;
  const magnitudes = own.get(key) ?? texture.spectrum(FINE_HZ, { model, at });
  own.set(key, magnitudes);
  return magnitudes;
}

/** Range that is drawn below the largest value, dB. */
const RANGE_DB = 45;
export const [LINE_WIDTH, LINE_HEIGHT] = [72, 24];

/** The outline of a spectrum, as the path of an SVG. */
export function outline(magnitudes: Float64Array): string {
  const decibels = Array.from({ length: POINTS }, (_, i) => 20 * Math.log10(Math.max(1e-12, ...magnitudes.subarray(i * FINE, (i + 1) * FINE))));
  const top = Math.max(...decibels);
  const points = decibels.map((db, i) => {
    const part = Math.min(Math.max((top - db) / RANGE_DB, 0), 1);
    return `${((i / (POINTS - 1)) * LINE_WIDTH).toFixed(1)} ${(1 + part * (LINE_HEIGHT - 2)).toFixed(1)}`;
  });
  return `M${points.join("L")}`;
}

/** Distance of the line from the corner of a pad, and its margin, in CSS pixels. */
const [INSET, MARGIN] = [10, 5];

/** Paints an outline into the lower right corner of a pad. A CSS pixel is `scale` pixels. */
export function paintLine(pen: CanvasRenderingContext2D, line: Path2D, scale: number, ground: string, ink: string) {
  const { width, height } = pen.canvas;
  pen.save();
  pen.scale(scale, scale);
  pen.translate(width / scale - LINE_WIDTH - 2 * MARGIN - INSET, height / scale - LINE_HEIGHT - 2 * MARGIN - INSET);
  pen.fillStyle = ground;
  pen.beginPath();
  pen.roundRect(0, 0, LINE_WIDTH + 2 * MARGIN, LINE_HEIGHT + 2 * MARGIN, 7);
  pen.fill();
  pen.translate(MARGIN, MARGIN);
  pen.lineWidth = 1.5;
  pen.lineJoin = "round";
  pen.strokeStyle = ink;
  pen.stroke(line);
  pen.restore();
}
