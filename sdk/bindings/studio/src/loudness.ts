// How loud a texture plays.

import type { Texture } from "htex";

/** RMS of full scale at which a texture plays. */
const LOUDNESS = 0.1;

/** The gain at which a texture has the usual loudness. */
export function usualGain(of: Texture, model: string) {
  const level = of.level({ model });
  return level > 0 ? LOUDNESS / level : 0;
}
