// The lamp over the pad, which lights its relief from where it is.

import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { followLamp, lampText } from "../look/follow-lamp.ts";
import { USUAL_LAMP, type Lamp } from "../look/light.ts";
import { Icon } from "./icons.tsx";

export const lamp = signal<Lamp>(USUAL_LAMP);

export function LampHandle() {
  const handle = useRef<HTMLDivElement>(null);
  useEffect(() => (handle.current ? followLamp(handle.current, () => lamp.peek(), (next) => (lamp.value = next)) : undefined), []);
  const { x, y } = lamp.value;
  return (
    <div
      ref={handle}
      class="lamp"
      role="slider"
      tabIndex={0}
      aria-label="Light on the pad"
      aria-valuemin={0}
      aria-valuemax={100}
      aria-valuenow={Math.round(100 * x)}
      aria-valuetext={lampText(lamp.value)}
      title="Drag the light"
      style={{ "--x": `${100 * x}%`, "--y": `${100 * y}%` }}
    >
      <Icon name="light" />
    </div>
  );
}
