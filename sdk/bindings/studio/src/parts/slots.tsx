// The two versions of the work, beside undo: a press or a key puts one on the pad.

import { useEffect } from "preact/hooks";

import { isBlind } from "../comparing.ts";
import { SLOTS, type Slot } from "../history.ts";
import { isolated } from "../names.ts";
import { copyToOther, nameOf, other, resting, slot, swap } from "../slots.ts";
import { fail } from "../state.ts";
import { isTouch } from "../theme.ts";
import { Icon } from "./icons.tsx";

/** Whether a key is meant for a field: a letter is typed there, or chooses an option. */
function isForField({ target }: KeyboardEvent) {
  if (target instanceof HTMLInputElement) return !/^(range|checkbox|radio|button)$/.test(target.type);
  return target instanceof HTMLTextAreaElement || target instanceof HTMLSelectElement;
}

/** One key swaps the versions. */
function keys(event: KeyboardEvent) {
  if (event.key.toLowerCase() !== "x" || event.repeat || event.ctrlKey || event.metaKey || event.altKey || isForField(event)) return;
  swap().catch(fail);
}

function titleOf(of: Slot) {
  const key = isTouch.value ? "" : " (X)";
  const there = resting.value;
  if (of === slot.value) return `Version ${nameOf(of)} is on the pad. Your changes go to it.`;
  return there ? `Switch to version ${nameOf(of)}: ${isolated(there.name)}, ${there.change}${key}` : `Start version ${nameOf(of)} as a copy, to compare your changes with ${nameOf(slot.value)}${key}`;
}

export function Slots() {
  useEffect(() => {
    addEventListener("keydown", keys);
    return () => removeEventListener("keydown", keys);
  }, []);
  const isOff = isBlind.value;
  return (
    <div class="group slots" role="group" aria-label="Versions">
      {SLOTS.map((of) => (
        <button
          key={of}
          class={of === slot.value || resting.value ? "toggle" : "toggle unused"}
          aria-pressed={of === slot.value}
          aria-label={`Version ${nameOf(of)}`}
          aria-keyshortcuts={isTouch.value || of === slot.value ? undefined : "x"}
          title={titleOf(of)}
          disabled={isOff}
          onClick={() => swap(of).catch(fail)}
        >
          {nameOf(of)}
        </button>
      ))}
      <button class="icon-button" aria-label={`Copy to ${nameOf(other.value)}`} title={`Copy this texture to version ${nameOf(other.value)}`} disabled={isOff || !resting.value} onClick={copyToOther}>
        <Icon name="copy" />
      </button>
    </div>
  );
}
