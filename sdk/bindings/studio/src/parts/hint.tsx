// A hint for the first minute: first on the knobs, then on *Save*. Each is closed for good when the user did what it says, or closed it.

import { computed } from "@preact/signals";

import { isBlind } from "../comparing.ts";
import { done, finish } from "../first-steps.ts";
import { toSave } from "../giving.ts";
import { origin, present, screen } from "../state.ts";
import { isTouch } from "../theme.ts";
import { Icon } from "./icons.tsx";

const isEdited = computed(() => present.value !== null && present.value.bytes !== origin.value?.bytes);

/** The step whose hint is shown now. */
export const hinted = computed<"change" | "keep" | null>(() => {
  if (isBlind.value || !present.value) return null;
  if (!done.value.has("change")) return "change";
  return !done.value.has("keep") && isEdited.value && screen.value !== "give" ? "keep" : null;
});

export function Hint() {
  const step = hinted.value;
  if (!step) return null;
  return (
    <div class="first-hint">
      {step === "change" ? (
        <p>{isTouch.value ? "Drag a knob up or down to change what you feel." : "Drag a knob up or down, or use its arrow keys."}</p>
      ) : (
        <p>
          Do you like it?
          <button class="button" onClick={toSave}>
            Save it…
          </button>
        </p>
      )}
      <button class="icon-button" aria-label="Close this hint" onClick={() => finish(step)}>
        <Icon name="close" />
      </button>
    </div>
  );
}
