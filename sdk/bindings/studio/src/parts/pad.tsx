// The pad: a surface that a finger slides over.

import { useEffect, useRef } from "preact/hooks";

import { isBlind } from "../comparing.ts";
import { wake } from "../engine.ts";
import { byKey, releaseKeys } from "../motion.ts";
import { present } from "../state.ts";
import { coverage, pictured, sounding } from "../shadow.ts";
import { isTouch } from "../theme.ts";
import { FirstWords } from "./first-words.tsx";
import { followHand, followKey } from "./pad-hand.ts";
import { LampHandle } from "./lamp.tsx";
import { PadPainter } from "./pad-painter.ts";

export function Pad() {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (!canvas.current) return;
    const painter = new PadPainter(canvas.current, { sounding, pictured });
    const end = followHand(canvas.current, wake);
    return () => {
      end();
      painter.end();
    };
  }, []);
  const { inside } = coverage.value;
  const name = isBlind.value ? "a blind test" : sounding.value?.texture.name ?? present.value?.name ?? "no texture";
  return (
    <div class={inside ? "pad" : "pad outside"}>
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
      <FirstWords />
      {!isBlind.value && <LampHandle />}
    </div>
  );
}
