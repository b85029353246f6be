// The pad with its sliders: how fast, how hard, and who moves the finger.

import { computed, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { isBlind } from "../comparing.ts";
import { recordedRange } from "../conditions.ts";
import { audible, heard, isRunning, sound, volume, wake } from "../engine.ts";
import { pilot, pilotForce, pilotSpeed, setPilot, stroke, type Pilot } from "../motion.ts";
import { coverage, shownFinger, sounding } from "../shadow.ts";
import { speak } from "../spoken.ts";
import { isNarrow, isTouch } from "../theme.ts";
import { Hint, hinted } from "./hint.tsx";
import { Icon } from "./icons.tsx";
import { Knobs } from "./knobs.tsx";
import { Pad } from "./pad.tsx";
import { Slider } from "./slider.tsx";
import { Versions } from "./versions.tsx";

/** Whether a small window shows the controls instead of the pad. Large windows show both. */
const hasControls = signal(false);

export const showPad = () => void (hasControls.value = false);

const PILOTS: { id: Pilot; name: string }[] = [
  { id: "hand", name: "Hand" },
  { id: "steady", name: "Steady" },
  { id: "to-and-fro", name: "Back and forth" },
  { id: "circle", name: "Circle" },
  { id: "stroke", name: "My stroke" },
];

function Readings() {
  const { speed, force } = shownFinger.value;
  return (
    <div class="dock-row">
      <dl class="readings">
        <div>
          <dt>Speed</dt>
          <dd>
            <b>{speed.toFixed(0)}</b> mm/s
          </dd>
        </div>
        <div>
          <dt>Force</dt>
          <dd>
            <b>{force.toFixed(2)}</b> N
          </dd>
        </div>
        <div class="only-wide">
          <dt>Sound</dt>
          <dd>
            {isBlind.value ? "hidden" : <Meter />}
          </dd>
        </div>
      </dl>
      {isNarrow.value && <Versions />}
      <div class="dock-quick">
        <button class="toggle dock-back" aria-pressed={pilot.value !== "hand"} onClick={() => (wake(), setPilot(pilot.peek() === "hand" ? "to-and-fro" : "hand"))}>
          Back and forth
        </button>
        <button class="toggle" onClick={() => (hasControls.value = !hasControls.value)}>
          {hasControls.value ? "Pad" : "Controls"}
        </button>
      </div>
    </div>
  );
}

/** Milliseconds outside the recorded range before this is said. Hands often leave it briefly. */
const OUTSIDE_MS = 800;

/** Whether the motion was recorded. A message takes the place of this sentence for a while. */
function Coverage() {
  const { inside, text } = coverage.value;
  useEffect(() => {
    if (inside) return;
    let end = () => {};
    const timer = setTimeout(() => (end = speak(coverage.peek().text)), OUTSIDE_MS);
    return () => {
      clearTimeout(timer);
      end();
    };
  }, [inside]);
  return (
    <p class={inside ? "coverage" : "coverage outside"}>
      {!inside && <Icon name="warn" />}
      {text}
    </p>
  );
}

/** What goes to the loudspeaker, in steps of 6 dB. */
function Meter() {
  const place = useRef<HTMLMeterElement>(null);
  const runs = isRunning.value;
  useEffect(() => {
    if (!runs) return;
    const samples = new Float32Array(1024);
    const timer = setInterval(() => {
      if (!place.current || document.hidden) return;
      const square = heard(samples).reduce((sum, x) => sum + x * x, 0) / samples.length;
      const value = Math.max(0, 1 + (10 * Math.log10(square + 1e-12)) / 60);
      if (Math.abs(place.current.value - value) > 0.005) place.current.value = value;
    }, 100);
    return () => {
      clearInterval(timer);
      if (place.current) place.current.value = 0;
    };
  }, [runs]);
  return <meter ref={place} min={0} max={1} value={0} aria-label="Loudness" />;
}

function Pilots() {
  return (
    <div class="segments" role="group" aria-label="Who moves the finger">
      {PILOTS.map(({ id, name }) => (
        <button
          key={id}
          aria-pressed={pilot.value === id}
          disabled={id === "stroke" && stroke.value.length < 2}
          title={id === "stroke" && stroke.value.length < 2 ? "Draw a stroke on the pad first" : undefined}
          onClick={() => (wake(), setPilot(id))}
        >
          {name}
        </button>
      ))}
    </div>
  );
}

/** The recorded range of what plays; null during a blind test, which must not show it. */
const recorded = computed(() => (sounding.value ? recordedRange(sounding.value.texture, sounding.value.model) : null));

/** The pad with its knobs and controls. The children are the message. */
export function Dock({ children }: { children: preact.ComponentChildren }) {
  const range = recorded.value;
  return (
    <aside class={`dock${hasControls.value ? " controlled" : ""}${hinted.value === "change" ? " hinted" : ""}`} aria-label="Pad">
      <Pad />
      <Readings />
      <div class="sentence">
        {children}
        <Coverage />
        <Hint />
      </div>
      <Knobs />
      <div class="dock-controls">
        <Pilots />
        <Slider label="Speed" unit="mm/s" min={5} max={400} value={pilotSpeed.value} isLog digits={0} recorded={range?.speed} onValue={(value) => (pilotSpeed.value = value)} />
        <Slider label="Force" unit="N" min={0.05} max={3} value={pilotForce.value} isLog digits={2} recorded={range?.force} onValue={(value) => (pilotForce.value = value)} />
        <Slider label="Volume" min={0} max={1} step={0.01} isNarrow value={volume.value} onValue={(value) => (volume.value = value)} />
        <p class="hint">
          {sound.value === "off" ? "Sound begins with your first press. " : ""}
          {(range?.speed || range?.force) && "The marks show the recorded speeds and forces. "}
          {audible.value ? "Audible ×4: all frequencies are four times as high, which is not what a finger feels." : "Use headphones: small loudspeakers play no low frequencies."}
          {!isTouch.value && " Press Esc for silence."}
        </p>
      </div>
    </aside>
  );
}
