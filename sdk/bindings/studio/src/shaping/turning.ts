// Turning a knob: the module that makes textures may have to come first, and the change is heard at once.

import { computed, signal } from "@preact/signals";

import { hearChange } from "../audition.ts";
import { author, theAuthor } from "../author.ts";
import { heardSide, play } from "../comparing.ts";
import { fail } from "../state.ts";
import { endGesture, macros, setMacro } from "./session.ts";
import type { Macros } from "./shaper.ts";

/** What was turned before the module is there. */
const waiting = signal<Partial<Macros>>({});

/** Where the knobs stand. */
export const knobs = computed<Macros>(() => ({ ...macros.value, ...waiting.value }));

/** Plays what was changed: on *Compare* the side that plays, elsewhere the texture on the pad. */
function hear() {
  const side = heardSide.peek();
  if (side === "a" || side === "b") play(side);
  else hearChange();
}

/** Whether a hand or a key turns a knob now. */
let isTurned = false;

async function turnWaiting() {
  try {
    await theAuthor();
    for (const [name, value] of Object.entries(waiting.peek()) as [keyof Macros, number][]) setMacro(name, value);
    if (!isTurned) endGesture();
    hear();
  } catch (error) {
    fail(error);
  } finally {
    waiting.value = {};
  }
}

/** Turns a knob. Calls until `endTurn` are one step of the history. */
export function turn(name: keyof Macros, value: number) {
  isTurned = true;
  const isFirst = Object.keys(waiting.peek()).length === 0;
  if (!author.peek()) {
    waiting.value = { ...waiting.peek(), [name]: value };
    if (isFirst) void turnWaiting();
    return;
  }
  setMacro(name, value);
  hear();
}

export function endTurn() {
  isTurned = false;
  endGesture();
}

/** Loads what knobs need, before the first turn. */
export function prepareToTurn() {
  theAuthor().catch(() => {});
}
