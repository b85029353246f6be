// Light or dark, as the system is set.

import { signal } from "@preact/signals";

const dark = matchMedia("(prefers-color-scheme: dark)");
export const scheme = signal(dark.matches ? "dark" : "light");
dark.addEventListener("change", () => (scheme.value = dark.matches ? "dark" : "light"));

export const isCalm = matchMedia("(prefers-reduced-motion: reduce)");
