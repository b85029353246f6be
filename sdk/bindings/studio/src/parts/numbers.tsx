// The parameters as numbers, folded away: sliders over their usual ranges.

import type { ModelField } from "htex";

import { models } from "../author.ts";
import { texture } from "../state.ts";
import { endGesture, model, setParameter, shown, spec } from "../shaping/session.ts";
import { Slider } from "./slider.tsx";

function digitsOf(value: number) {
  if (value === 0) return 2;
  return Math.min(Math.max(2 - Math.floor(Math.log10(Math.abs(value))), 0), 4);
}

/** The range of a slider: the usual one, widened to what is there. */
function rangeOf({ min, max, usual }: ModelField, value: number) {
  const low = Math.min(usual?.min ?? min, value);
  const high = Math.max(usual?.max ?? max, value);
  return { min: low, max: high, isLog: usual?.scale === "log" && low > 0 };
}

function Scalar({ field, value }: { field: ModelField; value: number }) {
  const unit = field.unit === "1" ? "" : field.unit;
  return (
    <div title={`${field.description} From ${field.min} to ${field.max}${unit && ` ${unit}`}.`}>
      <Slider label={field.name.replaceAll("_", " ")} unit={unit} digits={digitsOf(value)} value={value} {...rangeOf(field, value)} onValue={(next) => setParameter(field.name, null, next, `number ${field.name}`)} onSettled={endGesture} />
    </div>
  );
}

function List({ field, values }: { field: ModelField; values: readonly number[] }) {
  const set = (index: number, text: string) => {
    const next = Number(text);
    if (text !== "" && Number.isFinite(next)) setParameter(field.name, index, Math.min(Math.max(next, field.min), field.max), `number ${field.name} ${index}`);
  };
  return (
    <fieldset class="number-list">
      <legend title={field.description}>
        {field.name.replaceAll("_", " ")} {field.unit === "1" ? "" : `(${field.unit})`}
      </legend>
      {values.map((value, i) => (
        // Taken once it is whole; `onChange` would be called at every key, as React does.
        <input key={i} type="number" step="any" value={Number(value.toPrecision(5))} aria-label={`${field.name} ${i + 1}`} onChangeCapture={(event) => (set(i, event.currentTarget.value), endGesture())} />
      ))}
    </fieldset>
  );
}

export function Numbers() {
  const descriptor = models.value.find((one) => one.id === model.value);
  const point = spec.value?.points[shown.value];
  return (
    <details class="panel">
      <summary>
        <h2>Numbers</h2>
      </summary>
      <div class="stack">
        {descriptor?.fields.map((field) => {
          const value = point?.parameters[field.name];
          if (value === undefined) return null;
          return Array.isArray(value) ? <List key={field.name} field={field} values={value} /> : <Scalar key={field.name} field={field} value={value as number} />;
        })}
        {point && (
          <p class="small soft">
            Level (RMS): {Number((point.level * 1e3).toPrecision(4))} m{texture.value?.unit}. Numbers change only the displayed condition.
          </p>
        )}
      </div>
    </details>
  );
}
