// What is being opened: how far it is, a way to stop, and what could not be opened.

import { signal } from "@preact/signals";

/** A file or a texture that could not be opened, and why. */
export interface Problem {
  readonly name: string;
  readonly error: unknown;
}

export interface Progress {
  readonly text: string;
  readonly done: number;
  readonly of: number;
}

/** What long work tells and asks while it goes on. */
export interface Work {
  /** Tells that a step begins. */
  readonly step: (text: string) => void;
  readonly signal: AbortSignal;
}

/** How far the opening of files is; null if none are being opened. */
export const opening = signal<Progress | null>(null);

/** Shortest time between two tellings, ms. */
const TOLD_MS = 60;

let controller: AbortController | null = null;

/** Stops the opening. What was opened stays. */
export function stopOpening() {
  controller?.abort();
}

/** Does work of so many steps, whose progress is shown and which can be stopped. */
export async function withProgress<T>(of: number, run: (work: Work) => Promise<T>): Promise<T> {
  const own = new AbortController();
  controller = own;
  let [done, told] = [0, 0];
  const step = (text: string) => {
    const now = performance.now();
    if (now - told > TOLD_MS) {
      opening.value = { text, done, of };
      told = now;
    }
    done += 1;
  };
  try {
    return await run({ step, signal: own.signal });
  } finally {
    opening.value = null;
    controller = null;
  }
}

/** Most problems that are told one by one. */
const MOST_TOLD = 3;

const counted = (count: number) => `${count.toLocaleString("en")} ${count === 1 ? "file" : "files"}`;

function reason({ name, error }: Problem) {
  const message = error instanceof Error ? error.message : String(error);
  return message.includes(name) ? message : `${name}: ${message}`;
}

/** Problems in a sentence; empty if there are none. */
export function told(problems: readonly Problem[]) {
  const [first] = problems;
  if (!first) return "";
  if (problems.length === 1) return reason(first);
  const rest = problems.length - MOST_TOLD;
  const reasons = problems.slice(0, MOST_TOLD).map(reason).join("; ");
  return `${counted(problems.length)} could not be opened: ${reasons}${rest > 0 ? `; and ${rest} more` : ""}.`;
}
