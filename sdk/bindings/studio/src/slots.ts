// The two versions of the work, A and B. Each has its own history; what is changed, is changed in the version on the pad.

import { computed } from "@preact/signals";

import { endAudition } from "./audition.ts";
import { isBlind } from "./comparing.ts";
import { tried } from "./engine.ts";
import { copied, otherThan, swapped, type Slot } from "./history.ts";
import { go, say, work } from "./state.ts";
import { isTouch } from "./theme.ts";

export const nameOf = (slot: Slot) => slot.toUpperCase();

/** The version that is on the pad, and the other one. */
export const slot = computed(() => work.value.slot);
export const other = computed(() => otherThan(slot.value));
/** The texture of the other version; null if that was never used. */
export const resting = computed(() => work.value[other.value].present);

/** Puts a version on the pad, or the other one. A version that was never used begins as a copy. */
export async function swap(to?: Slot) {
  if (isBlind.peek()) return;
  const from = await go((now) => swapped(now, to ?? otherThan(now.slot)));
  if (!from) return;
  // What is tried would go on in the place of the version.
  endAudition();
  tried.value = null;
  const name = nameOf(slot.peek());
  const isNew = from[slot.peek()].present === null;
  if (isNew) say(`${name} is now a copy of ${nameOf(from.slot)}. Your changes go to ${name}. ${isTouch.peek() ? `Tap ${nameOf(from.slot)}` : "Press X"} to switch back.`);
  else say(`Version ${name} is on the pad.`);
}

/** Copies the version on the pad to the other one. */
export function copyToOther() {
  if (isBlind.peek()) return;
  work.value = copied(work.peek());
  const name = nameOf(other.peek());
  say(`${name} is now a copy of ${nameOf(slot.peek())}. Undo in ${name} brings back what it was.`);
}
