// The looks of the four corners, each of which passes into the others.

import { useEffect, useRef } from "preact/hooks";

import { near } from "../conditions.ts";
import type { Opened } from "../item.ts";
import { paintSmall } from "../look/lit-tile.ts";
import { openedCorners } from "../mixing.ts";
import { sliders } from "../motion.ts";
import { whenFree } from "../slices.ts";

/** A canvas that is not shown. */
function hidden(width: number, height: number) {
  const pen = Object.assign(document.createElement("canvas"), { width, height }).getContext("2d");
  if (!pen) throw new Error("the browser draws no pictures");
  return pen;
}

/** Leaves of a picture what its corner has at each place: all of it at the corner, nothing at the opposite edges. */
function fade(pen: CanvasRenderingContext2D, isRight: boolean, isLower: boolean) {
  const { width, height } = pen.canvas;
  const ways = [
    [isRight, width, 0],
    [isLower, 0, height],
  ] as const;
  pen.globalCompositeOperation = "destination-in";
  for (const [isFar, x, y] of ways) {
    const gradient = pen.createLinearGradient(0, 0, x, y);
    gradient.addColorStop(0, isFar ? "#0000" : "#000f");
    gradient.addColorStop(1, isFar ? "#000f" : "#0000");
    pen.fillStyle = gradient;
    pen.fillRect(0, 0, width, height);
  }
  pen.globalCompositeOperation = "source-over";
}

async function paint(canvas: HTMLCanvasElement, corners: readonly (Opened | null)[]) {
  const { clientWidth: width, clientHeight: height } = canvas;
  if (width === 0 || height === 0) return;
  const [whole, corner] = [hidden(width, height), hidden(width, height)];
  whole.globalCompositeOperation = "lighter";
  for (const [i, opened] of corners.entries()) {
    if (!opened) continue;
    const { texture, model } = opened;
    await paintSmall(corner, width, height, texture, model, near(texture, model, sliders.peek()).at);
    fade(corner, i % 2 === 1, i > 1);
    whole.drawImage(corner.canvas, 0, 0);
  }
  Object.assign(canvas, { width, height });
  canvas.getContext("2d")?.drawImage(whole.canvas, 0, 0);
}

export function MixPicture() {
  const canvas = useRef<HTMLCanvasElement>(null);
  const corners = openedCorners.value;
  useEffect(() => {
    const place = canvas.current;
    if (!place) return;
    let forget = () => {};
    // A texture that was forgotten in the meantime cannot be read any more.
    const again = () => {
      forget();
      forget = whenFree(() => paint(place, corners).catch(() => {}));
    };
    const observer = new ResizeObserver(again);
    observer.observe(place);
    return () => {
      observer.disconnect();
      forget();
    };
  }, corners.map((one) => one?.texture));
  return <canvas ref={canvas} aria-hidden="true" />;
}
