// The spectrum, drawn and drawn on: handles follow the pointer and the arrow keys.

import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";

import { scheme } from "../theme.ts";
import { HandleEntry } from "./handle-entry.tsx";
import { paintSpectrum, type Curve } from "./spectrum-painter.ts";
import { HIGH_HZ, isOnAxis, LOW_HZ, placeOf, rangeOf, toDb, toHz, toX, type Scale } from "./spectrum-scale.ts";
import type { Drawn, Handle, Limits, Range } from "../shaping/shaper.ts";

/** How near a press has to be to a handle, pixels. */
const NEAR = 30;
/** How near a finger has to be above or below the top of a bar. Elsewhere it scrolls the screen. */
const NEAR_TOP = 44;
/** How near a press has to be to an end of the range, and how far a drag along the axis has to go, pixels. */
const [NEAR_END, LEAST_RANGE] = [22, 8];
/** Steps of the arrow keys, with Shift, and of Page Up and Page Down. */
const STEP_DB = 1;
const FINE_DB = 0.1;
const PAGE_DB = 6;
const STEP_RATIO = 2 ** (1 / 24);
/** Part of the pointer's way that a handle goes with Shift. */
const FINE = 0.2;
/** Milliseconds between two drawings of what follows the finger. */
const LIVE_MS = 33;

export interface SpectrumProps {
  /** Curves that change with the texture. */
  curves: readonly Curve[];
  /** A curve that follows the finger; asked for at each frame in which something moved. */
  live?: () => Curve | null;
  /** What tells that the live curve may have changed. */
  watch?: () => unknown;
  handles: readonly Handle[];
  /** Index of the chosen handle. */
  selected: number;
  onSelect: (handle: number) => void;
  hasBars: boolean;
  onMove: (handle: number, hz: number, db: number) => void;
  /** Bars were drawn across. */
  onDraw: (drawn: readonly Drawn[]) => void;
  onSettle: () => void;
  /** Locked handles, and the range that may change. */
  limits: Limits;
  onLock: (handle: number) => void;
  /** A range was dragged along the axis; null for all frequencies. */
  onRange: (range: Range | null) => void;
  /** Whether a value is being typed for the chosen handle. */
  isTyping: boolean;
  onTyping: (isTyping: boolean) => void;
  onAdd?: ((hz: number, db: number) => void) | undefined;
  onRemove?: ((handle: number) => void) | undefined;
  label: string;
}

export function Spectrum(props: SpectrumProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [hasFocus, focus] = useState(false);
  const kept = useRef({ ...props, hasFocus, scale: null as Scale | null, dragged: -1, drawnDb: null as number | null, fixedHz: null as number | null, last: [0, 0] as [number, number], fine: [0, 0] as [number, number], frame: 0, wanted: null as [number, number] | null });
  Object.assign(kept.current, props, { hasFocus });
  const select = (handle: number) => kept.current.onSelect(handle);

  const wish = () => {
    const state = kept.current;
    state.frame ||= requestAnimationFrame(() => paint(canvas.current, state));
  };
  useEffect(wish);
  useEffect(() => {
    const place = canvas.current;
    if (!place) return;
    const observer = new ResizeObserver(() => wish());
    observer.observe(place);
    // A finger that has a handle does not scroll. Pointer events come before touch events, so it
    // has the handle by then.
    const touch = (event: TouchEvent) => (kept.current.dragged >= 0 || kept.current.fixedHz !== null) && event.preventDefault();
    place.addEventListener("touchstart", touch, { passive: false });
    let timer = 0;
    const later = () => {
      timer = 0;
      wish();
    };
    const end = effect(() => {
      kept.current.watch?.();
      void scheme.value;
      timer ||= window.setTimeout(later, LIVE_MS);
    });
    return () => {
      observer.disconnect();
      place.removeEventListener("touchstart", touch);
      end();
      clearTimeout(timer);
      cancelAnimationFrame(kept.current.frame);
    };
  }, []);

  const at = (event: PointerEvent | MouseEvent): [number, number] => {
    const box = canvas.current?.getBoundingClientRect();
    return [event.clientX - (box?.left ?? 0), event.clientY - (box?.top ?? 0)];
  };
  const down = (event: PointerEvent) => {
    const { scale, handles, hasBars, limits } = kept.current;
    if (!scale || event.button !== 0) return;
    if (kept.current.isTyping) kept.current.onTyping(false);
    const pressed = at(event);
    Object.assign(kept.current, { last: pressed, fine: pressed });
    if (isOnAxis(scale, pressed)) {
      // A finger takes only the ends of the range. Elsewhere it scrolls.
      const fixed = otherEnd(scale, limits.range ?? WHOLE, pressed[0]) ?? (event.pointerType === "touch" ? null : toHz(scale, pressed[0]));
      if (fixed !== null) canvas.current?.setPointerCapture(event.pointerId);
      kept.current.fixedHz = fixed;
      return;
    }
    const found = nearest(scale, handles, hasBars, at(event));
    if (found < 0 || (event.pointerType === "touch" && !isNearTop(scale, handles[found], at(event)))) return;
    canvas.current?.setPointerCapture(event.pointerId);
    Object.assign(kept.current, { dragged: found, drawnDb: null });
    select(found);
    if (hasBars) drag(event);
  };
  const drag = (event: PointerEvent) => {
    const state = kept.current;
    if (state.fixedHz !== null) return dragRange(event);
    if (state.dragged < 0 || !state.scale || event.buttons === 0) return;
    const isWaiting = state.wanted !== null;
    const now = at(event);
    const part = event.shiftKey ? FINE : 1;
    state.fine = [state.fine[0] + part * (now[0] - state.last[0]), state.fine[1] + part * (now[1] - state.last[1])];
    state.last = now;
    // Across bars, the hand chooses the bar.
    state.wanted = [state.hasBars ? now[0] : state.fine[0], state.fine[1]];
    // The hand may be faster than the frames.
    if (!isWaiting) requestAnimationFrame(() => {
      if (!state.wanted || !state.scale) return;
      const [x, y] = state.wanted;
      state.wanted = null;
      if (state.hasBars) draw(state, x, y);
      else {
        const handle = state.handles[state.dragged];
        if (handle) state.onMove(state.dragged, handle.moves === "both" ? toHz(state.scale, x) : handle.hz, toDb(state.scale, y));
      }
      select(state.dragged);
    });
  };
  const dragRange = (event: PointerEvent) => {
    const { scale, fixedHz, onRange } = kept.current;
    if (!scale || fixedHz === null) return;
    const x = at(event)[0];
    if (Math.abs(x - toX(scale, fixedHz)) < LEAST_RANGE) return;
    const hz = toHz(scale, x);
    const range = [Math.min(hz, fixedHz), Math.max(hz, fixedHz)] as const;
    onRange(range[0] <= WHOLE[0] && range[1] >= WHOLE[1] ? null : range);
  };
  const up = () => {
    kept.current.fixedHz = null;
    if (kept.current.dragged < 0) return;
    // The last move may still wait for this frame. Then the axes follow.
    requestAnimationFrame(() => {
      kept.current.dragged = -1;
      kept.current.onSettle();
      wish();
    });
  };
  const twice = (event: MouseEvent) => {
    const { scale, handles, hasBars, onAdd, onRange, onTyping } = kept.current;
    const [x, y] = at(event);
    if (!scale) return;
    if (isOnAxis(scale, [x, y])) onRange(null);
    else if (!hasBars && nearest(scale, handles, false, [x, y]) >= 0) onTyping(true);
    else onAdd?.(toHz(scale, x), toDb(scale, y));
  };
  const key = (event: KeyboardEvent) => {
    const { handles, selected: now, scale } = kept.current;
    const handle = handles[now];
    if (!handle) return;
    const free = event.altKey || event.shiftKey;
    if (event.key === "ArrowUp" || event.key === "ArrowDown") {
      const step = Math.max(event.shiftKey ? FINE_DB : STEP_DB, handle.stepDb ?? 0);
      kept.current.onMove(now, handle.hz, handle.db + (event.key === "ArrowUp" ? step : -step));
    } else if ((event.key === "ArrowLeft" || event.key === "ArrowRight") && free && handle.moves === "both") {
      kept.current.onMove(now, handle.hz * (event.key === "ArrowRight" ? STEP_RATIO : 1 / STEP_RATIO), handle.db);
    } else if (event.key === "ArrowLeft" || event.key === "ArrowRight") {
      select(Math.min(Math.max(now + (event.key === "ArrowRight" ? 1 : -1), 0), handles.length - 1));
    } else if (event.key === "PageUp" || event.key === "PageDown") {
      kept.current.onMove(now, handle.hz, handle.db + (event.key === "PageUp" ? PAGE_DB : -PAGE_DB));
    } else if ((event.key === "Home" || event.key === "End") && scale) {
      kept.current.onMove(now, handle.hz, event.key === "Home" ? scale.floor : scale.ceiling);
    } else if (event.key === "Delete" || event.key === "Backspace") {
      kept.current.onRemove?.(now);
    } else if (event.key === "Enter") {
      kept.current.onTyping(true);
    } else if (event.key.toLowerCase() === "l" && !event.ctrlKey && !event.metaKey && !event.altKey) {
      kept.current.onLock(now);
    } else return;
    event.preventDefault();
  };
  const handle = props.handles[props.selected];
  const { scale } = kept.current;
  const typed = (hz: number, db: number) => {
    props.onMove(props.selected, hz, db);
    props.onSettle();
  };
  const close = () => {
    props.onTyping(false);
    canvas.current?.focus({ preventScroll: true });
  };
  return (
    <div class="spectrum">
      <canvas
        ref={canvas}
        tabIndex={handle ? 0 : undefined}
        role={handle ? "slider" : "img"}
        aria-label={props.label}
        {...(handle ? { "aria-valuenow": Math.round(handle.db), "aria-valuetext": describe(handle, props.limits.locked.has(props.selected)) } : {})}
        onPointerDown={down}
        onPointerMove={drag}
        onPointerUp={up}
        onPointerCancel={up}
        onDblClick={twice}
        onKeyDown={key}
        onKeyUp={() => props.onSettle()}
        onFocus={() => focus(true)}
        onBlur={() => focus(false)}
      />
      {props.isTyping && handle && scale && <HandleEntry key={handle.name} handle={handle} at={placeOf(scale, handle)} onValue={typed} onClose={close} />}
    </div>
  );
}

/** A handle in words. */
export const describe = ({ name, hz, db }: Handle, isLocked = false) => `${name}, ${hz.toFixed(0)} Hz, ${db.toFixed(1)} dB${isLocked ? ", locked" : ""}`;

/** All frequencies of the chart. */
const WHOLE: Range = [LOW_HZ, HIGH_HZ];

/** The end of a range that stays while a press drags the other end; null if the press is near neither. */
function otherEnd(scale: Scale, [low, high]: Range, x: number): number | null {
  const [toLow, toHigh] = [Math.abs(toX(scale, low) - x), Math.abs(toX(scale, high) - x)];
  if (Math.min(toLow, toHigh) > NEAR_END) return null;
  return toLow < toHigh ? high : low;
}

/** Sets all bars from the last one to the pointer's bar to a line between the two. */
function draw(state: Painted, x: number, y: number) {
  const { scale, handles } = state;
  if (!scale) return;
  const [from, to] = [state.dragged, nearest(scale, handles, true, [x, y])];
  const start = state.drawnDb ?? toDb(scale, y);
  const end = toDb(scale, y);
  const steps = Math.abs(to - from);
  const way = Array.from({ length: Math.max(steps, 1) }, (_, i) => (steps === 0 ? 1 : (i + 1) / steps));
  state.onDraw(way.map((part) => ({ handle: from + Math.round((to - from) * part), db: start + (end - start) * part })));
  state.dragged = to;
  state.drawnDb = end;
}

/** The handle of a press; of bars the one below or above it. */
function nearest(scale: Scale, handles: readonly Handle[], hasBars: boolean, [x, y]: [number, number]) {
  const places = handles.map((handle) => placeOf(scale, handle));
  const far = places.map(([left, top]) => Math.hypot(left - x, hasBars ? 0 : top - y));
  const least = Math.min(...far);
  return hasBars || least < NEAR ? far.indexOf(least) : -1;
}

/** Whether a press is about as high as a handle. */
function isNearTop(scale: Scale, handle: Handle | undefined, [, y]: [number, number]) {
  return handle !== undefined && Math.abs(placeOf(scale, handle)[1] - y) < NEAR_TOP;
}

interface Painted extends SpectrumProps {
  hasFocus: boolean;
  scale: Scale | null;
  dragged: number;
  /** Decibels of the bar that was drawn last. */
  drawnDb: number | null;
  frame: number;
}

/** Tells the range of a handle to screen readers. It is known only once the axes are. */
function tellRange(canvas: HTMLCanvasElement, { floor, ceiling }: Scale, handle: Handle | undefined) {
  canvas.ariaValueMin = handle ? String(Math.round(Math.min(floor, handle.db))) : null;
  canvas.ariaValueMax = handle ? String(Math.round(Math.max(ceiling, handle.db))) : null;
}

function paint(canvas: HTMLCanvasElement | null, state: Painted) {
  state.frame = 0;
  const pen = canvas?.getContext("2d");
  if (!canvas || !pen) return;
  const ratio = Math.min(devicePixelRatio, 2);
  const [width, height] = [canvas.clientWidth, canvas.clientHeight];
  if (canvas.width !== Math.round(width * ratio)) canvas.width = Math.round(width * ratio);
  if (canvas.height !== Math.round(height * ratio)) canvas.height = Math.round(height * ratio);
  const live = state.live?.();
  // While a handle is dragged, the axes stay.
  const kept = state.dragged >= 0 && state.scale;
  const shown = state.curves.filter(({ style }) => style !== "threshold").map(({ db }) => db);
  const range = kept || rangeOf([...shown, state.handles.map(({ db }) => db)]);
  state.scale = { left: 44, top: 10, width: width - 58, height: height - 40, floor: range.floor, ceiling: range.ceiling };
  tellRange(canvas, state.scale, state.handles[state.selected]);
  const curves = live ? [...state.curves, live] : state.curves;
  paintSpectrum(pen, ratio, { scale: state.scale, curves, marks: state.handles, hasBars: state.hasBars, limits: state.limits, selected: state.handles.length > 0 ? state.selected : -1, hasFocus: state.hasFocus });
}
