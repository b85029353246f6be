// Motors that follow the level of what plays: a gamepad's, a phone's.

import { effect, signal } from "@preact/signals";
import { dualRumble } from "htex";

import { envelope, playingNode } from "./engine.ts";
import { isTouch } from "./theme.ts";

export type Feel = "none" | "gamepad" | "phone";

export const feelOn = signal<Feel>("none");

/** Milliseconds that a motor is told to run at a time. */
const PULSE_MS = 60;
/** Strength of a level of full scale at which motors run at full strength: a third. */
const STRENGTH = 3;

let last = 0;

function pads() {
  return "getGamepads" in navigator ? [...navigator.getGamepads()].filter((pad) => pad !== null) : [];
}

export function gamepadThere() {
  return pads().some((pad) => pad.vibrationActuator);
}

/**
 * Whether this device has its own motor. No browser tells, and desktop browsers offer the function
 * without a motor, so only phones count.
 */
export function hasMotor() {
  const { userAgentData } = navigator as Navigator & { userAgentData?: { mobile: boolean } };
  return "vibrate" in navigator && (userAgentData?.mobile ?? isTouch.peek());
}

/** The strengths of two motors for what plays. */
function strengths(told: { level: number; centroid: number }) {
  return dualRumble(told, { gain: STRENGTH * (playingNode()?.gain.value ?? 0), duration: PULSE_MS * 2 });
}

function rumble(told: { level: number; centroid: number }) {
  for (const pad of pads()) pad.vibrationActuator?.playEffect("dual-rumble", strengths(told)).catch(() => {});
}

function pulse(told: { level: number; centroid: number }) {
  const { strongMagnitude, weakMagnitude } = strengths(told);
  const part = strongMagnitude + weakMagnitude;
  if (part > 0.05) navigator.vibrate(Math.round(PULSE_MS * part));
}

effect(() => {
  const told = envelope.value;
  const way = feelOn.value;
  const now = performance.now();
  if (way === "none" || now - last < PULSE_MS) return;
  last = now;
  if (way === "gamepad") rumble(told);
  else pulse(told);
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
