// The finger on the pad: where it is, how fast, and how hard it presses; moved by a hand, by keys or by the autopilot.

import { computed, signal } from "@preact/signals";

export type Pilot = "hand" | "steady" | "to-and-fro" | "circle" | "stroke";

export interface Finger {
  /** Speed, mm/s. */
  readonly speed: number;
  /** Normal force, N; 0 off the surface. */
  readonly force: number;
  /** Place on the pad, 0 to 1 in each direction. */
  readonly x: number;
  readonly y: number;
  /** Way along the path, mm. */
  readonly position: number;
}

export const finger = signal<Finger>({ speed: 0, force: 0, x: 0.5, y: 0.5, position: 0 });
export const pilot = signal<Pilot>("hand");
/** Speed and force of the autopilot and of keys. */
export const pilotSpeed = signal(80);
export const pilotForce = signal(0.4);
/** The motion that the sliders are set to. */
export const sliders = computed(() => ({ speed: pilotSpeed.value, force: pilotForce.value }));
/** Size of the pad, mm. */
export const padSize = { width: 100, height: 100 };
/** Points of the stroke that was drawn last: seconds and place. */
export const stroke = signal<readonly { t: number; x: number; y: number }[]>([]);

/** Who moves the finger now; a hand takes it from keys, and both from the autopilot. */
let hand = false;
const keys = new Set<string>();
let fast = false;
let frame = 0;
let last = 0;
let clock = 0;
let direction: [number, number] = [1, 0.35];

export function isMoving() {
  return hand || keys.size > 0 || pilot.peek() !== "hand";
}

/** Whether the autopilot slides at the speed of the sliders: no hand, no keys, no drawn stroke. */
export function isPiloted() {
  return !hand && keys.size === 0 && pilot.peek() !== "hand" && pilot.peek() !== "stroke";
}

function tell(change: Partial<Finger>) {
  finger.value = { ...finger.peek(), ...change };
}

/** The finger follows a hand. */
export function byHand(motion: Partial<Finger>) {
  hand = true;
  tell(motion);
}

export function handLeaves() {
  hand = false;
  if (isMoving()) run();
  else tell({ speed: 0, force: 0 });
}

/** An arrow key goes down or up. */
export function byKey(key: string, isDown: boolean, isFast: boolean) {
  fast = isFast;
  if (isDown) keys.add(key);
  else keys.delete(key);
  if (isMoving()) run();
  else tell({ speed: 0, force: 0 });
}

export function releaseKeys() {
  if (keys.size === 0) return;
  keys.clear();
  if (!isMoving()) tell({ speed: 0, force: 0 });
}

export function setPilot(next: Pilot) {
  pilot.value = next;
  clock = 0;
  if (isMoving()) run();
  else rest();
}

/** Silence: the finger leaves the surface. */
export function rest() {
  pilot.value = "hand";
  keys.clear();
  hand = false;
  tell({ speed: 0, force: 0 });
}

function run() {
  if (frame) return;
  last = performance.now();
  frame = requestAnimationFrame(step);
}

function step(now: number) {
  frame = 0;
  const seconds = Math.min((now - last) / 1e3, 0.1);
  last = now;
  if (!hand) {
    if (keys.size > 0) byKeys(seconds);
    else if (pilot.peek() !== "hand") byPilot(seconds);
    else return tell({ speed: 0, force: 0 });
  }
  if (isMoving()) frame = requestAnimationFrame(step);
}

const ARROWS: Record<string, [number, number]> = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };

function byKeys(seconds: number) {
  const way = [...keys].map((key) => ARROWS[key] ?? [0, 0]);
  const [dx, dy] = way.reduce<[number, number]>(([x, y], [a, b]) => [x + (a ?? 0), y + (b ?? 0)], [0, 0]);
  const length = Math.hypot(dx, dy);
  const speed = length > 0 ? pilotSpeed.peek() * (fast ? 2 : 1) : 0;
  glide(speed, length > 0 ? [dx / length, dy / length] : [0, 0], seconds);
}

/** Moves the finger straight on; at an edge it goes on from the other side, as over an endless sheet. */
function glide(speed: number, [dx, dy]: [number, number], seconds: number) {
  const { x, y, position } = finger.peek();
  const wrap = (place: number) => place - Math.floor(place);
  tell({
    speed,
    force: pilotForce.peek(),
    x: wrap(x + (dx * speed * seconds) / padSize.width),
    y: wrap(y + (dy * speed * seconds) / padSize.height),
    position: position + speed * seconds,
  });
}

function byPilot(seconds: number) {
  clock += seconds;
  const speed = pilotSpeed.peek();
  if (pilot.peek() === "steady") {
    const length = Math.hypot(...direction);
    return glide(speed, [direction[0] / length, direction[1] / length], seconds);
  }
  if (pilot.peek() === "stroke") return alongStroke(seconds);
  const { x, y, position } = finger.peek();
  const [nextX, nextY, now] = pilot.peek() === "circle" ? circle(speed) : toAndFro(speed);
  tell({ speed: now, force: pilotForce.peek(), x: nextX, y: nextY, position: position + now * seconds });
  direction = [nextX - x || 1, nextY - y || 0.35];
}

/** Harmonic strokes whose greatest speed is the chosen one. */
function toAndFro(speed: number): [number, number, number] {
  const reach = 0.36;
  const phase = (speed * clock) / (reach * padSize.width);
  return [0.5 + reach * Math.sin(phase), 0.5, speed * Math.abs(Math.cos(phase))];
}

function circle(speed: number): [number, number, number] {
  const radius = 0.3 * Math.min(padSize.width, padSize.height);
  const phase = (speed * clock) / radius;
  return [0.5 + (radius / padSize.width) * Math.cos(phase), 0.5 + (radius / padSize.height) * Math.sin(phase), speed];
}

/** The stroke that was drawn last, again and again. */
function alongStroke(seconds: number) {
  const points = stroke.peek();
  const end = points.at(-1)?.t ?? 0;
  if (points.length < 2 || end <= 0) return tell({ speed: 0, force: 0 });
  const at = clock % end;
  const next = Math.max(points.findIndex((point) => point.t > at), 1);
  const [a, b] = [points[next - 1], points[next]];
  if (!a || !b) return;
  const part = (at - a.t) / Math.max(b.t - a.t, 1e-6);
  const way = Math.hypot((b.x - a.x) * padSize.width, (b.y - a.y) * padSize.height);
  const speed = way / Math.max(b.t - a.t, 1e-3);
  const { position } = finger.peek();
  const [x, y] = [a.x + part * (b.x - a.x), a.y + part * (b.y - a.y)];
  tell({ speed, force: pilotForce.peek(), x, y, position: position + speed * seconds });
}
