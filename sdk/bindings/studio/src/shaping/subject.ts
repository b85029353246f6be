// What is shaped: a model of the present texture, its parameters, and the handles on its curve.

import { computed } from "@preact/signals";

import { author } from "../author.ts";
import { near } from "../conditions.ts";
import { sliders } from "../motion.ts";
import { present, texture } from "../state.ts";
import type { Handle } from "./shaper.ts";
import { shaperOf } from "./shapers.ts";
import { read, type Spec } from "./spec.ts";

/** The model that is shaped. */
export const model = computed(() => {
  const [now, document] = [texture.value, present.value];
  if (!now || !document) return null;
  return now.models.includes(document.model) ? document.model : now.models[0] ?? null;
});

export const spec = computed<Spec | null>(() => {
  const [now, name] = [texture.value, model.value];
  return now && name ? read(now, name) : null;
});

/** The point whose condition is nearest to what the sliders of the pad are set to; it stays while the finger moves. */
export const shown = computed(() => {
  const [now, name] = [texture.value, model.value];
  return now && name ? near(now, name, sliders.value).place : 0;
});

export const handles = computed<Handle[]>(() => {
  const [now, what, made] = [texture.value, spec.value, author.value];
  if (!now || !what || !made) return [];
  return shaperOf(what.model)?.handles({ author: made, from: now, of: what, shown: shown.value }, what) ?? [];
});
