// The appearance that is guessed for a texture that does not state one: of its tags, of its name,
// and where these say nothing, of its spectrum. Equal textures look the same everywhere.

import type { Texture } from "htex";

import { USUAL, near } from "../conditions.ts";
import { hslOf, rgbOf, stated, tidy, type Appearance, type Pattern, type Rgb } from "./appearance.ts";
import { FINE_HZ, fineIndex, fineSpectrum } from "./spectrum-line.ts";
import { middleHz } from "./surface.ts";

type Row = readonly [words: string, hue: number, saturation: number, lightness: number, gloss: number, relief: number, pattern: Pattern];

/** Materials by their words. The first row of which a word occurs counts, so the narrower ones come first. */
const MATERIALS: readonly Row[] = [
  ["corduroy", 28, 0.42, 0.38, 0.05, 0.7, "ridges"],
  ["denim jeans", 216, 0.4, 0.36, 0.05, 0.5, "weave"],
  ["velvet velour plush", 342, 0.5, 0.32, 0.16, 0.25, "grain"],
  ["felt", 152, 0.16, 0.42, 0.02, 0.3, "grain"],
  ["fur fleece wool towel carpet", 34, 0.26, 0.6, 0.02, 0.6, "grain"],
  ["silk satin", 330, 0.32, 0.64, 0.55, 0.15, "weave"],
  ["linen burlap jute hessian canvas", 42, 0.3, 0.62, 0.04, 0.6, "weave"],
  ["textile fabric cloth cotton knit nylon polyester", 228, 0.18, 0.54, 0.05, 0.5, "weave"],
  ["suede", 26, 0.36, 0.42, 0.04, 0.25, "grain"],
  ["leather leatherette", 22, 0.5, 0.32, 0.34, 0.5, "bumps"],
  ["skin", 18, 0.46, 0.7, 0.22, 0.3, "bumps"],
  ["cork", 30, 0.42, 0.52, 0.06, 0.5, "bumps"],
  ["bark", 24, 0.3, 0.3, 0.04, 1, "fibres"],
  ["wood wooden timber oak pine walnut beech birch maple bamboo plank plywood", 28, 0.48, 0.44, 0.22, 0.42, "fibres"],
  ["cardboard", 33, 0.38, 0.58, 0.05, 0.35, "grain"],
  ["sandpaper emery", 26, 0.4, 0.4, 0.14, 0.75, "grain"],
  ["paper", 44, 0.2, 0.86, 0.06, 0.2, "grain"],
  ["gold brass bronze", 42, 0.52, 0.54, 0.86, 0.25, "fibres"],
  ["copper", 18, 0.52, 0.52, 0.86, 0.25, "fibres"],
  ["metal steel iron aluminium aluminum zinc chrome tin", 212, 0.1, 0.6, 0.88, 0.3, "fibres"],
  ["glass", 186, 0.24, 0.72, 0.95, 0.12, "grain"],
  ["ceramic porcelain tile", 204, 0.1, 0.84, 0.8, 0.2, "grain"],
  ["brick terracotta", 12, 0.5, 0.44, 0.05, 0.65, "grain"],
  ["gravel pebble", 34, 0.08, 0.5, 0.14, 1, "bumps"],
  ["sand", 40, 0.46, 0.66, 0.06, 0.55, "grain"],
  ["marble", 210, 0.06, 0.86, 0.7, 0.12, "grain"],
  ["stone rock concrete slate granite plaster", 30, 0.05, 0.54, 0.14, 0.6, "grain"],
  ["rubber", 220, 0.06, 0.2, 0.24, 0.5, "bumps"],
  ["foam sponge", 50, 0.56, 0.7, 0.03, 0.7, "bumps"],
  ["plastic vinyl acrylic abs pvc", 204, 0.46, 0.5, 0.62, 0.25, "grain"],
];

/** Hue, saturation and lightness of words for colours. */
const COLOURS: Readonly<Record<string, readonly [number, number, number]>> = {
  red: [2, 0.62, 0.44],
  orange: [25, 0.8, 0.52],
  yellow: [48, 0.8, 0.58],
  green: [130, 0.38, 0.4],
  turquoise: [175, 0.5, 0.42],
  blue: [215, 0.55, 0.45],
  purple: [275, 0.4, 0.45],
  pink: [336, 0.6, 0.74],
  brown: [25, 0.45, 0.32],
  black: [220, 0.06, 0.14],
  white: [45, 0.12, 0.92],
  grey: [210, 0.04, 0.5],
  gray: [210, 0.04, 0.5],
};

type Change = (look: Appearance) => Partial<Appearance>;

/** What other words change. */
const CHANGES: readonly (readonly [words: string, change: Change])[] = [
  ["rough coarse", ({ relief }) => ({ relief: relief + 0.12 })],
  ["fine smooth", ({ relief }) => ({ relief: relief - 0.1 })],
  ["hard", ({ gloss }) => ({ gloss: gloss + 0.08 })],
  ["soft", ({ gloss }) => ({ gloss: 0.7 * gloss })],
  ["matt matte", ({ gloss }) => ({ gloss: Math.min(gloss, 0.05) })],
  ["glossy shiny polished wet", ({ gloss }) => ({ gloss: Math.max(gloss, 0.85) })],
  ["ridged ribbed grooved corrugated", () => ({ pattern: "ridges" })],
  ["woven", () => ({ pattern: "weave" })],
  ["brushed", () => ({ pattern: "fibres" })],
];

/** Colours between which an unknown material lies: dull and low is like clay, bright and high like slate. */
const [CLAY, SLATE]: readonly [Rgb, Rgb] = [rgbOf({ hue_deg: 24, saturation: 0.34, lightness: 0.42 }), rgbOf({ hue_deg: 206, saturation: 0.28, lightness: 0.62 })];

/** How far a line of a ridged spectrum reaches, in octaves or Hz, and how far it stands out, dB. */
const [LINE_OCTAVES, LINE_HZ, LINE_DB] = [1 / 6, 11, 12];

/** Whether the strongest part of a spectrum is a line. Parallel ridges have such a line. */
function isRidged(magnitudes: Float64Array) {
  const at = magnitudes.indexOf(Math.max(...magnitudes));
  const hz = FINE_HZ[at] ?? 0;
  const reach = Math.max(hz * (2 ** LINE_OCTAVES - 1), LINE_HZ);
  const falls = (to: number) => to > (FINE_HZ[0] ?? 0) && to < (FINE_HZ.at(-1) ?? 0) && (magnitudes[Math.round(fineIndex(to))] ?? 0) < (magnitudes[at] ?? 0) * 10 ** (-LINE_DB / 20);
  return falls(hz - reach) && falls(hz + reach);
}

/** A material of which nothing but the spectrum is known. */
function ofSpectrum(magnitudes: Float64Array): Appearance {
  const bright = Math.min(Math.max(fineIndex(middleHz(magnitudes)) / (FINE_HZ.length - 1), 0), 1);
  const channel = (i: 0 | 1 | 2) => CLAY[i] + bright * (SLATE[i] - CLAY[i]);
  return { ...hslOf([channel(0), channel(1), channel(2)]), gloss: 0.08 + 0.3 * bright, relief: 0.75 - 0.45 * bright, pattern: "grain" };
}

const wordsOf = (text: string) => new Set(text.toLowerCase().split(/[^\p{L}]+/u).flatMap((word) => [word, word.replace(/s$/, "")]));

/** Whether one of some words occurs. */
const has = (words: ReadonlySet<string>, some: string) => some.split(" ").some((word) => words.has(word));

function materialIn(words: ReadonlySet<string>): Appearance | undefined {
  const row = MATERIALS.find(([some]) => has(words, some));
  if (!row) return undefined;
  const [, hue_deg, saturation, lightness, gloss, relief, pattern] = row;
  return { hue_deg, saturation, lightness, gloss, relief, pattern };
}

function coloured(look: Appearance, words: ReadonlySet<string>): Appearance {
  const colour = Object.entries(COLOURS).find(([word]) => words.has(word))?.[1];
  return colour ? { ...look, hue_deg: colour[0], saturation: colour[1], lightness: colour[2] } : look;
}

function guess(texture: Texture): Appearance {
  const { manifest, name } = texture;
  const model = texture.models[0] ?? "";
  const magnitudes = fineSpectrum(texture, model, near(texture, model, USUAL).at);
  const tags = wordsOf((manifest.tags ?? []).join(" "));
  const material = materialIn(tags) ?? materialIn(wordsOf(name));
  const look = coloured(material ?? ofSpectrum(magnitudes), tags);
  const changed = CHANGES.reduce((now, [words, change]) => (has(tags, words) ? { ...now, ...change(now) } : now), look);
  const isWoven = changed.pattern === "weave";
  return tidy(isRidged(magnitudes) && !isWoven ? { ...changed, pattern: "ridges" } : changed);
}

/** A texture never changes, and its appearance is asked for often. */
const known = new WeakMap<Texture, Appearance>();

/** The appearance of a texture: the one that its file states, or a guess. */
export function appearanceOf(texture: Texture): Appearance {
  const own = known.get(texture) ?? stated(texture.manifest) ?? guess(texture);
  known.set(texture, own);
  return own;
}
