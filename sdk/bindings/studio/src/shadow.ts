// A voice on the main thread that makes no sound: it tells what plays at the finger's motion, and whether that was recorded.

import { batch, computed, effect, signal } from "@preact/signals";
import type { Texture, Voice } from "htex";

import { isBlind } from "./comparing.ts";
import { near } from "./conditions.ts";
import { coverageText } from "./coverage-text.ts";
import { tried } from "./engine.ts";
import { finger, isPiloted, pilotForce, pilotSpeed, sliders } from "./motion.ts";
import { present, texture } from "./state.ts";

/** The texture that sounds, and its model; null during a blind test, which must not show it. */
export const sounding = computed<{ texture: Texture; model: string } | null>(() => {
  if (isBlind.value) return null;
  const [tries, now, document] = [tried.value, texture.value, present.value];
  if (tries) return { texture: tries.texture, model: tries.model };
  if (!now || !document) return null;
  return { texture: now, model: now.models.includes(document.model) ? document.model : now.models[0] ?? "" };
});

/** Index of the condition that the pad shows. */
export const pictured = computed(() => sounding.value && near(sounding.value.texture, sounding.value.model, sliders.value).place);

const voice = signal<Voice | null>(null);

effect(() => {
  const now = sounding.value;
  const before = voice.peek();
  before?.free();
  voice.value = now ? now.texture.voice({ model: now.model }) : null;
});

/** The motion that is shown: the finger's, or the one that the sliders are set to while it rests. */
export const motion = computed(() => {
  const { speed, force, position } = finger.value;
  if (force > 0) return { speed, force, position };
  return { speed: pilotSpeed.value, force: pilotForce.value, position };
});

/** Milliseconds between two readings that are shown: as often as numbers can be read. */
const SHOWN_MS = 120;

/** The finger and the motion as they are shown in numbers and words. */
export const shownFinger = signal(finger.peek());
export const shownMotion = signal(motion.peek());
/**
 * The motion that is compared with the recorded range. For the autopilot it is the motion of the
 * sliders, because where the autopilot turns, it is slower than any recording.
 */
const judgedMotion = signal(motion.peek());
let timer = 0;

effect(() => {
  void [finger.value, motion.value];
  timer ||= window.setTimeout(() => {
    timer = 0;
    batch(() => {
      shownFinger.value = finger.peek();
      shownMotion.value = motion.peek();
      judgedMotion.value = isPiloted() ? { ...motion.peek(), ...sliders.peek() } : motion.peek();
    });
  }, SHOWN_MS);
});

export interface Coverage {
  readonly inside: boolean;
  readonly text: string;
}

/** Whether the motion is within the recorded conditions, and how it is played if not. */
export const coverage = computed<Coverage>(() => {
  if (isBlind.value) return { inside: true, text: "Blind test: the page does not show what plays." };
  const { speed, force, position } = judgedMotion.value;
  const told = voice.value?.coverage({ speed, force, position });
  return told ? { inside: told.kind !== "outside", text: coverageText(told) } : { inside: true, text: "" };
});

/** Magnitudes that play at the motion, in the texture's unit. */
export function played(frequencies: Float64Array): Float64Array | null {
  const now = voice.value;
  if (!now) return null;
  const { speed, force, position } = motion.value;
  now.setMotion(speed, force, position);
  return now.spectrum(frequencies);
}
