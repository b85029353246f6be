// A player of one texture, in one file: the library and the texture are in the page, compressed and as base64.

import { computed, effect, signal } from "@preact/signals";
import { render } from "preact";
import { useMemo } from "preact/hooks";
import { open, setLibrary, type Texture } from "htex";

import "../styles/base.css";
import "../styles/frame.css";
import "../styles/controls.css";
import "../styles/knobs.css";
import "../styles/lamp.css";
import "../styles/windows.css";
import "./player.css";
import { near, recordedRange } from "../conditions.ts";
import { coverageText } from "../coverage-text.ts";
import { slideGhost } from "../ghost.ts";
import { toLink } from "../link.ts";
import { finger, isPiloted, pilot, pilotForce, pilotSpeed, rest, setPilot, sliders } from "../motion.ts";
import { LampHandle } from "../parts/lamp.tsx";
import { Name } from "../parts/name.tsx";
import { PadSurface } from "../parts/pad-surface.tsx";
import { Slider } from "../parts/slider.tsx";
import type { PlayerOptions } from "./options.ts";
import { failure, isAwake, startSound, volume } from "./sound.ts";

const textOf = (id: string) => document.getElementById(id)?.textContent ?? "";

const bytesOf = (id: string) => Uint8Array.from(atob(textOf(id)), (letter) => letter.charCodeAt(0));

async function inflated(bytes: Uint8Array<ArrayBuffer>) {
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

function Pad({ texture, model }: { texture: Texture; model: string }) {
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

function Controls({ texture, model }: { texture: Texture; model: string }) {
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

function About({ texture: { name, manifest } }: { texture: Texture }) {
  const { author, license, description } = manifest;
  return (
    <header>
      <h1>
        <Name>{name}</Name>
      </h1>
      {(author || license) && (
        <p class="soft">
          {author && (
            <>
              By <Name>{author}</Name>.{" "}
            </>
          )}
          {license && <>Licence: {license}.</>}
        </p>
      )}
      {description && (
        <p>
          <Name>{description}</Name>
        </p>
      )}
    </header>
  );
}

function Player({ texture, bytes, options: { model, file, studio } }: { texture: Texture; bytes: Uint8Array<ArrayBuffer>; options: PlayerOptions }) {
  const address = useMemo(() => URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" })), [bytes]);
  return (
    <main class="player">
      <About texture={texture} />
      <Pad texture={texture} model={model} />
      <Controls texture={texture} model={model} />
      <footer>
        <a class="button" href={address} download={file}>
          Save the texture
        </a>
        {studio && (
          <a class="button" href={toLink(bytes, studio)} target="_blank" rel="noopener">
            Open in the studio
          </a>
        )}
      </footer>
    </main>
  );
}

async function start() {
  setLibrary(await inflated(bytesOf("library")));
  const bytes = bytesOf("texture");
  const texture = await open(bytes);
  const options = JSON.parse(textOf("options")) as PlayerOptions;
  [pilotSpeed.value, pilotForce.value] = [options.speed, options.force];
  const place = document.getElementById("app");
  if (place) render(<Player texture={texture} bytes={bytes} options={options} />, place);
  addEventListener("keydown", (event) => event.key === "Escape" && rest());
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && rest());
  slideGhost(() => isAwake.peek() || finger.peek().force > 0);
  await startSound(texture, options.model);
  document.documentElement.dataset["ready"] = "yes";
}

start().catch((error) => {
  failure.value = String(error.message ?? error);
  document.getElementById("app")?.append(failure.value);
});
