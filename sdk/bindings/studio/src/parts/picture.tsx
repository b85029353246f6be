// A small picture of a texture: its lit relief, and its spectrum as a line in the corner.

import { computed } from "@preact/signals";
import { useEffect, useMemo, useRef } from "preact/hooks";
import type { Texture } from "htex";

import { near } from "../conditions.ts";
import { paintSmall } from "../look/lit-tile.ts";
import { LINE_HEIGHT, LINE_WIDTH, fineSpectrum, outline } from "../look/spectrum-line.ts";
import { sliders } from "../motion.ts";
import { watchNear } from "../near.ts";
import { whenFree } from "../slices.ts";

const [WIDTH, HEIGHT] = [256, 96];

/** The place of a picture that is not yet there. */
export function NoPicture() {
  return <span class="picture" aria-hidden="true" />;
}

/** Paints while the canvas is near the part of the screen that is seen, and gives its memory back when it is not. */
function keepPainted(canvas: HTMLCanvasElement, paint: (pen: CanvasRenderingContext2D) => Promise<void>) {
  let forget = () => {};
  let isSeen = false;
  // What is painted shows at once, and what was there before until then.
  const job = async () => {
    const hidden = Object.assign(document.createElement("canvas"), { width: WIDTH, height: HEIGHT });
    const pen = hidden.getContext("2d");
    if (pen) await paint(pen);
    if (!isSeen) return;
    Object.assign(canvas, { width: WIDTH, height: HEIGHT });
    canvas.getContext("2d")?.drawImage(hidden, 0, 0);
  };
  const end = watchNear(canvas, (isNear) => {
    isSeen = isNear;
    forget();
    // A texture that was forgotten in the meantime cannot be read any more.
    if (isNear) forget = whenFree(() => job().catch(() => {}));
    else canvas.width = canvas.height = 0;
  });
  return () => {
    isSeen = false;
    end();
    forget();
  };
}

export function Picture({ texture, model }: { texture: Texture; model: string }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  // Drawn anew only when the sliders choose another condition.
  const place = useMemo(() => computed(() => near(texture, model, sliders.value).place), [texture, model]).value;
  const at = useMemo(() => near(texture, model, sliders.peek()).at, [texture, model, place]);
  const path = useMemo(() => outline(fineSpectrum(texture, model, at)), [texture, model, at]);
  useEffect(() => (canvas.current ? keepPainted(canvas.current, (pen) => paintSmall(pen, WIDTH, HEIGHT, texture, model, at)) : undefined), [texture, model, at]);
  return (
    <span class="picture" aria-hidden="true">
      <canvas ref={canvas} />
      <svg class="sparkline" viewBox={`-2 -2 ${LINE_WIDTH + 4} ${LINE_HEIGHT + 4}`}>
        <path d={path} />
      </svg>
    </span>
  );
}
