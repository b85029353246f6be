// Trying textures: one sounds while the pointer or the focus is on it.

import { sound, tried, type Sounding } from "./engine.ts";
import { pilot, setPilot } from "./motion.ts";

let lent = false;

/**
 * Plays a texture while the user browses it. If the finger rests, an autopilot slides it back and
 * forth.
 */
export function audition(sounding: Sounding) {
  tried.value = sounding;
  if (sound.peek() === "on" && pilot.peek() === "hand") {
    lent = true;
    setPilot("to-and-fro");
  }
}

/** Plays the present texture again. */
export function endAudition() {
  tried.value = null;
  if (!lent) return;
  lent = false;
  setPilot("hand");
}

/** Handlers of an element that plays a texture while it is looked at. */
export function onLook(sounding: () => Sounding | null) {
  const begin = () => {
    const now = sounding();
    if (now) audition(now);
  };
  return {
    onPointerEnter: (event: PointerEvent) => event.pointerType === "mouse" && begin(),
    onPointerLeave: (event: PointerEvent) => event.pointerType === "mouse" && endAudition(),
    onFocus: begin,
    onBlur: endAudition,
  };
}
