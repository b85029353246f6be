// Shape: the spectrum drawn on, four macros, and the numbers.

import { useMemo } from "preact/hooks";

import { author, models, theAuthor } from "../author.ts";
import { Numbers } from "../parts/numbers.tsx";
import { Slider } from "../parts/slider.tsx";
import { Spectrum } from "../parts/spectrum.tsx";
import type { Curve } from "../parts/spectrum-painter.ts";
import { reference } from "../reference.ts";
import { motion, played, shownMotion } from "../shadow.ts";
import { BANDS } from "../shaping/bands.ts";
import type { Macros } from "../shaping/shaper.ts";
import { shaperOf } from "../shaping/shapers.ts";
import { addHandle, drawHandles, endGesture, handles, macros, model, moveHandle, redraw, removeHandle, setMacro, shown, spec } from "../shaping/session.ts";
import { pointDecibels, toDecibels } from "../shaping/spec.ts";
import { choose, fail, present, texture } from "../state.ts";

const HZ = Float64Array.from({ length: 240 }, (_, i) => 20 * 50 ** (i / 239));

const MACROS: { id: keyof Macros; name: string; low: string; high: string }[] = [
  { id: "rougher", name: "Rougher", low: "smoother", high: "rougher: more below 100 Hz" },
  { id: "brighter", name: "Brighter", low: "duller", high: "brighter: more above 300 Hz" },
  { id: "peak", name: "Peak", low: "an octave lower", high: "an octave higher" },
  { id: "level", name: "Level", low: "14 dB weaker", high: "14 dB stronger" },
];

/** How each model is drawn on. */
const HINTS: Record<string, string> = {
  "org.htex.bands": "Drag the bars up and down; draw across them in one go.",
  "org.htex.sslope": "Drag the peak, and the two slopes up and down.",
  "org.htex.sbeta": "Drag the rise and the fall up and down.",
  "org.htex.speak": "Drag the peaks. Double click adds one, Delete removes the chosen one.",
};

export const nameOf = (id: string) => models.value.find((one) => one.id === id)?.name ?? id.replace("org.htex.", "");

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
      {has("threshold") && <li class="legend-threshold">a single sinusoid in here is not felt</li>}
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
      <p class="small soft">They start from where the last other edit ended, for all models alike.</p>
    </div>
  );
}

export function Shape() {
  if (!author.value) theAuthor().catch(fail);
  const curves = useCurves();
  const shaper = model.value ? shaperOf(model.value) : undefined;
  const isBands = model.value === BANDS;
  const point = spec.value?.points[shown.value];
  return (
    <section aria-labelledby="shape-title">
      <header class="screen-head">
        <div>
          <h1 id="shape-title">Shape</h1>
          <p>{HINTS[model.value ?? ""] ?? "The numbers of this model cannot be drawn on."} Press To and fro, and it slides meanwhile.</p>
        </div>
        <Models />
      </header>
      <div class="panel">
        <Legend curves={curves} />
        <Spectrum
          curves={curves}
          live={live}
          watch={() => [motion.value, texture.value]}
          handles={handles.value}
          hasBars={isBands}
          label={`Spectrum of ${present.value?.name ?? "the texture"}. Left and right choose a handle, up and down raise and lower it${shaper?.add ? ", with Shift left and right move it, Delete removes it" : ", with Shift left and right move it where it can be"}.`}
          onMove={(handle, hz, db) => moveHandle(handle, hz, db, `drag ${gesture}`)}
          onDraw={(drawn) => drawHandles(drawn, `drag ${gesture}`)}
          onSettle={settle}
          onAdd={shaper?.add ? addHandle : undefined}
          onRemove={shaper?.remove ? removeHandle : undefined}
        />
        <div class="row between">
          <span class="small soft">
            dB re 1 m{texture.value?.unit} · 20–1000 Hz
            {point && point.speed !== null && ` · shown at ${point.speed.toFixed(0)} mm/s${point.force === null ? "" : `, ${point.force.toFixed(2)} N`}; ${spec.value?.points.length === 1 ? "the only condition" : `all ${spec.value?.points.length} conditions change alike`}`}
          </span>
          <span class="row">
            {shaper?.add && (
              <button class="button" onClick={() => addHandle(200, (handles.value[0]?.db ?? 0) - 3)}>
                Add a peak
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
