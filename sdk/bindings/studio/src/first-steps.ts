// The first minute: three steps that the page explains until the user did each of them once, or closed its hint.

import { signal } from "@preact/signals";

export type Step = "touch" | "change" | "keep";

const STORED = "htex-studio-first-steps";

function read(): ReadonlySet<Step> {
  try {
    return new Set((localStorage.getItem(STORED) ?? "").split(" ").filter(Boolean) as Step[]);
  } catch {
    return new Set();
  }
}

/** The steps that the user did, on this visit or on an earlier one. */
export const done = signal(read());

export function finish(step: Step) {
  if (done.peek().has(step)) return;
  done.value = new Set([...done.peek(), step]);
  try {
    localStorage.setItem(STORED, [...done.peek()].join(" "));
  } catch {
    // A browser that stores nothing explains the steps again on the next visit.
  }
}
