// What is being opened: how far it is, a way to stop, and what could not be opened.

import { signal } from "@preact/signals";

import { isolated, list } from "./names.ts";
import { say } from "./state.ts";
import { troubleOf, type Trouble } from "./trouble.ts";

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

/** Most files that are named. */
const MOST_NAMED = 3;

const counted = (count: number) => `${count.toLocaleString("en")} ${count === 1 ? "file" : "files"}`;

/** The exact words for a problem. */
function exact({ name, error }: Problem) {
  const { text, details = text } = troubleOf(error, name);
  return details.includes(name) ? details : `${name}: ${details}`;
}

/** What is said of problems; null if there are none. */
function told(problems: readonly Problem[]): Trouble | null {
  const [first] = problems;
  if (!first) return null;
  if (problems.length === 1) return troubleOf(first.error, first.name);
  const names = problems.slice(0, MOST_NAMED).map(({ name }) => isolated(name));
  const rest = problems.length - names.length;
  const all = rest > 0 ? [...names, `${rest} more`] : names;
  return { text: `${counted(problems.length)} could not be opened: ${list(all)}.`, details: problems.map(exact).join("\n") };
}

/** Says what came of opening files. `lost`: what was not stored; empty if all was. */
export function sayOpened(sentences: readonly string[], lost: string, problems: readonly Problem[]) {
  const trouble = told(problems);
  const text = [...sentences, lost, trouble?.text].filter(Boolean).join(" ");
  if (text) say(text, lost || trouble ? "bad" : "good", trouble?.details ? { details: trouble.details } : {});
}
