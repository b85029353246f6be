// The pad: a surface that a finger slides over.

import { useEffect, useRef } from "preact/hooks";
import { followPointer } from "htex";

import { isBlind } from "../comparing.ts";
import { sound, wake } from "../engine.ts";
import { byHand, byKey, finger, handLeaves, padSize, pilot, pilotForce, releaseKeys, setPilot, stroke } from "../motion.ts";
import { present } from "../state.ts";
import { coverage, sounding } from "../shadow.ts";
import { isTouch } from "../theme.ts";
import { PadPainter } from "./pad-painter.ts";

/** Force of a pen's full pressure, N. */
const PEN_N = 1.5;
/** Forces of the keys 1 to 5, N. */
export const KEY_FORCES = [0.1, 0.2, 0.4, 0.8, 1.6];

/** Follows pointers over the pad; returns a function that ends this. */
function attach(element: HTMLElement) {
  let type = "mouse";
  let began = 0;
  let points: { t: number; x: number; y: number }[] = [];
  const place = (event: PointerEvent) => {
    const box = element.getBoundingClientRect();
    const clamp = (part: number) => Math.min(Math.max(part, 0), 1);
    return { x: clamp((event.clientX - box.left) / box.width), y: clamp((event.clientY - box.top) / box.height) };
  };
  const down = (event: PointerEvent) => {
    if (!event.isPrimary || event.button !== 0) return;
    wake();
    type = event.pointerType;
    began = event.timeStamp;
    points = [];
    byHand(place(event));
  };
  const move = (event: PointerEvent) => {
    if (!event.isPrimary || event.buttons === 0) return;
    points.push({ t: (event.timeStamp - began) / 1e3, ...place(event) });
    byHand(place(event));
  };
  const up = () => {
    if (points.length > 2) stroke.value = points;
    points = [];
  };
  const wheel = (event: WheelEvent) => {
    event.preventDefault();
    const next = pilotForce.peek() * Math.exp(-event.deltaY / 600);
    pilotForce.value = Math.min(Math.max(next, 0.05), 3);
    if (finger.peek().force > 0 && type !== "pen") byHand({ force: pilotForce.value });
  };
  element.addEventListener("pointerdown", down);
  element.addEventListener("pointermove", move);
  element.addEventListener("pointerup", up);
  element.addEventListener("wheel", wheel, { passive: false });
  const force = (pressure: number) => PEN_N * pressure;
  // Speed and way come in pixels: the pad may change its size while a finger is on it.
  const moved = ({ speed, force: now, position }: { speed: number; force: number; position: number }) => {
    const mmPerPixel = padSize.width / Math.max(element.clientWidth, 1);
    const pressed = type === "pen" ? now : pilotForce.peek();
    if (now > 0) byHand({ speed: speed * mmPerPixel, force: pressed, position: position * mmPerPixel });
    else handLeaves();
  };
  const end = followPointer(element, moved, { force, mmPerPixel: 1 });
  const observer = new ResizeObserver(() => {
    // A hidden pad keeps its size, because the path of the autopilot depends on it.
    if (element.clientHeight > 0) padSize.height = (padSize.width * element.clientHeight) / element.clientWidth;
  });
  observer.observe(element);
  return () => {
    observer.disconnect();
    end();
    element.removeEventListener("pointerdown", down);
    element.removeEventListener("pointermove", move);
    element.removeEventListener("pointerup", up);
    element.removeEventListener("wheel", wheel);
  };
}

function keyDown(event: KeyboardEvent) {
  if (event.key.startsWith("Arrow")) {
    wake();
    byKey(event.key, true, event.shiftKey);
  } else if (event.key === " ") {
    wake();
    setPilot(pilot.peek() === "hand" ? "to-and-fro" : "hand");
  } else if (/^[1-5]$/.test(event.key) && !event.ctrlKey && !event.metaKey) {
    pilotForce.value = KEY_FORCES[Number(event.key) - 1] ?? 0.4;
  } else return;
  event.preventDefault();
  event.stopPropagation();
}

export function Pad() {
  const canvas = useRef<HTMLCanvasElement>(null);
  useEffect(() => {
    if (!canvas.current) return;
    const painter = new PadPainter(canvas.current);
    const end = attach(canvas.current);
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
        onKeyDown={keyDown}
        onKeyUp={(event) => byKey(event.key, false, event.shiftKey)}
        onBlur={releaseKeys}
        onContextMenu={(event) => event.preventDefault()}
      />
      <p class="pad-hint keys" aria-hidden="true">
        Arrows slide, Shift faster · 1–5 press · Space slides back and forth
      </p>
      {sound.value === "off" && <p class="pad-hint">Press and slide</p>}
    </div>
  );
}
