// Shape: the curve, to be drawn on, and the numbers.

import { signal } from "@preact/signals";
import { useMemo, useState } from "preact/hooks";

import { author, nameOf, theAuthor } from "../author.ts";
import { titleOf, wordsOf } from "../model-words.ts";
import { KeepsOne } from "../parts/keeps-one.tsx";
import { Numbers } from "../parts/numbers.tsx";
import { describe, Spectrum } from "../parts/spectrum.tsx";
import type { Curve } from "../parts/spectrum-painter.ts";
import { HIGH_HZ, LOW_HZ } from "../parts/spectrum-scale.ts";
import { reference } from "../reference.ts";
import { motion, played, shownMotion } from "../shadow.ts";
import { BANDS } from "../shaping/bands.ts";
import { limits, setRange, toggleLock } from "../shaping/limits.ts";
import { shaperOf } from "../shaping/shapers.ts";
import { addHandle, drawHandles, endGesture, handles, model, moveHandle, redraw, removeHandle, shown, spec } from "../shaping/session.ts";
import { clamp, pointDecibels, toDecibels } from "../shaping/spec.ts";
import { choose, fail, present, texture } from "../state.ts";
import { isTouch } from "../theme.ts";

const HZ = Float64Array.from({ length: 240 }, (_, i) => 20 * 50 ** (i / 239));

/** How to draw on each model: with a mouse, and by touch if that differs. */
const HINTS: Record<string, readonly [string, string?]> = {
  "org.htex.bands": ["Drag the bars up and down, or draw across them in one stroke.", "Drag the tops of the bars up and down, or draw across them in one stroke."],
  "org.htex.sslope": ["Drag the peak. Drag the two slopes up and down."],
  "org.htex.sbeta": ["Drag the two handles, the rise and the fall, up and down."],
  "org.htex.speak": ["Drag the peaks. Double-click to add one. Press Delete to remove the chosen one.", "Drag the peaks. Tap one to choose it. The buttons below add and remove peaks."],
};

function Hint() {
  const [byMouse, byTouch] = HINTS[model.value ?? ""] ?? ["You cannot draw on this curve. Redraw it as a free curve, or turn the knobs."];
  return (
    <p class="small soft">
      {isTouch.value ? byTouch ?? byMouse : byMouse} Press <em>Back and forth</em> to hear your changes as you draw.
      {!isTouch.value && <> Hold <kbd>Shift</kbd> for fine steps. Drag along the frequencies to change only a range.</>}
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
          {wordsOf(id)}{" "}
          {wordsOf(id) !== nameOf(id) && <small>{nameOf(id)}</small>}
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
      <li class="legend-model">{model.value ? titleOf(model.value) : "curve"}</li>
      {has("recording") && <li class="legend-recording">recording</li>}
      {has("before") && <li class="legend-before">as it was opened</li>}
      {has("threshold") && <li class="legend-threshold">a single frequency in here is too weak to feel</li>}
    </ul>
  );
}

/** The range of frequencies that may change, in numbers. It can also be dragged on the axis. */
function RangeFields() {
  const [low, high] = limits.value.range ?? [LOW_HZ, HIGH_HZ];
  const set = (from: number, to: number) => {
    const [start, end] = [clamp(from, LOW_HZ, HIGH_HZ), clamp(to, LOW_HZ, HIGH_HZ)];
    if (start < end) setRange(start === LOW_HZ && end === HIGH_HZ ? null : [start, end]);
  };
  return (
    <div class="row range" role="group" aria-label="Frequencies that may change">
      <span class="small">Change only</span>
      <RangeField label="From, Hz" value={low} onValue={(value) => set(value, high)} />
      <span class="small">to</span>
      <RangeField label="To, Hz" value={high} onValue={(value) => set(low, value)} />
      <span class="small">Hz</span>
      {limits.value.range && (
        <button class="button" onClick={() => setRange(null)}>
          All frequencies
        </button>
      )}
      {limits.value.range && !shaperOf(model.value ?? "")?.isLocal && <p class="small soft">This curve changes only as a whole. The next turn of a knob redraws it as a free curve.</p>}
    </div>
  );
}

function RangeField({ label, value, onValue }: { label: string; value: number; onValue: (value: number) => void }) {
  // Taken once it is whole; `onChange` would be called at every key, as React does.
  return <input type="number" min={LOW_HZ} max={HIGH_HZ} step="any" aria-label={label} value={Math.round(value)} onChangeCapture={(event) => Number.isFinite(event.currentTarget.valueAsNumber) && onValue(event.currentTarget.valueAsNumber)} />;
}

/** Whether the curve is shown; the knobs work without it. */
const isOpen = signal(true);

/** What can be done with the chosen handle, and with the whole curve. */
function Actions({ selected, onTyping }: { selected: number; onTyping: () => void }) {
  const shaper = model.value ? shaperOf(model.value) : undefined;
  const handle = handles.value[selected];
  const isLocked = limits.value.locked.has(selected);
  return (
    <div class="row">
      {handle && (
        <>
          <button class="button spectrum-told" title="Type a value" onClick={onTyping}>
            {describe(handle)}
          </button>
          <button class="toggle" aria-pressed={isLocked} onClick={() => toggleLock(selected)}>
            Lock {handle.name.toLowerCase()}
          </button>
        </>
      )}
      {shaper?.add && (
        <button class="button" onClick={() => addHandle(200, (handles.value[0]?.db ?? 0) - 3)}>
          Add a peak
        </button>
      )}
      {shaper?.remove && handle && (
        <button class="button" disabled={handles.value.length < 2 || isLocked} onClick={() => removeHandle(selected)}>
          Remove {handle.name.toLowerCase()}
        </button>
      )}
      {model.value !== BANDS && (
        <button class={shaper ? "button" : "button strong"} onClick={() => redraw().catch(fail)}>
          Redraw as a free curve
        </button>
      )}
    </div>
  );
}

function Drawing() {
  const curves = useCurves();
  const shaper = model.value ? shaperOf(model.value) : undefined;
  const point = spec.value?.points[shown.value];
  const [wanted, select] = useState(0);
  const [isTyping, type] = useState(false);
  const selected = Math.min(wanted, Math.max(handles.value.length - 1, 0));
  return (
    <div class="drawing">
      <Models />
      <Spectrum
        curves={curves}
        live={live}
        watch={() => [motion.value, texture.value]}
        handles={handles.value}
        selected={selected}
        onSelect={select}
        hasBars={model.value === BANDS}
        limits={limits.value}
        onLock={toggleLock}
        onRange={setRange}
        isTyping={isTyping}
        onTyping={type}
        label={`Spectrum of ${present.value?.name ?? "the texture"}.${isTouch.value ? "" : ` Left and right choose a handle. Up and down, Page Up and Page Down raise and lower it, with Shift in fine steps. Enter types its value. L locks it. Shift with left and right moves it${shaper?.add ? ", and Delete removes it" : " if it can move"}.`}`}
        onMove={(handle, hz, db) => moveHandle(handle, hz, db, `drag ${gesture}`)}
        onDraw={(drawn) => drawHandles(drawn, `drag ${gesture}`)}
        onSettle={settle}
        onAdd={shaper?.add ? addHandle : undefined}
        onRemove={shaper?.remove ? removeHandle : undefined}
      />
      <Legend curves={curves} />
      <Actions selected={selected} onTyping={() => type(true)} />
      <RangeFields />
      <Hint />
      <KeepsOne />
      <p class="small soft">
        dB re 1 m{texture.value?.unit} · 20–1000 Hz
        {point && point.speed !== null && ` · displayed at ${point.speed.toFixed(0)} mm/s${point.force === null ? "" : `, ${point.force.toFixed(2)} N`}; ${spec.value?.points.length === 1 ? "the only condition" : `all ${spec.value?.points.length} conditions change together`}`}
      </p>
    </div>
  );
}

export function Shape() {
  if (!author.value) theAuthor().catch(fail);
  return (
    <section aria-labelledby="shape-title">
      <header class="screen-head">
        <div>
          <h1 id="shape-title">Shape</h1>
          <p>{isTouch.value ? "Turn the knobs at the pad, or open the curve and draw on it." : "Turn the knobs beside the pad, or open the curve and draw on it."}</p>
        </div>
      </header>
      <details class="panel drawer" open={isOpen.value} onToggle={(event) => (isOpen.value = event.currentTarget.open)}>
        <summary>
          <h2>Curve</h2> {model.value && <span class="soft">{titleOf(model.value)}</span>}
        </summary>
        {isOpen.value && <Drawing />}
      </details>
      <div class="below">
        <Numbers />
      </div>
    </section>
  );
}
