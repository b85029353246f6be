// The lamp of a pad: its handle is dragged, or moved by keys.

import type { Lamp } from "./light.ts";

/** Steps of the arrow keys, and of Page Up and Page Down. */
const [STEP, PAGE] = [0.05, 0.25];

const clamp = (part: number) => Math.min(Math.max(part, 0), 1);

const KEYS: Record<string, (lamp: Lamp) => Lamp> = {
  ArrowLeft: ({ x, y }) => ({ x: x - STEP, y }),
  ArrowRight: ({ x, y }) => ({ x: x + STEP, y }),
  ArrowUp: ({ x, y }) => ({ x, y: y - STEP }),
  ArrowDown: ({ x, y }) => ({ x, y: y + STEP }),
  PageUp: ({ x, y }) => ({ x, y: y - PAGE }),
  PageDown: ({ x, y }) => ({ x, y: y + PAGE }),
  Home: ({ y }) => ({ x: 0, y }),
  End: ({ y }) => ({ x: 1, y }),
};

/** Where the lamp is, in words. */
export const lampText = ({ x, y }: Lamp) => `${Math.round(100 * x)} % across, ${Math.round(100 * y)} % down`;

/** Follows the handle, which lies in the pad; returns a function that ends this. */
export function followLamp(handle: HTMLElement, now: () => Lamp, move: (lamp: Lamp) => void) {
  const to = ({ x, y }: Lamp) => move({ x: clamp(x), y: clamp(y) });
  const down = (event: PointerEvent) => {
    if (!event.isPrimary || event.button !== 0) return;
    // The handle has the focus, so that the keys go on where the hand ends.
    handle.setPointerCapture(event.pointerId);
  };
  const drag = (event: PointerEvent) => {
    if (!handle.hasPointerCapture(event.pointerId)) return;
    const box = handle.parentElement?.getBoundingClientRect();
    if (box) to({ x: (event.clientX - box.left) / box.width, y: (event.clientY - box.top) / box.height });
  };
  const key = (event: KeyboardEvent) => {
    const next = KEYS[event.key];
    if (!next || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    to(next(now()));
  };
  handle.addEventListener("pointerdown", down);
  handle.addEventListener("pointermove", drag);
  handle.addEventListener("keydown", key);
  return () => {
    handle.removeEventListener("pointerdown", down);
    handle.removeEventListener("pointermove", drag);
    handle.removeEventListener("keydown", key);
  };
}
