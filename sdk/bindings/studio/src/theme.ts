// Settings of the system: light, dark or forced colours, less motion, and touch or mouse.

import { signal } from "@preact/signals";

const dark = matchMedia("(prefers-color-scheme: dark)");
const forced = matchMedia("(forced-colors: active)");
const named = () => `${dark.matches ? "dark" : "light"}${forced.matches ? " forced" : ""}`;

/** Changes whenever colours change, so that canvases are painted again. */
export const scheme = signal(named());
for (const media of [dark, forced]) media.addEventListener("change", () => (scheme.value = named()));

export const isCalm = matchMedia("(prefers-reduced-motion: reduce)");

const touch = matchMedia("(hover: none) and (pointer: coarse)");

/** Whether the page is used by touch. Its texts then do not mention hovering, dropping or keys. */
export const isTouch = signal(touch.matches);
touch.addEventListener("change", () => (isTouch.value = touch.matches));

const narrow = matchMedia("(max-width: 599px)");

/** Whether the window is as narrow as a phone held upright. */
export const isNarrow = signal(narrow.matches);
narrow.addEventListener("change", () => (isNarrow.value = narrow.matches));

/** Red, green and blue, 0 to 255. */
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

/** Colours of the style sheet. They are asked for in each frame. */
const colours = new Map<string, Colour>();
scheme.subscribe(() => colours.clear());

/** A colour of the style sheet, such as `--accent`. */
export function colour(name: string): Colour {
  const known = colours.get(name);
  if (known) return known;
  const text = getComputedStyle(document.documentElement).getPropertyValue(name).trim();
  const hex = HEX.exec(text);
  const found = hex ? ([1, 2, 3].map((i) => Number.parseInt(hex[i] as string, 16)) as unknown as Colour) : resolved(text);
  colours.set(name, found);
  return found;
}
