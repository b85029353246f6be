// A picture of a texture's grain: waves as strong as the spectrum states, drawn as a relief in
// light from the upper left. Wavelengths are spread so that they can be seen. It is a picture, not
// a map.

/** Side of the tile, pixels. */
export const TILE = 256;
const WAVES = 84;
const [LOW_HZ, HIGH_HZ] = [20, 1000];
/** Wavelengths of the lowest frequency, pixels, and how much faster they fall than they rise in frequency. */
const LONGEST = 72;
const SPREAD = 0.8;

/** Frequencies at which a texture's spectrum is wanted for its relief. */
export const RELIEF_HZ = Float64Array.from({ length: WAVES }, (_, i) => LOW_HZ * (HIGH_HZ / LOW_HZ) ** ((i + 0.5) / WAVES));

/** Numbers from 0 to 1. They are the same each time, so that a surface always looks the same. */
function numbers(seed: number) {
  let state = seed;
  return () => {
    state = (Math.imul(state, 1664525) + 1013904223) >>> 0;
    return state / 2 ** 32;
  };
}

/** Waves that are added before others may have their turn. */
const WAVES_AT_ONCE = 4;

function* heights(magnitude: ArrayLike<number>): Generator<void, Float32Array> {
  const height = new Float32Array(TILE * TILE);
  const next = numbers(11);
  const row = new Float32Array(4 * TILE);
  for (let wave = 0; wave < WAVES; wave++) {
    if (wave % WAVES_AT_ONCE === WAVES_AT_ONCE - 1) yield;
    const length = LONGEST * ((RELIEF_HZ[wave] ?? LOW_HZ) / LOW_HZ) ** -SPREAD;
    const [angle, phase] = [Math.PI * (0.06 + 0.42 * (next() - 0.5) + (wave % 3 === 0 ? 0.5 : 0)), 2 * Math.PI * next()];
    const kx = Math.round((TILE / length) * Math.cos(angle));
    const ky = Math.round((TILE / length) * Math.sin(angle));
    const amplitude = (magnitude[wave] ?? 0) * Math.sqrt(length);
    for (let i = 0; i < TILE; i++) {
      const [ax, ay] = [(2 * Math.PI * kx * i) / TILE + phase, (2 * Math.PI * ky * i) / TILE];
      row[i] = Math.cos(ax);
      row[TILE + i] = Math.sin(ax);
      row[2 * TILE + i] = amplitude * Math.cos(ay);
      row[3 * TILE + i] = amplitude * Math.sin(ay);
    }
    for (let y = 0, at = 0; y < TILE; y++) {
      const [c, s] = [row[2 * TILE + y] as number, row[3 * TILE + y] as number];
      for (let x = 0; x < TILE; x++, at++) height[at] = (height[at] as number) + c * (row[x] as number) - s * (row[TILE + x] as number);
    }
  }
  return height;
}

/** The slope with the darkest or lightest colour, and the number of colours. */
const [STEEPEST, SHADES] = [4, 1024];

/** The colours of slopes from `-STEEPEST` to `STEEPEST`, as an image has them in memory. */
function shades(dark: Colour, light: Colour): Uint32Array {
  const bytes = new Uint8ClampedArray(4 * SHADES);
  for (let i = 0; i < SHADES; i++) {
    const part = 0.5 + 0.5 * Math.tanh(STEEPEST * ((2 * i) / (SHADES - 1) - 1));
    for (let c = 0; c < 3; c++) bytes[4 * i + c] = (dark[c] as number) + part * ((light[c] as number) - (dark[c] as number));
    bytes[4 * i + 3] = 255;
  }
  return new Uint32Array(bytes.buffer);
}

/** Draws the relief to a tile that repeats, in pieces of half a millisecond. `dark` and `light` are the colours of slopes away from the light and towards it. */
export function* relief(magnitude: ArrayLike<number>, dark: Colour, light: Colour): Generator<void, HTMLCanvasElement> {
  const height = yield* heights(magnitude);
  yield;
  const slope = new Float32Array(height.length);
  let square = 0;
  for (let y = 0, at = 0; y < TILE; y++) {
    const above = ((y + TILE - 1) % TILE) * TILE;
    let left = height[at + TILE - 1] as number;
    for (let x = 0; x < TILE; x++, at++) {
      const here = height[at] as number;
      const now = 1.2 * (here - left) + 0.8 * (here - (height[above + x] as number));
      slope[at] = now;
      square += now * now;
      left = here;
    }
  }
  yield;
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = TILE;
  const pen = canvas.getContext("2d");
  if (!pen) return canvas;
  const image = pen.createImageData(TILE, TILE);
  const pixels = new Uint32Array(image.data.buffer);
  const shade = shades(dark, light);
  const scale = (((0.85 / (Math.sqrt(square / slope.length) || 1)) / STEEPEST) * (SHADES - 1)) / 2;
  for (let at = 0; at < slope.length; at++) {
    const place = scale * (slope[at] as number) + SHADES / 2;
    pixels[at] = shade[Math.min(Math.max(place, 0), SHADES - 1) | 0] as number;
  }
  pen.putImageData(image, 0, 0);
  return canvas;
}

export type Colour = readonly [number, number, number];

const HEX = /^#(..)(..)(..)$/;

let resolver: OffscreenCanvasRenderingContext2D | null = null;

/** A colour that only the browser can resolve, e.g. `Highlight`. */
function resolved(text: string): Colour {
  resolver ??= new OffscreenCanvas(1, 1).getContext("2d", { willReadFrequently: true });
  if (!resolver) return [128, 128, 128];
  resolver.fillStyle = text;
  resolver.fillRect(0, 0, 1, 1);
  const [red = 128, green = 128, blue = 128] = resolver.getImageData(0, 0, 1, 1).data;
  return [red, green, blue];
}

/** A colour of the style sheet, such as `--grain-dark`, as red, green and blue. */
export function colour(name: string): Colour {
  const text = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const hex = HEX.exec(text);
  if (!hex) return resolved(text);
  return [1, 2, 3].map((i) => Number.parseInt(hex[i] as string, 16)) as unknown as Colour;
}
