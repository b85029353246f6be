// Paints the spectrum: grid, threshold, curves, bars and handles.

import type { Limits } from "../shaping/shaper.ts";
import { HIGH_HZ, LOW_HZ, TICKS_HZ, placeOf, toX, toY, type Scale } from "./spectrum-scale.ts";

export type Style = "played" | "model" | "before" | "recording" | "threshold";

export interface Curve {
  readonly style: Style;
  readonly hz: ArrayLike<number>;
  readonly db: readonly number[];
}

export interface Mark {
  readonly hz: number;
  readonly db: number;
}

export interface Picture {
  readonly scale: Scale;
  readonly curves: readonly Curve[];
  readonly marks: readonly Mark[];
  /** Whether marks stand on bars. */
  readonly hasBars: boolean;
  readonly limits: Limits;
  readonly selected: number;
  readonly hasFocus: boolean;
}

/** Colour, width and dashes of each kind of curve: they differ in more than colour. */
const LOOK: Record<Style, { colour: string; width: number; dash: number[] }> = {
  played: { colour: "--ink", width: 1.6, dash: [] },
  model: { colour: "--accent", width: 2.6, dash: [] },
  before: { colour: "--second", width: 1.8, dash: [7, 5] },
  recording: { colour: "--third", width: 1.8, dash: [2, 3] },
  threshold: { colour: "--soft", width: 1.2, dash: [1, 4] },
};

export function paintSpectrum(pen: CanvasRenderingContext2D, ratio: number, picture: Picture) {
  const style = getComputedStyle(pen.canvas);
  const colour = (name: string) => style.getPropertyValue(name).trim();
  const { scale, curves, marks, hasBars } = picture;
  pen.setTransform(ratio, 0, 0, ratio, 0, 0);
  pen.clearRect(0, 0, pen.canvas.width, pen.canvas.height);
  grid(pen, scale, colour, style.fontFamily);
  pen.save();
  pen.beginPath();
  pen.rect(scale.left, scale.top, scale.width, scale.height);
  pen.clip();
  const threshold = curves.find((curve) => curve.style === "threshold");
  if (threshold) below(pen, scale, threshold, colour("--sunk"));
  if (hasBars) bars(pen, picture, colour);
  for (const curve of curves) line(pen, scale, curve, colour);
  range(pen, picture, colour);
  pen.restore();
  ends(pen, picture, colour);
  marks.forEach((mark, i) => dot(pen, picture, mark, i, colour));
}

function grid(pen: CanvasRenderingContext2D, scale: Scale, colour: (name: string) => string, font: string) {
  pen.lineWidth = 1;
  pen.strokeStyle = colour("--line");
  pen.fillStyle = colour("--soft");
  pen.font = `12px ${font}`;
  pen.textAlign = "center";
  for (const hz of TICKS_HZ) {
    const x = Math.round(toX(scale, hz)) + 0.5;
    stroke(pen, x, scale.top, x, scale.top + scale.height);
    pen.fillText(String(hz), Math.min(x, scale.left + scale.width - 12), scale.top + scale.height + 18);
  }
  pen.textAlign = "right";
  for (let db = scale.floor; db <= scale.ceiling; db += 10) {
    const y = Math.round(toY(scale, db)) + 0.5;
    stroke(pen, scale.left, y, scale.left + scale.width, y);
    pen.fillText(String(db), scale.left - 8, y + 4);
  }
}

function stroke(pen: CanvasRenderingContext2D, x: number, y: number, toX: number, toY: number) {
  pen.beginPath();
  pen.moveTo(x, y);
  pen.lineTo(toX, toY);
  pen.stroke();
}

function path(pen: CanvasRenderingContext2D, scale: Scale, { hz, db }: Curve) {
  pen.beginPath();
  db.forEach((value, i) => pen.lineTo(toX(scale, hz[i] ?? 0), Math.min(toY(scale, value), scale.top + scale.height + 4)));
}

function line(pen: CanvasRenderingContext2D, scale: Scale, curve: Curve, colour: (name: string) => string) {
  const look = LOOK[curve.style];
  pen.setLineDash(look.dash);
  pen.lineWidth = look.width;
  pen.lineJoin = "round";
  pen.strokeStyle = colour(look.colour);
  path(pen, scale, curve);
  pen.stroke();
  pen.setLineDash([]);
}

function below(pen: CanvasRenderingContext2D, scale: Scale, curve: Curve, fill: string) {
  path(pen, scale, curve);
  pen.lineTo(scale.left + scale.width, scale.top + scale.height);
  pen.lineTo(scale.left, scale.top + scale.height);
  pen.closePath();
  pen.fillStyle = fill;
  pen.fill();
}

/** A bar for each mark, from half way to its left neighbour to half way to its right one. */
function bars(pen: CanvasRenderingContext2D, { scale, marks, selected }: Picture, colour: (name: string) => string) {
  const places = marks.map(({ hz }) => toX(scale, hz));
  marks.forEach(({ db }, i) => {
    const x = places[i] ?? 0;
    const left = i > 0 ? ((places[i - 1] ?? x) + x) / 2 : scale.left;
    const right = i < marks.length - 1 ? (x + (places[i + 1] ?? x)) / 2 : scale.left + scale.width;
    const y = Math.min(toY(scale, db), scale.top + scale.height - 2);
    pen.fillStyle = colour(i === selected ? "--accent" : "--accent-soft");
    pen.globalAlpha = i === selected ? 0.45 : 1;
    pen.beginPath();
    pen.roundRect(left + 1, y, Math.max(right - left - 2, 1), scale.top + scale.height - y, [4, 4, 0, 0]);
    pen.fill();
    pen.globalAlpha = 1;
  });
}

/** Veils what is outside the range. */
function range(pen: CanvasRenderingContext2D, { scale, limits }: Picture, colour: (name: string) => string) {
  if (!limits.range) return;
  const [low, high] = limits.range.map((hz) => toX(scale, hz)) as [number, number];
  pen.fillStyle = colour("--sunk");
  pen.globalAlpha = 0.72;
  pen.fillRect(scale.left, scale.top, low - scale.left, scale.height);
  pen.fillRect(high, scale.top, scale.left + scale.width - high, scale.height);
  pen.globalAlpha = 1;
}

/** A bar along the axis from one end of the range to the other, which a drag moves. */
function ends(pen: CanvasRenderingContext2D, { scale, limits }: Picture, colour: (name: string) => string) {
  const [low, high] = (limits.range ?? [LOW_HZ, HIGH_HZ]).map((hz) => toX(scale, hz)) as [number, number];
  const y = scale.top + scale.height + 1;
  pen.lineWidth = limits.range ? 4 : 2;
  pen.strokeStyle = colour(limits.range ? "--accent" : "--edge");
  stroke(pen, low, y, high, y);
  for (const x of [low, high]) stroke(pen, x, y - 2, x, y + 9);
}

function dot(pen: CanvasRenderingContext2D, { scale, hasBars: isBar, selected, hasFocus, limits }: Picture, mark: Mark, index: number, colour: (name: string) => string) {
  const [x, y] = placeOf(scale, mark);
  const isSelected = index === selected;
  const radius = isBar ? (isSelected ? 6 : 3) : isSelected ? 9 : 7;
  const isLocked = limits.locked.has(index);
  pen.beginPath();
  // A locked handle is a square.
  if (isLocked) pen.rect(x - Math.max(radius, 5), y - Math.max(radius, 5), 2 * Math.max(radius, 5), 2 * Math.max(radius, 5));
  else pen.arc(x, y, radius, 0, 2 * Math.PI);
  pen.fillStyle = colour(isLocked ? "--soft" : isSelected ? "--accent" : "--panel");
  pen.fill();
  pen.lineWidth = 2;
  pen.strokeStyle = colour(isLocked ? "--soft" : "--accent");
  pen.stroke();
  if (!isSelected || !hasFocus) return;
  pen.beginPath();
  pen.arc(x, y, radius + 5, 0, 2 * Math.PI);
  pen.stroke();
}
