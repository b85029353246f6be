// Light on a relief: diffuse and specular, from a lamp above the picture. The slopes of a tile that
// repeats are lit from one direction. The lamp's spot is laid over the tiles.

import { rgbOf, type Appearance } from "./appearance.ts";
import type { Surface } from "./surface.ts";

/** Where the lamp is over the picture: 0 to 1 to the right and down. */
export interface Lamp {
  readonly x: number;
  readonly y: number;
}

/** Near the upper left corner, where people expect light to come from. */
export const USUAL_LAMP: Lamp = { x: 0.06, y: 0.08 };

/** How far the edges of a picture are from its middle, in heights of the lamp. */
const REACH = 1.1;

/** The part of the colour that a surface has in the shade. */
const AMBIENT = 0.4;
/** RMS of the slopes of the deepest relief, and of one that is called flat. */
const [DEEPEST, FLATTEST] = [0.85, 0.04];
/** How much darker grooves are than peaks, for the deepest relief. */
const GROOVES = 0.13;

/** Exponent and strength of the highlight. */
const highlight = (gloss: number) => ({ exponent: 5 * 2 ** (5.5 * gloss), strength: 0.95 * gloss * gloss });

const STEPS = 1024;
/** Powers of the numbers from 0 to 1. */
const powers = (exponent: number, factor: number) => Float32Array.from({ length: STEPS + 1 }, (_, i) => factor * (i / STEPS) ** exponent);

/** Lights a relief. Returns the pixels as an image has them in memory. */
export function lit({ width, height, z, slopeX, slopeY }: Surface, appearance: Appearance, lamp: Lamp): Uint8ClampedArray<ArrayBuffer> {
  const { gloss, relief } = appearance;
  const [x, y] = [2 * REACH * (lamp.x - 0.5), 2 * REACH * (lamp.y - 0.5)];
  const far = Math.hypot(x, y, 1);
  const [lx, ly, lz] = [x / far, y / far, 1 / far];
  // The viewer is above the surface: the highlight is where a slope lies between the lamp and the viewer.
  const half = Math.hypot(lx, ly, lz + 1);
  const [hx, hy, hz] = [lx / half, ly / half, (lz + 1) / half];
  const depth = FLATTEST + (DEEPEST - FLATTEST) * relief;
  const { exponent, strength } = highlight(gloss);
  const shine = powers(exponent, 255 * strength);
  const base = rgbOf(appearance).map((channel) => 255 * channel);
  const [r, g, b] = base as unknown as readonly [number, number, number];
  // A glossy surface also mirrors what is around it, which is brighter on the side of the lamp.
  const mirror = 0.5 * gloss * gloss;
  const diffuse = (1 - AMBIENT) / lz;
  const data = new Uint8ClampedArray(new ArrayBuffer(4 * width * height));
  for (let at = 0, to = 0; at < z.length; at++, to += 4) {
    const [nx, ny] = [-depth * (slopeX[at] as number), -depth * (slopeY[at] as number)];
    const shorter = 1 / Math.sqrt(1 + nx * nx + ny * ny);
    const towards = (nx * lx + ny * ly + lz) * shorter;
    const between = (nx * hx + ny * hy + hz) * shorter;
    const side = (nx * lx + ny * ly) * shorter;
    const shade = (1 + GROOVES * relief * Math.max(Math.min(z[at] as number, 2), -2)) * (AMBIENT + diffuse * Math.max(towards, 0)) + mirror * 2 * side;
    const white = shine[(STEPS * Math.max(between, 0)) | 0] as number;
    data[to] = r * shade + white;
    data[to + 1] = g * shade + white;
    data[to + 2] = b * shade + white;
    data[to + 3] = 255;
  }
  return data;
}

/** Side of the picture of the spot, which is stretched. */
export const SPOT = 48;
/** Darkness far from the lamp. */
const DARKEST = 0.42;

/** The spot of the lamp over a picture of given proportions: bright near the lamp, and dark far from it. */
export function spot(appearance: Appearance, lamp: Lamp, proportion: number): Uint8ClampedArray<ArrayBuffer> {
  const { gloss } = appearance;
  const size = 0.75 - 0.4 * gloss;
  const [r, g, b] = rgbOf(appearance);
  // Bright metal tints its highlight a little.
  const tint = ([r, g, b] as const).map((channel) => 255 * (0.7 + 0.3 * channel));
  const data = new Uint8ClampedArray(new ArrayBuffer(4 * SPOT * SPOT));
  const [wide, high] = proportion > 1 ? [1, 1 / proportion] : [proportion, 1];
  for (let y = 0, to = 0; y < SPOT; y++) {
    for (let x = 0; x < SPOT; x++, to += 4) {
      const far = Math.hypot(wide * ((x + 0.5) / SPOT - lamp.x), high * ((y + 0.5) / SPOT - lamp.y));
      const dark = DARKEST * (1 - 1 / (1 + (1.1 * far) ** 2));
      const bright = (0.06 + 0.6 * gloss ** 1.5) * Math.exp(-((far / size) ** 2));
      // First the darkness, and the brightness over it.
      const whole = 1 - (1 - dark) * (1 - bright);
      for (let c = 0; c < 3; c++) data[to + c] = (bright * (tint[c] as number)) / whole;
      data[to + 3] = 255 * whole;
    }
  }
  return data;
}
