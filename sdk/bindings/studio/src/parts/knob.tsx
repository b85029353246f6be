// A knob from -1 to 1 with its rest at 0, for a mouse, its wheel, fingers and keys.

import { useEffect, useRef } from "preact/hooks";

export interface KnobProps {
  name: string;
  /** Words for its two ends. */
  ends: readonly [low: string, high: string];
  value: number;
  /** The value in words. */
  text: string;
  title: string;
  disabled: boolean;
  onTurn: (value: number) => void;
  /** The hand, the key or the wheel has let go. */
  onSettled: () => void;
  /** The user may be about to turn it. */
  onNear: () => void;
}

/** Pixels of a drag from one end to the other. */
const TRAVEL = 240;
/** Steps of the arrow keys and of the wheel, of Page Up and Page Down, and the part of a step and of a drag that Shift leaves. */
const [STEP, PAGE, FINE] = [0.05, 0.25, 0.2];
/** Angle of each end from the rest, degrees. */
const TURN = 135;
/** Milliseconds of rest after which the wheel has let go. */
const WHEEL_MS = 400;
const [CENTRE, RADIUS] = [32, 26];

const clamp = (value: number) => Math.min(Math.max(value, -1), 1);
/** Sums of steps without the errors of their digits. */
const rounded = (value: number) => Math.round(1e4 * value) / 1e4;

function arc(from: number, to: number) {
  const at = (value: number) => {
    const angle = (TURN * value * Math.PI) / 180;
    return `${(CENTRE + RADIUS * Math.sin(angle)).toFixed(2)} ${(CENTRE - RADIUS * Math.cos(angle)).toFixed(2)}`;
  };
  const [low, high] = [Math.min(from, to), Math.max(from, to)];
  return `M${at(low)}A${RADIUS} ${RADIUS} 0 ${(high - low) * TURN > 180 ? 1 : 0} 1 ${at(high)}`;
}

function Dial({ value }: { value: number }) {
  return (
    <svg class="knob-dial" viewBox="0 0 64 64" aria-hidden="true">
      <path class="knob-track" d={arc(-1, 1)} />
      {value !== 0 && <path class="knob-turned" d={arc(0, value)} />}
      <circle class="knob-face" cx={CENTRE} cy={CENTRE} r="19" />
      <path class="knob-pointer" d="M32 25V15.500" transform={`rotate(${TURN * value} ${CENTRE} ${CENTRE})`} />
    </svg>
  );
}

export function Knob(props: KnobProps) {
  const { name, ends, value, text, title, disabled } = props;
  const place = useRef<HTMLDivElement>(null);
  const kept = useRef({ props, from: null as { x: number; y: number; value: number } | null, wheel: 0 });
  kept.current.props = props;

  const turn = (next: number) => {
    const { onTurn, value: now } = kept.current.props;
    const to = rounded(clamp(next));
    if (to !== now) onTurn(to);
  };
  useEffect(() => {
    const element = place.current;
    const state = kept.current;
    // The page must not scroll with it, which only a listener that is not passive can prevent.
    const wheel = (event: WheelEvent) => {
      if (state.props.disabled || event.ctrlKey) return;
      event.preventDefault();
      // With Shift, browsers scroll sideways.
      const way = event.deltaY || event.deltaX;
      turn(state.props.value - Math.sign(way) * STEP * (event.shiftKey ? FINE : 1));
      clearTimeout(state.wheel);
      state.wheel = window.setTimeout(() => state.props.onSettled(), WHEEL_MS);
    };
    element?.addEventListener("wheel", wheel, { passive: false });
    return () => {
      element?.removeEventListener("wheel", wheel);
      clearTimeout(state.wheel);
    };
  }, []);

  const down = (event: PointerEvent) => {
    if (disabled || event.button !== 0 || !event.isPrimary) return;
    place.current?.setPointerCapture(event.pointerId);
    place.current?.focus({ preventScroll: true });
    kept.current.from = { x: event.clientX, y: event.clientY, value };
  };
  const move = (event: PointerEvent) => {
    const { from } = kept.current;
    if (!from || !event.isPrimary) return;
    // Up and to the right is more.
    const way = event.clientX - from.x - (event.clientY - from.y);
    const to = clamp(from.value + (2 * way * (event.shiftKey ? FINE : 1)) / TRAVEL);
    kept.current.from = { x: event.clientX, y: event.clientY, value: to };
    turn(to);
  };
  const up = () => {
    if (!kept.current.from) return;
    kept.current.from = null;
    kept.current.props.onSettled();
  };
  const key = (event: KeyboardEvent) => {
    if (disabled || event.ctrlKey || event.metaKey || event.altKey) return;
    const step = STEP * (event.shiftKey ? FINE : 1);
    const to: Record<string, number> = {
      ArrowUp: value + step,
      ArrowRight: value + step,
      ArrowDown: value - step,
      ArrowLeft: value - step,
      PageUp: value + PAGE,
      PageDown: value - PAGE,
      Home: -1,
      End: 1,
      Delete: 0,
      Backspace: 0,
    };
    const next = to[event.key];
    if (next === undefined) return;
    event.preventDefault();
    turn(next);
  };
  return (
    <div
      ref={place}
      class="knob"
      role="slider"
      tabIndex={disabled ? undefined : 0}
      aria-label={name}
      aria-valuemin={-1}
      aria-valuemax={1}
      aria-valuenow={value}
      aria-valuetext={text}
      aria-disabled={disabled}
      title={title}
      onPointerEnter={props.onNear}
      onFocus={props.onNear}
      onPointerDown={down}
      onPointerMove={move}
      onPointerUp={up}
      onPointerCancel={up}
      onLostPointerCapture={up}
      onDblClick={() => !disabled && (turn(0), props.onSettled())}
      onKeyDown={key}
      onKeyUp={props.onSettled}
    >
      <span class="knob-name">{name}</span>
      <Dial value={value} />
      <span class="knob-ends" aria-hidden="true">
        <span>{ends[0]}</span>
        <span>{ends[1]}</span>
      </span>
    </div>
  );
}
