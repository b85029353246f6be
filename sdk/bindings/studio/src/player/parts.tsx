// The pad and the controls of a page that plays one texture at a time, and what such a page contains.

import { computed, effect, signal } from "@preact/signals";
import { useMemo } from "preact/hooks";
import type { Texture } from "htex";

import { near, recordedRange } from "../conditions.ts";
import { coverageText } from "../coverage-text.ts";
import { finger, isPiloted, pilot, pilotForce, pilotSpeed, setPilot, sliders } from "../motion.ts";
import { LampHandle } from "../parts/lamp.tsx";
import { PadSurface } from "../parts/pad-surface.tsx";
import { Slider } from "../parts/slider.tsx";
import { failure, isAwake, volume } from "./sound.ts";

/** The text of an element of the page. */
export const textOf = (id: string) => document.getElementById(id)?.textContent ?? "";

/** The bytes that an element of the page contains as base64. */
export const bytesOf = (id: string) => Uint8Array.from(atob(textOf(id)), (letter) => letter.charCodeAt(0));

export async function inflated(bytes: Uint8Array<ArrayBuffer>) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

/** The pressing itself wakes the sound, by its listeners. */
const wake = () => {};

/** Milliseconds between two sentences about the motion. */
const TOLD_MS = 150;

/** The motion that is compared with the recorded range: the finger's, or the one of the sliders. */
const judged = signal(sliders.peek());
let timer = 0;
effect(() => {
  void [finger.value, sliders.value];
  timer ||= window.setTimeout(() => {
    timer = 0;
    const { speed, force } = finger.peek();
    judged.value = force > 0 && !isPiloted() ? { speed, force } : sliders.peek();
  }, TOLD_MS);
});

export function Pad({ texture, model }: { texture: Texture; model: string }) {
  const voice = useMemo(() => texture.voice({ model }), [texture, model]);
  const shown = useMemo(() => ({ sounding: signal({ texture, model }), pictured: computed(() => near(texture, model, sliders.value).place) }), [texture, model]);
  const told = voice.coverage(judged.value);
  const isOutside = told.kind === "outside";
  return (
    <>
      <PadSurface name={texture.name} isOutside={isOutside} shown={shown} wake={wake}>
        {!isAwake.value && <p class="pad-hint">Press and slide</p>}
        <LampHandle />
      </PadSurface>
      <p class={isOutside ? "coverage outside" : "coverage"} role="status">
        {failure.value ?? coverageText(told)}
      </p>
    </>
  );
}

export function Controls({ texture, model }: { texture: Texture; model: string }) {
  const recorded = useMemo(() => recordedRange(texture, model), [texture, model]);
  const slides = pilot.value !== "hand";
  return (
    <div class="player-controls">
      <button class="toggle" aria-pressed={slides} onClick={() => setPilot(slides ? "hand" : "to-and-fro")}>
        Back and forth
      </button>
      <Slider label="Speed" unit="mm/s" min={5} max={400} value={pilotSpeed.value} isLog digits={0} recorded={recorded.speed} onValue={(value) => (pilotSpeed.value = value)} />
      <Slider label="Force" unit="N" min={0.05} max={3} value={pilotForce.value} isLog digits={2} recorded={recorded.force} onValue={(value) => (pilotForce.value = value)} />
      <Slider label="Volume" min={0} max={1} step={0.01} value={volume.value} onValue={(value) => (volume.value = value)} />
      <p class="small soft">
        {(recorded.speed || recorded.force) && "The marks show the recorded speeds and forces. "}
        Use headphones, because small loudspeakers play no low frequencies.
      </p>
    </div>
  );
}
