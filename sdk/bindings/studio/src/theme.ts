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
