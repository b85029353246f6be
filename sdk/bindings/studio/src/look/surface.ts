// The relief of a texture: noise, shaped by the texture's spectrum and by its pattern. It repeats
// beyond its edges. Wavelengths are spread so that they can be seen. It is a picture, not a map.

import type { Pattern } from "./appearance.ts";
import { FINE_HZ, fineIndex } from "./spectrum-line.ts";

/** Heights and slopes of a relief, row by row. The slopes have an RMS of 1, and so have the heights. */
export interface Surface {
  readonly width: number;
  readonly height: number;
  readonly z: Float32Array;
  readonly slopeX: Float32Array;
  readonly slopeY: Float32Array;
}

/** Wavelength of the lowest frequency, pixels, and how much faster wavelengths fall than frequencies rise. */
const LONGEST = 56;
const SPREAD = 0.74;
const LOW_HZ = FINE_HZ[0] ?? 20;

const wavelength = (hz: number) => LONGEST * (hz / LOW_HZ) ** -SPREAD;

/** Numbers from 0 to 1 (Mulberry32). They are the same each time, so that a surface always looks the same. */
function numbers(seed: number) {
  let state = seed;
  return () => {
    state = (state + 0x6d2b79f5) | 0;
    let mixed = Math.imul(state ^ (state >>> 15), state | 1);
    mixed ^= mixed + Math.imul(mixed ^ (mixed >>> 7), mixed | 61);
    return ((mixed ^ (mixed >>> 14)) >>> 0) / 2 ** 32;
  };
}

/** Waves of a picture: their turns, and their places in a spectrum. The same kinds of pictures are drawn again and again. */
interface Waves {
  readonly cos: Float32Array;
  readonly sin: Float32Array;
  /** Index of the magnitude of each wave among `FINE_HZ`; `NONE` outside of the spectrum. */
  readonly places: Uint16Array;
}

const NONE = FINE_HZ.length;
const known = new Map<string, Waves>();

function* wavesOf([width, height]: Size, [longX, longY]: Stretch): Generator<void, Waves> {
  const key = `${width} ${height} ${longX} ${longY}`;
  const own = known.get(key);
  if (own) return own;
  const next = numbers(11 + 2 * longX + 3 * longY);
  const count = width * height;
  const made = { cos: new Float32Array(count), sin: new Float32Array(count), places: new Uint16Array(count) };
  const [first, perOctave] = [fineIndex(LOW_HZ * LONGEST ** (1 / SPREAD)), (fineIndex(2 * LOW_HZ) - fineIndex(LOW_HZ)) / (2 * SPREAD)];
  for (let y = 0, at = 0; y < height; y++) {
    const ky = ((y <= height / 2 ? y : y - height) * longY) / height;
    for (let x = 0; x < width; x++, at++) {
      const kx = ((x <= width / 2 ? x : x - width) * longX) / width;
      const place = Math.round(first + perOctave * Math.log2(kx * kx + ky * ky));
      const turn = 2 * Math.PI * next();
      made.places[at] = place >= 0 && place < NONE ? place : NONE;
      made.cos[at] = Math.cos(turn);
      made.sin[at] = Math.sin(turn);
    }
    if (y % LINES_AT_ONCE === LINES_AT_ONCE - 1) yield;
  }
  known.set(key, made);
  return made;
}

/** A Fourier transform of a number of values that is a power of two, in place. */
class Transform {
  private readonly cos: Float64Array;
  private readonly sin: Float64Array;
  private readonly order: Uint16Array;
  private readonly re: Float64Array;
  private readonly im: Float64Array;

  constructor(private readonly size: number) {
    this.cos = Float64Array.from({ length: size / 2 }, (_, i) => Math.cos((2 * Math.PI * i) / size));
    this.sin = Float64Array.from({ length: size / 2 }, (_, i) => Math.sin((2 * Math.PI * i) / size));
    this.order = new Uint16Array(size);
    for (let i = 1; i < size; i++) this.order[i] = ((this.order[i >> 1] as number) >> 1) | (i & 1 ? size >> 1 : 0);
    this.re = new Float64Array(size);
    this.im = new Float64Array(size);
  }

  /** Transforms the values at `from`, `from + step` and so on. Where all are 0, they stay. */
  run(allRe: Float32Array, allIm: Float32Array, from: number, step: number) {
    const { size, cos, sin, order, re, im } = this;
    let isZero = true;
    for (let i = 0; i < size; i++) {
      const at = from + step * (order[i] as number);
      const [x, y] = [allRe[at] as number, allIm[at] as number];
      re[i] = x;
      im[i] = y;
      if (x !== 0 || y !== 0) isZero = false;
    }
    if (isZero) return;
    for (let half = 1; half < size; half *= 2) {
      const turn = size / 2 / half;
      for (let start = 0; start < size; start += 2 * half) {
        for (let i = start, k = 0; i < start + half; i++, k += turn) {
          const [c, s] = [cos[k] as number, sin[k] as number];
          const [x, y] = [re[i + half] as number, im[i + half] as number];
          const [u, v] = [c * x - s * y, c * y + s * x];
          re[i + half] = (re[i] as number) - u;
          im[i + half] = (im[i] as number) - v;
          re[i] = (re[i] as number) + u;
          im[i] = (im[i] as number) + v;
        }
      }
    }
    for (let i = 0, at = from; i < size; i++, at += step) {
      allRe[at] = re[i] as number;
      allIm[at] = im[i] as number;
    }
  }
}

const transforms = new Map<number, Transform>();

function transformOf(size: number) {
  const own = transforms.get(size) ?? new Transform(size);
  transforms.set(size, own);
  return own;
}

/** Rows or columns that are worked on before others may have their turn. */
const LINES_AT_ONCE = 32;

/** Noise whose wavelengths along an axis are some times as long. Its slopes have the texture's spectrum. */
function* noise(magnitudes: Float64Array, size: Size, stretch: Stretch): Generator<void, Float32Array> {
  const { cos, sin, places } = yield* wavesOf(size, stretch);
  // The finger feels slopes, so a wave is as high as its slope times its length. A ring of the plane
  // has as many waves as its radius, which the second factor makes up for.
  const heights = new Float64Array(NONE + 1);
  magnitudes.forEach((magnitude, i) => (heights[i] = magnitude * Math.sqrt(FINE_HZ[i] as number) * wavelength(FINE_HZ[i] as number) ** 2));
  const [width, height] = size;
  const [re, im] = [new Float32Array(width * height), new Float32Array(width * height)];
  for (let at = 0; at < re.length; at++) {
    const wave = heights[places[at] as number] as number;
    re[at] = wave * (cos[at] as number);
    im[at] = wave * (sin[at] as number);
  }
  yield;
  const rows = function* () {
    for (let y = 0; y < height; y++) {
      transformOf(width).run(re, im, y * width, 1);
      if (y % LINES_AT_ONCE === LINES_AT_ONCE - 1) yield;
    }
  };
  const columns = function* () {
    for (let x = 0; x < width; x++) {
      transformOf(height).run(re, im, x, width);
      if (x % LINES_AT_ONCE === LINES_AT_ONCE - 1) yield;
    }
  };
  // Long waves fill few columns or rows. Those come first, and the others are skipped.
  const [longX, longY] = stretch;
  if (longX > longY) {
    yield* columns();
    yield* rows();
  } else {
    yield* rows();
    yield* columns();
  }
  return re;
}

/** How many times as long waves are along each axis. */
type Stretch = readonly [x: number, y: number];
type Size = readonly [width: number, height: number];

/** Makes a field's mean 0 and its RMS 1, in place. */
function even(field: Float32Array): Float32Array {
  let [sum, square] = [0, 0];
  for (let at = 0; at < field.length; at++) {
    const x = field[at] as number;
    sum += x;
    square += x * x;
  }
  const mean = sum / field.length;
  const scale = 1 / (Math.sqrt(square / field.length - mean * mean) || 1);
  for (let at = 0; at < field.length; at++) field[at] = scale * ((field[at] as number) - mean);
  return field;
}

/** The frequency around which a spectrum has its power, on a logarithmic scale. */
export function middleHz(magnitudes: Float64Array): number {
  let [sum, power] = [0, 0];
  magnitudes.forEach((magnitude, i) => {
    const own = magnitude * magnitude * (FINE_HZ[i] as number);
    sum += own * i;
    power += own;
  });
  return FINE_HZ[power > 0 ? Math.round(sum / power) : 0] ?? LOW_HZ;
}

/** Lines that are weaker than the strongest by more than this factor are not drawn. */
const FAINTEST_LINE = 0.03;

/** The highest points of a spectrum: frequencies and magnitudes. */
function lines(magnitudes: Float64Array) {
  const most = Math.max(...magnitudes);
  const isHighest = (magnitude: number, i: number) => magnitude > FAINTEST_LINE * most && magnitude >= (magnitudes[i - 1] ?? 0) && magnitude > (magnitudes[i + 1] ?? 0);
  return Array.from(magnitudes, (magnitude, i) => ({ magnitude, hz: FINE_HZ[i] as number, isLine: isHighest(magnitude, i) })).filter(({ isLine }) => isLine);
}

/** Straight ridges: a wave for each line of the spectrum, whose numbers are as their frequencies. */
function ridges(magnitudes: Float64Array, [width]: Size): Float32Array {
  const all = lines(magnitudes);
  const profile = new Float32Array(width);
  const [lowest] = all;
  if (!lowest) return profile;
  const first = Math.max(Math.round(width / wavelength(lowest.hz)), 1);
  for (const { hz, magnitude } of all) {
    const k = Math.round((first * hz) / lowest.hz);
    // Two pixels show no shorter wave.
    if (k > width / 3) continue;
    for (let x = 0; x < width; x++) profile[x] = (profile[x] as number) + (magnitude / k) * Math.cos((2 * Math.PI * k * x) / width);
  }
  return profile;
}

/** How long fibres are, and how even ridges are along themselves. */
const [FIBRE, RIDGE] = [12, 16];
/** Parts of the noise in the relief of ridges and of threads. */
const [RIDGE_NOISE, THREAD_NOISE] = [0.3, 0.2];
/** Smallest and largest distance of two threads, pixels. */
const [LEAST_THREAD, MOST_THREAD] = [4, 14];

/** Threads across and along, over and under each other in turn, as uneven as the noise. */
function weave(uneven: Float32Array, [width, height]: Size, thread: number) {
  const wave = (pixels: number) => {
    const count = 2 * Math.max(Math.round(pixels / (2 * thread)), 1);
    return Float32Array.from({ length: pixels }, (_, i) => Math.sin((Math.PI * count * (i + 0.5)) / pixels));
  };
  const [overX, overY] = [wave(width), wave(height)];
  for (let y = 0, at = 0; y < height; y++) {
    const v = overY[y] as number;
    for (let x = 0; x < width; x++, at++) {
      const u = overX[x] as number;
      const over = Math.min(Math.max(0.5 + 2 * u * v, 0), 1);
      uneven[at] = over * Math.abs(v) + (1 - over) * Math.abs(u) + THREAD_NOISE * (uneven[at] as number);
    }
  }
}

function* heights(magnitudes: Float64Array, pattern: Pattern, size: Size): Generator<void, Float32Array> {
  switch (pattern) {
    case "grain":
      return yield* noise(magnitudes, size, [1, 1]);
    case "fibres":
      return yield* noise(magnitudes, size, [FIBRE, 1]);
    case "bumps": {
      const field = even(yield* noise(magnitudes, size, [1, 1]));
      for (let at = 0; at < field.length; at++) field[at] = Math.sqrt((field[at] as number) ** 2 + 0.01);
      return field;
    }
    case "ridges": {
      const field = even(yield* noise(magnitudes, size, [1, RIDGE]));
      const profile = even(ridges(magnitudes, size));
      for (let at = 0; at < field.length; at++) field[at] = (profile[at % size[0]] as number) + RIDGE_NOISE * (field[at] as number);
      return field;
    }
    case "weave": {
      const field = even(yield* noise(magnitudes, size, [1, 1]));
      yield;
      weave(field, size, Math.min(Math.max(wavelength(middleHz(magnitudes)), LEAST_THREAD), MOST_THREAD));
      return field;
    }
  }
}

/** Makes the relief, in pieces of about half a millisecond. The sizes are powers of two. */
export function* surface(magnitudes: Float64Array, pattern: Pattern, size: Size): Generator<void, Surface> {
  const z = even(yield* heights(magnitudes, pattern, size));
  yield;
  const [width, height] = size;
  const [slopeX, slopeY] = [new Float32Array(z.length), new Float32Array(z.length)];
  let square = 0;
  for (let y = 0; y < height; y++) {
    const row = y * width;
    const [above, below] = [((y + height - 1) % height) * width, ((y + 1) % height) * width];
    let left = z[row + width - 1] as number;
    let here = z[row] as number;
    for (let x = 0; x < width; x++) {
      const right = z[x < width - 1 ? row + x + 1 : row] as number;
      const [dx, dy] = [right - left, (z[below + x] as number) - (z[above + x] as number)];
      slopeX[row + x] = dx;
      slopeY[row + x] = dy;
      square += dx * dx + dy * dy;
      left = here;
      here = right;
    }
  }
  const scale = 1 / (Math.sqrt(square / z.length) || 1);
  for (let at = 0; at < z.length; at++) {
    slopeX[at] = scale * (slopeX[at] as number);
    slopeY[at] = scale * (slopeY[at] as number);
  }
  return { width, height, z, slopeX, slopeY };
}
