// The sound of a page that plays one texture at a time. It begins with the first press.

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

/** The texture that plays. */
let playing: Texture;
let node: HtexNode | null = null;

/** Plays a texture from now on. */
export async function startSound(texture: Texture, model: string) {
  playing = texture;
  if (node) return node.load(texture, { model });
  const context = new AudioContext({ latencyHint: "interactive" });
  await prepare(context);
  const made = new HtexNode(context, texture, { model });
  node = made;
  made.onerror = ({ error }) => (failure.value = error.message);
  const limiter = new DynamicsCompressorNode(context, { threshold: -8, knee: 4, ratio: 20, attack: 0.002, release: 0.08 });
  const output = new GainNode(context, { gain: 0 });
  made.connect(limiter).connect(output).connect(context.destination);
  const resume = () => {
    isAwake.value = true;
    if (context.state === "suspended") context.resume().catch((error) => (failure.value = String(error)));
  };
  for (const press of PRESSES) addEventListener(press, resume, { capture: true });
  effect(() => void output.gain.setTargetAtTime(isAwake.value ? volume.value ** 2 : 0, context.currentTime, 0.01));
  let resting = 0;
  effect(() => {
    const { speed, force, position, x, y } = finger.value;
    made.speed.value = speed;
    made.force.value = force;
    // Of the built-in models, only the friction map follows the place.
    if (playing.hasModules) made.position = position;
    if (playing.hasModules || playing.models.includes("org.htex.map")) made.place = { x: x * padSize.width, y: y * padSize.height };
    clearTimeout(resting);
    if (force === 0) resting = window.setTimeout(() => void context.suspend().catch(() => {}), RESTS_MS);
    else if (isAwake.peek() && context.state === "suspended") context.resume().catch(() => {});
  });
}
