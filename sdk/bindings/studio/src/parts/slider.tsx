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
  onValue: (value: number) => void;
  /** The hand or the key has let go. */
  onSettled?: () => void;
}

const STEPS = 1000;

export function Slider({ label, unit = "", min, max, value, isLog = false, digits = 2, step, disabled, isNarrow = false, onValue, onSettled }: SliderProps) {
  const toPlace = (x: number) => (isLog ? (STEPS * Math.log(x / min)) / Math.log(max / min) : x);
  const toValue = (place: number) => (isLog ? min * (max / min) ** (place / STEPS) : place);
  const text = `${value.toFixed(digits)}${unit && ` ${unit}`}`;
  return (
    <label class={isNarrow ? "slider only-narrow" : "slider"}>
      <span class="slider-name">{label}</span>
      <input
        type="range"
        min={isLog ? 0 : min}
        max={isLog ? STEPS : max}
        step={isLog ? 1 : step ?? (max - min) / STEPS}
        value={toPlace(Math.min(Math.max(value, min), max))}
        disabled={disabled}
        aria-label={label}
        aria-valuetext={text}
        onInput={(event) => onValue(toValue(event.currentTarget.valueAsNumber))}
        // `onChange` would be called at every step of a drag, as React does.
        onChangeCapture={() => onSettled?.()}
      />
      <span class="slider-value" aria-hidden="true">
        {text}
      </span>
    </label>
  );
}
