// The sound: an audio context, the node that plays, the limiter, and what follows the finger.

import { effect, signal } from "@preact/signals";
import { HtexNode, prepare, type Loop, type Texture } from "htex";

import { usualGain } from "./loudness.ts";
import { finger, padSize } from "./motion.ts";
import { fail, origin, present, texture } from "./state.ts";

/** What sounds: the present texture, or one that is tried. */
export interface Sounding {
  readonly texture: Texture;
  readonly model: string;
  /** Part of full scale for a sample of one unit. Default: the loudness of the piece of work. */
  readonly gain?: number;
  /**
   * Whether it plays at its own usual loudness instead of the loudness of the piece of work: for
   * textures that are browsed.
   */
  readonly own?: boolean;
  /** A recording that sounds in place of the texture that was made of it. */
  readonly loop?: Loop;
}

/** Factor of all frequencies of *Audible*. */
export const AUDIBLE = 4;

/** Bands of the envelope that motors follow. */
const BANDS = 1;
/** Seconds in which a new node fades in. */
const ENTERS_S = 0.01;

/** "off": no press yet, so that the browser plays nothing. */
export const sound = signal<"off" | "on" | "muted">("off");
export const volume = signal(0.7);
export const audible = signal(false);
/** A texture that is tried instead of the present one. */
export const tried = signal<Sounding | null>(null);
/** What the node played since it was last asked, for meters and motors. */
export const envelope = signal<{ level: number; centroid: number }>({ level: 0, centroid: 0 });

let context: AudioContext | null = null;
let output: GainNode | null = null;
let meter: AnalyserNode | null = null;
let node: HtexNode | null = null;
/** Earlier nodes, which play until the new one sounds. */
let leaving: HtexNode[] = [];
/** Gain of the piece of work, which belongs to the texture that it began with. */
let gain = 1;
let playing: Texture | null = null;

export function audioContext() {
  return context;
}

export function playingNode() {
  return node;
}

/** Whether the audio thread runs. */
export const isRunning = signal(false);

/** The samples that go to the loudspeaker, for the meter. */
export function heard(into: Float32Array<ArrayBuffer>) {
  if (meter && context?.state === "running") meter.getFloatTimeDomainData(into);
  else into.fill(0);
  return into;
}

/** Makes the context, which stays silent until the first press. */
export async function warm() {
  if (context) return;
  context = new AudioContext({ latencyHint: "interactive" });
  context.onstatechange = () => (isRunning.value = context?.state === "running");
  const limiter = new DynamicsCompressorNode(context, { threshold: -8, knee: 4, ratio: 20, attack: 0.002, release: 0.08 });
  output = new GainNode(context, { gain: 0 });
  meter = new AnalyserNode(context, { fftSize: 1024 });
  limiter.connect(output).connect(meter).connect(context.destination);
  entrance = limiter;
  await prepare(context);
  isReady.value = true;
}

let entrance: AudioNode | null = null;
const isReady = signal(false);

/** Lets sound begin; called by a press or a key. */
export function wake() {
  if (sound.peek() === "off") sound.value = "on";
  if (context?.state === "suspended") context.resume().catch(fail);
  attend(finger.peek().force > 0);
}

export function toggleSound() {
  if (sound.peek() === "on") sound.value = "muted";
  else {
    wake();
    sound.value = "on";
  }
}

/** Milliseconds of rest after which the audio thread stops. */
const RESTS_MS = 4000;
let resting = 0;

/** Lets the audio thread run while a finger is down, and some seconds after. */
function attend(isDown: boolean) {
  if (isDown) {
    clearTimeout(resting);
    resting = 0;
    if (sound.peek() !== "off" && context?.state === "suspended") context.resume().catch(fail);
  } else resting ||= window.setTimeout(sleep, RESTS_MS);
}

function sleep() {
  resting = 0;
  if (context?.state === "running" && finger.peek().force === 0) context.suspend().catch(fail);
}

function start(sounding: Sounding, at: number) {
  if (!context || !entrance) return;
  const { speed, force } = finger.peek();
  const options = { model: sounding.model, gain: at, bands: BANDS, ...(audible.peek() ? { pitch: AUDIBLE } : {}) };
  const made = new HtexNode(context, sounding.texture, options);
  const fader = new GainNode(context, { gain: leaving.length > 0 ? 0 : 1 });
  node = made;
  made.speed.value = speed;
  made.force.value = force;
  made.addEventListener("error", (event) => fail((event as Event & { error: Error }).error));
  made.onenvelope = (told) => {
    if (made !== node) return;
    if (leaving.length > 0) enter(fader);
    envelope.value = { level: told.level, centroid: told.centroid };
  };
  made.connect(fader).connect(entrance);
}

/** Fades in a node that sounds by now, and ends the earlier nodes. */
function enter({ gain: part }: GainNode) {
  const now = context?.currentTime ?? 0;
  part.setValueAtTime(0, now);
  part.linearRampToValueAtTime(1, now + ENTERS_S);
  for (const old of leaving) old.stop();
  leaving = [];
}

/** Plays a texture instead of what plays now, without a step. */
function sounds(sounding: Sounding, piece: Texture) {
  const at = sounding.own ? usualGain(sounding.texture, sounding.model) : sounding.gain ?? gain;
  const isNew = !node;
  if (isNew) start(sounding, at);
  if (sounding.loop) node?.load(sounding.loop, { gain: at }).catch(fail);
  else if (!isNew) node?.load(sounding.texture, { model: sounding.model, gain: at, bands: BANDS }).catch(fail);
  playing = piece;
}

/** Starts what follows the state; once. */
export function run() {
  effect(() => {
    const [now, tries, document] = [texture.value, tried.value, present.value];
    if (!isReady.value) return;
    gain = origin.value?.gain ?? 1;
    if (tries) sounds(tries, tries.texture);
    else if (now && document) {
      const model = now.models.includes(document.model) ? document.model : now.models[0] ?? "";
      sounds({ texture: now, model }, now);
    }
  });
  effect(() => {
    const { speed, force, position, x, y } = finger.value;
    attend(force > 0);
    if (!node) return;
    node.speed.value = speed;
    node.force.value = force;
    // Of this page's built-in models, only the friction map follows the place. The others follow
    // only speed and force.
    if (playing?.hasModules) node.position = position;
    if (playing?.hasModules || playing?.models.includes("org.htex.map")) node.place = { x: x * padSize.width, y: y * padSize.height };
  });
  effect(() => {
    if (!isReady.value || !context || !output) return;
    const loud = sound.value === "on" ? volume.value ** 2 : 0;
    output.gain.setTargetAtTime(loud, context.currentTime, 0.01);
  });
  effect(() => {
    void audible.value;
    if (!node || !playing) return;
    // A node keeps its pitch, so this takes a new one. The old node sounds until the new one does.
    leaving.push(node);
    node = null;
    const document = present.peek();
    const sounding = tried.peek() ?? { texture: playing, model: document?.model ?? "" };
    sounds(sounding, playing);
  });
}

/** Whether sound can go to a chosen output here. */
export function canChooseOutput() {
  return context !== null && "setSinkId" in context;
}

/** Sends the sound to an output, from silence. */
export async function sendTo(device: string) {
  if (!context || !output) return;
  volume.value = 0;
  output.gain.setValueAtTime(0, context.currentTime);
  await (context as AudioContext & { setSinkId(id: string): Promise<void> }).setSinkId(device);
}
