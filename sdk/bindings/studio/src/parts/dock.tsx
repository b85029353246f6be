// The pad with its sliders: how fast, how hard, and who moves the finger.

import { signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { audible, heard, isRunning, sound, wake } from "../engine.ts";
import { pilot, pilotForce, pilotSpeed, setPilot, stroke, type Pilot } from "../motion.ts";
import { coverage, shownFinger } from "../shadow.ts";
import { Icon } from "./icons.tsx";
import { Pad } from "./pad.tsx";
import { Slider } from "./slider.tsx";

/** Whether a phone shows the sliders of the motion; where there is room they are always there. */
const hasControls = signal(false);

const PILOTS: { id: Pilot; name: string }[] = [
  { id: "hand", name: "Hand" },
  { id: "steady", name: "Steady" },
  { id: "to-and-fro", name: "To and fro" },
  { id: "circle", name: "Circle" },
  { id: "stroke", name: "My stroke" },
];

function Readings() {
  const { speed, force } = shownFinger.value;
  const { inside, text } = coverage.value;
  return (
    <>
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
        <div>
          <dt>Sound</dt>
          <dd>
            <Meter />
          </dd>
        </div>
      </dl>
      <button class="toggle dock-more" aria-expanded={hasControls.value} onClick={() => (hasControls.value = !hasControls.value)}>
        Motion
      </button>
      <p class={inside ? "coverage" : "coverage outside"}>
        {!inside && <Icon name="warn" />}
        {text}
      </p>
    </>
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

export function Dock() {
  return (
    <aside class="dock" aria-label="Pad">
      <Pad />
      <Readings />
      <div class={hasControls.value ? "dock-controls" : "dock-controls folded"}>
        <Pilots />
        <Slider label="Speed" unit="mm/s" min={5} max={400} value={pilotSpeed.value} isLog digits={0} onValue={(value) => (pilotSpeed.value = value)} />
        <Slider label="Force" unit="N" min={0.05} max={3} value={pilotForce.value} isLog digits={2} onValue={(value) => (pilotForce.value = value)} />
        <p class="hint">
          {sound.value === "off" ? "Sound begins with your first press. " : ""}
          {audible.value ? "Audible ×4: frequencies are four times as high, which is not what a finger feels." : "Headphones are best: small loudspeakers have no low frequencies."} Esc silences.
        </p>
      </div>
    </aside>
  );
}
