// How a surface looks: its colour, gloss, relief and pattern. A texture's file may state it, in an
// extension that no player needs. `spec/htex-1.md` describes the extension.

import type { Texture } from "htex";

export const EXTENSION = "org.htex.appearance/1";

/** Even grain, parallel ridges, long fibres, woven threads, rounded bumps. */
export const PATTERNS = ["grain", "ridges", "fibres", "weave", "bumps"] as const;
export type Pattern = (typeof PATTERNS)[number];

/** An appearance, with the same keys as in the file. */
export interface Appearance {
  /** Hue, saturation and lightness of the colour, as in CSS's `hsl()`: degrees, and parts of 1. */
  readonly hue_deg: number;
  readonly saturation: number;
  readonly lightness: number;
  /** 0 is matt, 1 is like a mirror. */
  readonly gloss: number;
  /** 0 is flat, 1 is deep. */
  readonly relief: number;
  readonly pattern: Pattern;
}

/** Largest values. The smallest ones are 0. */
export const MOST = { hue_deg: 360, saturation: 1, lightness: 1, gloss: 1, relief: 1 } as const;
export type Part = keyof typeof MOST;

/** The appearance in a manifest's extension; null if there is none, or if it breaks the schema. */
export function stated({ extensions }: Texture["manifest"]): Appearance | null {
  const given = extensions?.[EXTENSION];
  if (typeof given !== "object" || given === null) return null;
  const entries = new Map<string, unknown>(Object.entries(given));
  const isPart = (name: string) => {
    const value = entries.get(name);
    return typeof value === "number" && value >= 0 && value <= MOST[name as Part];
  };
  const isWhole = Object.keys(MOST).every(isPart) && PATTERNS.some((pattern) => pattern === entries.get("pattern"));
  return isWhole && entries.size === Object.keys(MOST).length + 1 ? (given as Appearance) : null;
}

/** What a texture made of another one says of its appearance: the same, if it says something. */
export function keptAppearance(manifest: Texture["manifest"]): { extensions?: Record<string, unknown> } {
  const own = stated(manifest);
  return own ? { extensions: { [EXTENSION]: own } } : {};
}

/** Red, green and blue, 0 to 1. */
export type Rgb = readonly [number, number, number];

export function rgbOf({ hue_deg: hue, saturation, lightness }: Pick<Appearance, "hue_deg" | "saturation" | "lightness">): Rgb {
  const reach = saturation * Math.min(lightness, 1 - lightness);
  const channel = (at: number) => {
    const k = (at + hue / 30) % 12;
    return lightness - reach * Math.max(-1, Math.min(k - 3, 9 - k, 1));
  };
  return [channel(0), channel(8), channel(4)];
}

export function hslOf([r, g, b]: Rgb): Pick<Appearance, "hue_deg" | "saturation" | "lightness"> {
  const [most, least] = [Math.max(r, g, b), Math.min(r, g, b)];
  const [range, lightness] = [most - least, (most + least) / 2];
  if (range < 1e-9) return { hue_deg: 0, saturation: 0, lightness };
  const sixth = most === r ? (g - b) / range : most === g ? 2 + (b - r) / range : 4 + (r - g) / range;
  return { hue_deg: (60 * sixth + 360) % 360, saturation: range / (1 - Math.abs(2 * lightness - 1)), lightness };
}

const rounded = (value: number, digits: number) => Number(value.toFixed(digits));

/** As it is stored: whole degrees and hundredths. */
export function tidy({ pattern, ...parts }: Appearance): Appearance {
  const within = (name: Part) => Math.min(Math.max(rounded(parts[name], name === "hue_deg" ? 0 : 2), 0), MOST[name]);
  return { hue_deg: within("hue_deg"), saturation: within("saturation"), lightness: within("lightness"), gloss: within("gloss"), relief: within("relief"), pattern };
}

/** Looks in given parts, which add up to 1. The pattern is that of the largest part. */
export function mixed(looks: readonly Appearance[], parts: readonly number[]): Appearance {
  const sum = (of: (look: Appearance) => number) => looks.reduce((all, look, i) => all + (parts[i] ?? 0) * of(look), 0);
  const channel = (i: 0 | 1 | 2) => sum((look) => rgbOf(look)[i]);
  const largest = parts.indexOf(Math.max(...parts));
  return tidy({
    ...hslOf([channel(0), channel(1), channel(2)]),
    gloss: sum(({ gloss }) => gloss),
    relief: sum(({ relief }) => relief),
    pattern: looks[largest]?.pattern ?? "grain",
  });
}
