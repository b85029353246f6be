// How loud a texture plays.

import type { Texture } from "htex";

import { near } from "./conditions.ts";
import { sliders } from "./motion.ts";

/** RMS of full scale at which a texture plays. */
export const LOUDNESS = 0.1;

/** The gain at which a texture has the usual loudness at the condition nearest to the sliders. */
export function usualGain(of: Texture, model: string) {
  const { level } = near(of, model, sliders.peek());
  return level > 0 ? LOUDNESS / level : 0;
}
