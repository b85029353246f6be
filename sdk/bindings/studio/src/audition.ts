// Trying textures: one sounds while the pointer or the focus is on it.

import { sound, tried, type Sounding } from "./engine.ts";
import { finger, pilot, setPilot } from "./motion.ts";

let lent = false;
let ending = 0;

/** Milliseconds for which a tapped texture sounds. A finger does not leave it as a mouse does. */
const TAPPED_MS = 2500;

/** What is looked at; a texture that has yet to be opened may come when something else is. */
let look: object | null = null;
/** What sounds because it is looked at. */
let auditioned: Sounding | null = null;

/**
 * Plays a texture while the user browses it. If the finger rests, an autopilot slides it back and
 * forth.
 */
export function audition(sounding: Sounding) {
  auditioned = sounding;
  tried.value = sounding;
  lend();
}

/** What is looked at is on the pad now: it sounds as the present texture, for as long as it is looked at. */
export function auditionPresent() {
  if (!look) return;
  // A texture that is still being opened comes too late.
  look = {};
  if (tried.peek() === auditioned) tried.value = null;
  lend();
}

/** Lets the autopilot slide if nothing else does and sound is on. */
function lend() {
  if (sound.peek() !== "on" || pilot.peek() !== "hand") return;
  lent = true;
  setPilot("to-and-fro");
}

/** Plays the present texture while the user changes it. If the finger rests, an autopilot slides it until a moment after the last call. */
export function hearChange() {
  tried.value = null;
  if (finger.peek().force === 0) lend();
  if (lent) endSoon();
}

/** Plays the present texture again. What sounds for another reason, such as a side on Compare, goes on. */
export function endAudition() {
  look = null;
  clearTimeout(ending);
  if (tried.peek() === auditioned) tried.value = null;
  if (!lent) return;
  lent = false;
  setPilot("hand");
}

/** Lets the finger rest again if an autopilot slides it for a change. */
export function endChange() {
  if (lent) endAudition();
}

/** Ends a tapped texture after a moment. Pressing something else ends it earlier. */
function endSoon() {
  clearTimeout(ending);
  ending = window.setTimeout(endAudition, TAPPED_MS);
}

/**
 * Handlers of an element that plays a texture while it is looked at. `restsMs`: how long it has to
 * be looked at first, where pointers pass on their way to something else.
 */
export function onLook(sounding: () => Promise<Sounding | null> | Sounding | null, restsMs = 0) {
  const begin = async () => {
    const own = (look = {});
    if (restsMs > 0) await new Promise((resolve) => setTimeout(resolve, restsMs));
    if (look !== own) return;
    const now = await sounding();
    if (now && look === own) audition(now);
  };
  return {
    onPointerEnter: (event: PointerEvent) => event.pointerType === "mouse" && void begin(),
    onPointerLeave: (event: PointerEvent) => event.pointerType === "mouse" && endAudition(),
    onPointerUp: (event: PointerEvent) => event.pointerType !== "mouse" && endSoon(),
    onFocus: () => void begin(),
    onBlur: endAudition,
  };
}
