// The motion of a finger, a pen or a mouse over an element.

/** Millimetres of a CSS pixel. */
const MM_PER_PIXEL = 25.4 / 96;
/** Seconds over which the speed is averaged, and after which a pointer that sends nothing rests. */
const AVERAGED_S = 0.03;
const RESTS_S = 0.06;

/** Calls `moved({ speed, force, position })`, in mm/s, N and mm along the path, while a pointer is on the element; the
 * force is 0 when it leaves. `force` maps a pressure of 0 to 1 to newtons; a mouse has 0.5. Returns a function that ends this. */
export function followPointer(element, moved, { mmPerPixel = MM_PER_PIXEL, force = (pressure) => 0.8 * pressure } = {}) {
  let last = null;
  let motion = { speed: 0, force: 0, position: 0 };
  const tell = (change) => {
    motion = { ...motion, ...change };
    moved(motion);
  };
  const down = (event) => {
    element.setPointerCapture?.(event.pointerId);
    last = event;
    tell({ speed: 0, force: force(event.pressure || 0.5) });
  };
  const one = (event) => {
    const seconds = (event.timeStamp - last.timeStamp) / 1e3;
    if (seconds <= 0) return;
    const way = mmPerPixel * Math.hypot(event.clientX - last.clientX, event.clientY - last.clientY);
    const weight = 1 - Math.exp(-seconds / AVERAGED_S);
    last = event;
    tell({
      speed: motion.speed + weight * (way / seconds - motion.speed),
      force: force(event.pressure || 0.5),
      position: motion.position + way,
    });
  };
  const move = (event) => {
    if (!last) return;
    const all = event.getCoalescedEvents?.() ?? [];
    (all.length > 0 ? all : [event]).forEach(one);
  };
  const up = () => {
    last = null;
    tell({ speed: 0, force: 0 });
  };
  const timer = setInterval(() => {
    if (last && motion.speed > 0 && performance.now() - last.timeStamp > 1e3 * RESTS_S) tell({ speed: 0 });
  }, 1e3 * RESTS_S);
  const listeners = { pointerdown: down, pointermove: move, pointerup: up, pointercancel: up };
  for (const [name, listener] of Object.entries(listeners)) element.addEventListener(name, listener);
  return () => {
    clearInterval(timer);
    for (const [name, listener] of Object.entries(listeners)) element.removeEventListener(name, listener);
  };
}

/** Lets a node follow a pointer over an element. Returns a function that ends this. */
export function follow(element, node, options) {
  const moved = ({ speed, force, position }) => {
    node.speed.value = speed;
    node.force.value = force;
    node.position = position;
  };
  return followPointer(element, moved, options);
}
