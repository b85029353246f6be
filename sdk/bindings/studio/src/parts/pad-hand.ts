// A hand on a pad: pointers, the wheel and keys move the finger.

import { followPointer } from "htex";

import { byHand, byKey, finger, handLeaves, padSize, pilot, pilotForce, setPilot, stroke } from "../motion.ts";

/** Force of a pen's full pressure, N. */
const PEN_N = 1.5;
/** Forces of the keys 1 to 5, N. */
export const KEY_FORCES = [0.1, 0.2, 0.4, 0.8, 1.6];

/** Follows pointers over the pad, and calls `wake` at each press. Returns a function that ends this. */
export function followHand(element: HTMLElement, wake: () => void) {
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

/** Follows a key on the pad, and calls `wake` if it moves the finger. */
export function followKey(event: KeyboardEvent, wake: () => void) {
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

