// Shape: the spectrum drawn on, four macros, and the numbers.

import { useMemo, useState } from "preact/hooks";

import { author, nameOf, theAuthor } from "../author.ts";
import { KeepsOne } from "../parts/keeps-one.tsx";
import { Numbers } from "../parts/numbers.tsx";
import { Slider } from "../parts/slider.tsx";
import { describe, Spectrum } from "../parts/spectrum.tsx";
import type { Curve } from "../parts/spectrum-painter.ts";
import { reference } from "../reference.ts";
import { motion, played, shownMotion } from "../shadow.ts";
import { BANDS } from "../shaping/bands.ts";
import type { Macros } from "../shaping/shaper.ts";
import { shaperOf } from "../shaping/shapers.ts";
import { addHandle, drawHandles, endGesture, handles, macros, model, moveHandle, redraw, removeHandle, setMacro, shown, spec } from "../shaping/session.ts";
import { pointDecibels, toDecibels } from "../shaping/spec.ts";
import { choose, fail, present, texture } from "../state.ts";
import { isTouch } from "../theme.ts";

const HZ = Float64Array.from({ length: 240 }, (_, i) => 20 * 50 ** (i / 239));

const MACROS: { id: keyof Macros; name: string; low: string; high: string }[] = [
  { id: "rougher", name: "Rougher", low: "smoother", high: "rougher: more below 100 Hz" },
  { id: "brighter", name: "Brighter", low: "duller", high: "brighter: more above 300 Hz" },
  { id: "peak", name: "Peak", low: "an octave lower", high: "an octave higher" },
  { id: "level", name: "Level", low: "14 dB weaker", high: "14 dB stronger" },
];

/** How to draw on each model: with a mouse, and by touch if that differs. */
const HINTS: Record<string, readonly [string, string?]> = {
  "org.htex.bands": ["Drag the bars up and down, or draw across them in one stroke.", "Drag the tops of the bars up and down, or draw across them in one stroke."],
  "org.htex.sslope": ["Drag the peak. Drag the two slopes up and down."],
  "org.htex.sbeta": ["Drag the two handles, the rise and the fall, up and down."],
  "org.htex.speak": ["Drag the peaks. Double-click to add one. Press Delete to remove the chosen one.", "Drag the peaks. Tap one to choose it. The buttons below add and remove peaks."],
};

function Hint() {
  const [byMouse, byTouch] = HINTS[model.value ?? ""] ?? ["You cannot draw on this model. Redraw it as bands, or use the sliders."];
  return (
    <p>
      {isTouch.value ? byTouch ?? byMouse : byMouse} Press <em>Back and forth</em> to hear your changes as you draw.
    </p>
  );
}

/** The gesture that is going on; each begins with another number. */
let gesture = 0;

function settle() {
  gesture += 1;
  endGesture();
}

function Models() {
  return (
    <div class="segments models" role="group" aria-label="Model">
      {texture.value?.models.map((id) => (
        <button key={id} aria-pressed={model.value === id} onClick={() => choose(id)}>
          {nameOf(id)}
        </button>
      ))}
    </div>
  );
}

function useCurves(): Curve[] {
  const [now, what, before] = [texture.value, spec.value, reference.value];
  const point = what?.points[shown.value];
  return useMemo(() => {
    if (!now || !what || !point) return [];
    const curves: Curve[] = [];
    const threshold = reference.peek()?.threshold;
    if (threshold) curves.push({ style: "threshold", ...threshold });
    if (before?.recorded) curves.push({ style: "recording", ...before.recorded });
    else if (before?.opened) curves.push({ style: "before", ...before.opened });
    curves.push({ style: "model", hz: HZ, db: pointDecibels(now, what.model, point, HZ) });
    return curves;
  }, [now, what, point, before]);
}

function live(): Curve | null {
  const magnitude = played(HZ);
  return magnitude && { style: "played", hz: HZ, db: Array.from(magnitude, toDecibels) };
}

function Legend({ curves }: { curves: readonly Curve[] }) {
  const has = (style: Curve["style"]) => curves.some((curve) => curve.style === style);
  return (
    <ul class="legend">
      <li class="legend-played">plays at {shownMotion.value.speed.toFixed(0)} mm/s, {shownMotion.value.force.toFixed(2)} N</li>
      <li class="legend-model">{model.value ? nameOf(model.value) : "model"}</li>
      {has("recording") && <li class="legend-recording">recording</li>}
      {has("before") && <li class="legend-before">as it was opened</li>}
      {has("threshold") && <li class="legend-threshold">a single frequency in here is too weak to feel</li>}
    </ul>
  );
}

function MacroSliders() {
  return (
    <div class="panel stack">
      <h2>Macros</h2>
      {MACROS.map(({ id, name, low, high }) => (
        <div key={id} title={`${low} to ${high}`}>
          <Slider label={name} min={-1} max={1} step={0.02} digits={2} value={macros.value[id]} disabled={!author.value} onValue={(value) => setMacro(id, value)} onSettled={endGesture} />
        </div>
      ))}
      <p class="small soft">These sliders work with every model. They start at 0 again after any other edit.</p>
    </div>
  );
}

export function Shape() {
  if (!author.value) theAuthor().catch(fail);
  const curves = useCurves();
  const shaper = model.value ? shaperOf(model.value) : undefined;
  const isBands = model.value === BANDS;
  const point = spec.value?.points[shown.value];
  const [wanted, select] = useState(0);
  const selected = Math.min(wanted, Math.max(handles.value.length - 1, 0));
  const handle = handles.value[selected];
  return (
    <section aria-labelledby="shape-title">
      <header class="screen-head">
        <div>
          <h1 id="shape-title">Shape</h1>
          <Hint />
        </div>
        <Models />
      </header>
      <div class="panel drawing">
        <KeepsOne />
        <Legend curves={curves} />
        <Spectrum
          curves={curves}
          live={live}
          watch={() => [motion.value, texture.value]}
          handles={handles.value}
          selected={selected}
          onSelect={select}
          hasBars={isBands}
          label={`Spectrum of ${present.value?.name ?? "the texture"}.${isTouch.value ? "" : ` Left and right choose a handle. Up and down, Page Up and Page Down raise and lower it. Shift with left and right moves it${shaper?.add ? ", and Delete removes it" : " if it can move"}.`}`}
          onMove={(handle, hz, db) => moveHandle(handle, hz, db, `drag ${gesture}`)}
          onDraw={(drawn) => drawHandles(drawn, `drag ${gesture}`)}
          onSettle={settle}
          onAdd={shaper?.add ? addHandle : undefined}
          onRemove={shaper?.remove ? removeHandle : undefined}
        />
        <div class="row between">
          <span class="small soft">
            {handle && <span class="spectrum-told">{describe(handle)} · </span>}
            dB re 1 m{texture.value?.unit} · 20–1000 Hz
            {point && point.speed !== null && ` · displayed at ${point.speed.toFixed(0)} mm/s${point.force === null ? "" : `, ${point.force.toFixed(2)} N`}; ${spec.value?.points.length === 1 ? "the only condition" : `all ${spec.value?.points.length} conditions change together`}`}
          </span>
          <span class="row">
            {shaper?.add && (
              <button class="button" onClick={() => addHandle(200, (handles.value[0]?.db ?? 0) - 3)}>
                Add a peak
              </button>
            )}
            {shaper?.remove && handle && (
              <button class="button" disabled={handles.value.length < 2} onClick={() => removeHandle(selected)}>
                Remove {handle.name.toLowerCase()}
              </button>
            )}
            {!isBands && (
              <button class={shaper ? "button" : "button strong"} onClick={() => redraw().catch(fail)}>
                Redraw as bands
              </button>
            )}
          </span>
        </div>
      </div>
      <div class="columns below">
        <MacroSliders />
        <Numbers />
      </div>
    </section>
  );
}
