// The three words on the pad: what there is to do. They go when all of it was done once.

import { isBlind } from "../comparing.ts";
import { done, type Step } from "../first-steps.ts";
import { sound } from "../engine.ts";

const WORDS: readonly [Step, string][] = [["touch", "Touch."], ["change", "Change."], ["keep", "Keep."]];

export function FirstWords() {
  if (isBlind.value) return null;
  const next = WORDS.find(([step]) => !done.value.has(step));
  if (!next) return sound.value === "off" ? <p class="pad-hint">Press and slide</p> : null;
  return (
    <p class="pad-hint first-words">
      {WORDS.map(([step, word]) => (
        <span key={step} class={done.value.has(step) ? "done" : step === next[0] ? "next" : ""}>
          {word}{" "}
        </span>
      ))}
    </p>
  );
}
