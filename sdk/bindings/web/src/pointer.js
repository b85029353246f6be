// Measures the motion of a finger, a pen or a mouse over an element.

import { HtexError } from "./core.js";
import { checked } from "./options.js";

/** Size of a CSS pixel, mm. */
const MM_PER_PIXEL = 25.4 / 96;
/**
 * Time over which the speed is averaged, seconds; and time after which a pointer that sends no
 * events counts as resting.
 */
const AVERAGED_S = 0.03;
const RESTS_S = 0.06;
/** Force of a pointer that reports no pressure, N. */
const FORCE_N = 0.4;
/**
 * Pressures that devices without a pressure sensor send: 0.5 is in the specification, and some
 * browsers send 0 or 1.
 */
const NO_PRESSURE = [0, 0.5, 1];
/**
 * Events that browsers count as a user gesture, after which they allow sound. A touch counts when
 * it is lifted.
 */
const GESTURES = ["pointerdown", "pointerup", "touchend", "click", "keydown"];

const OPTIONS = { mmPerPixel: "number", force: "function", defaultForce: "number" };

/**
 * Computes the force of pointer events, N. A device that has sent only the pressures in
 * `NO_PRESSURE` counts as one that does not measure pressure.
 */
class Force {
  constructor(map, unknown) {
    this.map = map;
    this.unknown = unknown;
    this.measuring = new Set();
  }

  of({ pointerType, pressure }) {
    if (pointerType !== "mouse" && !NO_PRESSURE.includes(pressure)) this.measuring.add(pointerType);
    return this.measuring.has(pointerType) ? this.map(pressure) : this.unknown;
  }
}

/**
 * Calls `moved({ speed, force, position, x, y })` while a pointer presses on the element. `speed`
 * is in mm/s, `force` in N, `position` in mm along the path, and `x` and `y` in mm from the upper
 * left corner. The force is 0 when the pointer leaves. Only one pointer is followed at a time, and
 * a mouse only while its primary button is pressed. Returns a function that stops following.
 */
export function followPointer(element, moved, options = {}) {
  check(element, "followPointer");
  const { mmPerPixel = MM_PER_PIXEL, force: map = (pressure) => 0.8 * pressure, defaultForce = FORCE_N } = checked(options, OPTIONS, "followPointer");
  const force = new Force(map, defaultForce);
  let last = null;
  let motion = { speed: 0, force: 0, position: 0, x: 0, y: 0 };
  const place = ({ clientX, clientY }) => {
    const { left, top } = element.getBoundingClientRect();
    return { x: mmPerPixel * (clientX - left), y: mmPerPixel * (clientY - top) };
  };
  const tell = (change) => {
    motion = { ...motion, ...change };
    moved(motion);
  };
  const down = (event) => {
    if (last || event.button !== 0) return;
    element.setPointerCapture?.(event.pointerId);
    last = event;
    tell({ speed: 0, force: force.of(event), ...place(event) });
  };
  const one = (event) => {
    const seconds = (event.timeStamp - last.timeStamp) / 1e3;
    if (seconds <= 0) return;
    const way = mmPerPixel * Math.hypot(event.clientX - last.clientX, event.clientY - last.clientY);
    const weight = 1 - Math.exp(-seconds / AVERAGED_S);
    last = event;
    tell({
      speed: motion.speed + weight * (way / seconds - motion.speed),
      force: force.of(event),
      position: motion.position + way,
      ...place(event),
    });
  };
  const isOther = (event) => !last || event.pointerId !== last.pointerId;
  const move = (event) => {
    if (isOther(event)) return;
    const all = event.getCoalescedEvents?.() ?? [];
    (all.length > 0 ? all : [event]).forEach(one);
  };
  const up = (event) => {
    // A mouse sends `pointerup` only when its last pressed button is released.
    if (isOther(event)) return;
    last = null;
    tell({ speed: 0, force: 0 });
  };
  const timer = setInterval(() => {
    if (last && motion.speed > 0 && performance.now() - last.timeStamp > 1e3 * RESTS_S) tell({ speed: 0 });
  }, 1e3 * RESTS_S);
  // Otherwise the browser would scroll and end the pointer.
  const { touchAction } = element.style;
  element.style.touchAction = "none";
  const listening = listen(element, { pointerdown: down, pointermove: move, pointerup: up, pointercancel: up, lostpointercapture: up });
  return () => {
    clearInterval(timer);
    listening();
    element.style.touchAction = touchAction;
  };
}

/**
 * Makes a node follow a pointer over an element, and resumes its audio context on the first press.
 * Returns a function that stops following.
 */
export function follow(element, node, options) {
  check(element, "follow");
  if (!node?.speed?.setValueAtTime || !node.context) throw new HtexError("follow takes an element and an HtexNode", "invalid-argument");
  const moved = ({ speed, force, position, x, y }) => {
    node.speed.value = speed;
    node.force.value = force;
    node.position = position;
    node.place = { x, y };
  };
  const unfollow = followPointer(element, moved, options);
  const resume = () => void (node.context.state !== "running" && node.context.state !== "closed" && node.context.resume().catch(() => {}));
  const unlisten = listen(element, Object.fromEntries(GESTURES.map((name) => [name, resume])));
  return () => {
    unfollow();
    unlisten();
  };
}

function check(element, call) {
  if (element?.addEventListener && element.style) return;
  const advice = element === null ? "; `querySelector` found none" : "";
  throw new HtexError(`${call} takes an element of the page first${advice}`, "invalid-argument");
}

/** Adds listeners and returns a function that removes them. */
function listen(element, listeners) {
  for (const [name, listener] of Object.entries(listeners)) element.addEventListener(name, listener);
  return () => {
    for (const [name, listener] of Object.entries(listeners)) element.removeEventListener(name, listener);
  };
}
