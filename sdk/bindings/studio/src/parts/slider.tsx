// A native slider with its number, in equal steps or in equal ratios.

export interface SliderProps {
  label: string;
  unit?: string;
  min: number;
  max: number;
  value: number;
  isLog?: boolean;
  digits?: number;
  step?: number;
  disabled?: boolean;
  /** Whether only narrow windows show it. */
  isNarrow?: boolean;
  /** The recorded range, which is marked. */
  recorded?: readonly [low: number, high: number] | null;
  onValue: (value: number) => void;
  /** The hand or the key has let go. */
  onSettled?: () => void;
}

const STEPS = 1000;
/** How far a value may be from the recorded range and still count as recorded: as much as a slider cannot do better. */
const NEAR = 0.02;
/** Width of the knob of a native slider, px. Its middle does not reach the ends of the track. */
const THUMB = 16;

/** The recorded range below the track. */
function Mark({ from, to }: { from: number; to: number }) {
  const place = (part: number) => `calc(${THUMB / 2 - 2}px + (100% - ${THUMB}px) * ${part})`;
  return <span class="slider-mark" aria-hidden="true" style={{ marginLeft: place(from), width: `calc((100% - ${THUMB}px) * ${to - from} + 4px)` }} />;
}

export function Slider({ label, unit = "", min, max, value, isLog = false, digits = 2, step, disabled, isNarrow = false, recorded = null, onValue, onSettled }: SliderProps) {
  const toPlace = (x: number) => (isLog ? (STEPS * Math.log(x / min)) / Math.log(max / min) : x);
  const toValue = (place: number) => (isLog ? min * (max / min) ** (place / STEPS) : place);
  const text = `${value.toFixed(digits)}${unit && ` ${unit}`}`;
  const numbers = recorded && [...new Set(recorded.map((x) => x.toFixed(digits)))].join(" to ");
  const beyond = recorded && (value < recorded[0] * (1 - NEAR) ? "below the recorded range" : value > recorded[1] * (1 + NEAR) ? "above the recorded range" : "recorded");
  const part = (x: number) => Math.min(Math.max((toPlace(x) - toPlace(min)) / (toPlace(max) - toPlace(min)), 0), 1);
  return (
    <label class={isNarrow ? "slider only-narrow" : "slider"} title={numbers ? `Recorded: ${numbers}${unit && ` ${unit}`}` : undefined}>
      <span class="slider-name">{label}</span>
      <input
        type="range"
        min={isLog ? 0 : min}
        max={isLog ? STEPS : max}
        step={isLog ? 1 : step ?? (max - min) / STEPS}
        value={toPlace(Math.min(Math.max(value, min), max))}
        disabled={disabled}
        aria-label={label}
        aria-valuetext={beyond ? `${text}, ${beyond}` : text}
        onInput={(event) => onValue(toValue(event.currentTarget.valueAsNumber))}
        // `onChange` would be called at every step of a drag, as React does.
        onChangeCapture={() => onSettled?.()}
      />
      {recorded && <Mark from={part(recorded[0])} to={part(recorded[1])} />}
      <span class="slider-value" aria-hidden="true">
        {text}
      </span>
    </label>
  );
}
