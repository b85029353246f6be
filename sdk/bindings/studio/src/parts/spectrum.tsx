// The spectrum, drawn and drawn on: handles follow the pointer and the arrow keys.

import { effect } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";

import { scheme } from "../theme.ts";
import { paintSpectrum, type Curve } from "./spectrum-painter.ts";
import { placeOf, rangeOf, toDb, toHz, type Scale } from "./spectrum-scale.ts";
import type { Drawn, Handle } from "../shaping/shaper.ts";

/** How near a press has to be to a handle, pixels. */
const NEAR = 30;
/** How near a finger has to be above or below the top of a bar. Elsewhere it scrolls the screen. */
const NEAR_TOP = 44;
/** Steps of the arrow keys, and of Page Up and Page Down. */
const STEP_DB = 1;
const PAGE_DB = 6;
const STEP_RATIO = 2 ** (1 / 24);
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
  onAdd?: ((hz: number, db: number) => void) | undefined;
  onRemove?: ((handle: number) => void) | undefined;
  label: string;
}

export function Spectrum(props: SpectrumProps) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const [hasFocus, focus] = useState(false);
  const kept = useRef({ ...props, hasFocus, scale: null as Scale | null, dragged: -1, drawnDb: null as number | null, frame: 0, wanted: null as [number, number] | null });
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
    const touch = (event: TouchEvent) => kept.current.dragged >= 0 && event.preventDefault();
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
    const { scale, handles, hasBars } = kept.current;
    if (!scale || event.button !== 0) return;
    const found = nearest(scale, handles, hasBars, at(event));
    if (found < 0 || (event.pointerType === "touch" && !isNearTop(scale, handles[found], at(event)))) return;
    canvas.current?.setPointerCapture(event.pointerId);
    Object.assign(kept.current, { dragged: found, drawnDb: null });
    select(found);
    if (hasBars) drag(event);
  };
  const drag = (event: PointerEvent) => {
    const state = kept.current;
    if (state.dragged < 0 || !state.scale || event.buttons === 0) return;
    const isWaiting = state.wanted !== null;
    state.wanted = at(event);
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
  const up = () => {
    if (kept.current.dragged < 0) return;
    // The last move may still wait for this frame. Then the axes follow.
    requestAnimationFrame(() => {
      kept.current.dragged = -1;
      kept.current.onSettle();
      wish();
    });
  };
  const add = (event: MouseEvent) => {
    const { scale, onAdd } = kept.current;
    const [x, y] = at(event);
    if (scale) onAdd?.(toHz(scale, x), toDb(scale, y));
  };
  const key = (event: KeyboardEvent) => {
    const { handles, selected: now, scale } = kept.current;
    const handle = handles[now];
    if (!handle) return;
    const free = event.altKey || event.shiftKey;
    if (event.key === "ArrowUp" || event.key === "ArrowDown") {
      kept.current.onMove(now, handle.hz, handle.db + (event.key === "ArrowUp" ? STEP_DB : -STEP_DB));
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
    } else return;
    event.preventDefault();
  };
  const handle = props.handles[props.selected];
  return (
    <div class="spectrum">
      <canvas
        ref={canvas}
        tabIndex={handle ? 0 : undefined}
        role={handle ? "slider" : "img"}
        aria-label={props.label}
        {...(handle ? { "aria-valuenow": Math.round(handle.db), "aria-valuetext": describe(handle) } : {})}
        onPointerDown={down}
        onPointerMove={drag}
        onPointerUp={up}
        onPointerCancel={up}
        onDblClick={props.onAdd ? add : undefined}
        onKeyDown={key}
        onKeyUp={() => props.onSettle()}
        onFocus={() => focus(true)}
        onBlur={() => focus(false)}
      />
    </div>
  );
}

/** A handle in words. */
export const describe = ({ name, hz, db }: Handle) => `${name}, ${hz.toFixed(0)} Hz, ${db.toFixed(0)} dB`;

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
  paintSpectrum(pen, ratio, { scale: state.scale, curves, marks: state.handles, hasBars: state.hasBars, selected: state.handles.length > 0 ? state.selected : -1, hasFocus: state.hasFocus });
}
