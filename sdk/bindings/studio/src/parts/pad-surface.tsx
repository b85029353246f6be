// The surface that a finger slides over, by mouse, by touch and by keys.

import { useEffect, useRef } from "preact/hooks";

import { byKey, releaseKeys } from "../motion.ts";
import { isTouch } from "../theme.ts";
import { followHand, followKey } from "./pad-hand.ts";
import { PadPainter } from "./pad-painter.ts";

interface Given {
  /** What it is the pad of. */
  name: string;
  isOutside: boolean;
  shown: ConstructorParameters<typeof PadPainter>[1];
  /** Begins the sound. */
  wake: () => void;
  children: preact.ComponentChildren;
}

export function PadSurface({ name, isOutside, shown, wake, children }: Given) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (!canvas.current) return;
    const painter = new PadPainter(canvas.current, shown);
    const end = followHand(canvas.current, wake);
    return () => {
      end();
      painter.end();
    };
  }, []);
  return (
    <div class={isOutside ? "pad outside" : "pad"}>
      <canvas
        ref={canvas}
        id="pad"
        tabIndex={0}
        role="application"
        aria-label={`Pad of ${name}. ${isTouch.value ? "Press and slide." : "Arrow keys slide, Shift slides faster, 1 to 5 press harder, Space slides back and forth."}`}
        onKeyDown={(event) => followKey(event, wake)}
        onKeyUp={(event) => byKey(event.key, false, event.shiftKey)}
        onBlur={releaseKeys}
        onContextMenu={(event) => event.preventDefault()}
      />
      <p class="pad-hint keys" aria-hidden="true">
        Arrows slide, Shift faster · 1–5 press · Space slides back and forth
      </p>
      {children}
    </div>
  );
}
