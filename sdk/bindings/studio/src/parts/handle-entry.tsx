// Typing the value of a handle: decibels, and the frequency if the handle has one of its own.

import { useLayoutEffect, useRef } from "preact/hooks";

import type { Handle } from "../shaping/shaper.ts";

interface Props {
  handle: Handle;
  /** Where the handle is, px from the upper left corner of the curve. */
  at: readonly [x: number, y: number];
  onValue: (hz: number, db: number) => void;
  /** The user is done. */
  onClose: () => void;
}

/** Half of its width, and how far it is below the handle, px. */
const [HALF, BELOW] = [110, 16];

/** A number as it is typed, or the one before. */
const typed = (form: HTMLFormElement, name: string, before: number) => {
  const { valueAsNumber = NaN } = (form.elements.namedItem(name) as HTMLInputElement | null) ?? {};
  return Number.isFinite(valueAsNumber) ? valueAsNumber : before;
};

export function HandleEntry({ handle, at: [x, y], onValue, onClose }: Props) {
  const form = useRef<HTMLFormElement>(null);
  useLayoutEffect(() => {
    const field = form.current?.querySelector("input");
    field?.focus({ preventScroll: true });
    field?.select();
  }, []);
  const take = (event: Event) => {
    event.preventDefault();
    if (form.current) onValue(typed(form.current, "hz", handle.hz), typed(form.current, "db", handle.db));
    onClose();
  };
  const key = (event: KeyboardEvent) => {
    if (event.key !== "Escape") return;
    // It closes only this, and does not silence the pad.
    event.stopPropagation();
    onClose();
  };
  return (
    <form ref={form} class="handle-entry" aria-label={`Value of ${handle.name}`} style={{ left: `clamp(0px, ${x - HALF}px, 100% - ${2 * HALF}px)`, top: `min(${y + BELOW}px, 100% - ${4 * BELOW}px)` }} onSubmit={take} onKeyDown={key}>
      <label class="field">
        dB
        <input name="db" type="number" step="any" defaultValue={handle.db.toFixed(1)} />
      </label>
      {handle.moves === "both" && (
        <label class="field">
          Hz
          <input name="hz" type="number" step="any" min="20" max="1000" defaultValue={handle.hz.toFixed(1)} />
        </label>
      )}
      <button class="button strong">Set</button>
    </form>
  );
}
