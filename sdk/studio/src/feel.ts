// Motors that follow the level of what plays: a gamepad's, a phone's.

import { effect, signal } from "@preact/signals";

import { envelope, playingNode } from "./engine.ts";

export type Feel = "none" | "gamepad" | "phone";

export const feelOn = signal<Feel>("none");

/** Milliseconds that a motor is told to run at a time. */
const PULSE_MS = 60;
/** Pitch above which the small motor of a gamepad takes over, Hz. */
const SMALL_MOTOR_HZ = 180;

let last = 0;

function pads() {
  return "getGamepads" in navigator ? [...navigator.getGamepads()].filter((pad) => pad !== null) : [];
}

export function gamepadThere() {
  return pads().some((pad) => pad.vibrationActuator);
}

/** The level relative to that of full scale at which the texture plays, 0 to 1. */
function strength(level: number) {
  const gain = playingNode()?.gain.value ?? 0;
  return Math.min(3 * gain * level, 1);
}

function rumble(level: number, centroid: number) {
  const part = strength(level);
  const high = Math.min(Math.max((centroid - 60) / (2 * SMALL_MOTOR_HZ), 0), 1);
  for (const pad of pads()) {
    const effects = { duration: PULSE_MS * 2, strongMagnitude: part * (1 - high), weakMagnitude: part * high };
    pad.vibrationActuator?.playEffect("dual-rumble", effects).catch(() => {});
  }
}

function pulse(level: number) {
  const part = strength(level);
  if (part > 0.05) navigator.vibrate(Math.round(PULSE_MS * part));
}

effect(() => {
  const { level, centroid } = envelope.value;
  const way = feelOn.value;
  const now = performance.now();
  if (way === "none" || now - last < PULSE_MS) return;
  last = now;
  if (way === "gamepad") rumble(level, centroid);
  else pulse(level);
});

export function startFeeling(way: Feel) {
  feelOn.value = way;
}

/** Outputs of sound that the browser names. */
export const outputs = {
  list: signal<{ id: string; name: string }[]>([]),
  async refresh() {
    const all = (await navigator.mediaDevices?.enumerateDevices?.().catch(() => [])) ?? [];
    const named = all.filter(({ kind, deviceId }) => kind === "audiooutput" && deviceId !== "" && deviceId !== "default");
    this.list.value = named.map(({ deviceId, label }, i) => ({ id: deviceId, name: label || `Output ${i + 1}` }));
  },
};
