// A finger that nobody moves: it shows how to slide over the pad. It makes no sound.

import { signal } from "@preact/signals";

import type { Finger } from "./motion.ts";
import { isCalm } from "./theme.ts";

export const ghost = signal<Finger | null>(null);

/** Seconds for which it slides, and seconds of one round. */
const [SLIDES_S, ROUND_S] = [14, 3.5];
/** Half of its way, as parts of the pad, and what its ring shows. */
const [ACROSS, DOWN, SPEED, FORCE] = [0.3, 0.14, 90, 0.4];

/** Slides for a while. Ends earlier when `isOver`, which is asked at each frame, returns true. */
export function slideGhost(isOver: () => boolean) {
  if (isCalm.matches) return;
  const began = performance.now();
  const step = () => {
    const seconds = (performance.now() - began) / 1e3;
    if (isOver() || seconds > SLIDES_S) return void (ghost.value = null);
    const turn = (2 * Math.PI * seconds) / ROUND_S;
    const [x, y] = [0.5 + ACROSS * Math.sin(turn), 0.5 + DOWN * Math.sin(2 * turn)];
    ghost.value = { x, y, speed: SPEED * Math.abs(Math.cos(turn)), force: FORCE, position: 0 };
    requestAnimationFrame(step);
  };
  requestAnimationFrame(step);
}
