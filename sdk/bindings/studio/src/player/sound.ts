// The sound of a player page. It begins with the first press.

import { effect, signal } from "@preact/signals";
import { HtexNode, prepare, type Texture } from "htex";

import { finger, padSize } from "../motion.ts";

export const volume = signal(0.7);
/** Whether something was pressed. */
export const isAwake = signal(false);
/** Why there is no sound; null if there is. */
export const failure = signal<string | null>(null);

/** Milliseconds of rest after which the audio thread stops. */
const RESTS_MS = 4000;
/** Events after which browsers allow sound. A touch counts when it is lifted. */
const PRESSES = ["pointerdown", "pointerup", "keydown"] as const;

export async function startSound(texture: Texture, model: string) {
  const context = new AudioContext({ latencyHint: "interactive" });
  await prepare(context);
  const node = new HtexNode(context, texture, { model });
  node.onerror = ({ error }) => (failure.value = error.message);
  const limiter = new DynamicsCompressorNode(context, { threshold: -8, knee: 4, ratio: 20, attack: 0.002, release: 0.08 });
  const output = new GainNode(context, { gain: 0 });
  node.connect(limiter).connect(output).connect(context.destination);
  const resume = () => {
    isAwake.value = true;
    if (context.state === "suspended") context.resume().catch((error) => (failure.value = String(error)));
  };
  for (const press of PRESSES) addEventListener(press, resume, { capture: true });
  effect(() => void output.gain.setTargetAtTime(isAwake.value ? volume.value ** 2 : 0, context.currentTime, 0.01));
  let resting = 0;
  effect(() => {
    const { speed, force, position, x, y } = finger.value;
    node.speed.value = speed;
    node.force.value = force;
    // Of the built-in models, only the friction map follows the place.
    if (texture.hasModules) node.position = position;
    if (texture.hasModules || texture.models.includes("org.htex.map")) node.place = { x: x * padSize.width, y: y * padSize.height };
    clearTimeout(resting);
    if (force === 0) resting = window.setTimeout(() => void context.suspend().catch(() => {}), RESTS_MS);
    else if (isAwake.peek() && context.state === "suspended") context.resume().catch(() => {});
  });
}
