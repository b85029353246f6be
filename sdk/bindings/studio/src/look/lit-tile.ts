// A lit relief on a canvas: a tile that repeats, and the spot of the lamp over it.

import type { Texture } from "htex";

import type { Slid } from "../conditions.ts";
import { breathe } from "../slices.ts";
import type { Appearance } from "./appearance.ts";
import { appearanceOf } from "./guess.ts";
import { SPOT, USUAL_LAMP, lit, spot, type Lamp } from "./light.ts";
import { fineSpectrum } from "./spectrum-line.ts";
import { surface, type Surface } from "./surface.ts";

type Pixels = Uint8ClampedArray<ArrayBuffer>;

function put(canvas: HTMLCanvasElement, pixels: Pixels, width: number, height: number) {
  canvas.width = width;
  canvas.height = height;
  canvas.getContext("2d")?.putImageData(new ImageData(pixels, width, height), 0, 0);
}

export class LitTile {
  private readonly tile = document.createElement("canvas");
  private readonly spot = document.createElement("canvas");

  /** Lights a relief for a picture of given proportions. */
  light(relief: Surface, appearance: Appearance, lamp: Lamp, proportion: number) {
    put(this.tile, lit(relief, appearance, lamp), relief.width, relief.height);
    put(this.spot, spot(appearance, lamp, proportion), SPOT, SPOT);
  }

  /** Fills a picture. A pixel of the tile is `scale` pixels, and the tile begins at an offset. */
  fill(pen: CanvasRenderingContext2D, width: number, height: number, scale = 1, offset = { x: 0, y: 0 }) {
    const pattern = pen.createPattern(this.tile, "repeat");
    if (!pattern) return;
    const [wide, high] = [this.tile.width * scale, this.tile.height * scale];
    pen.save();
    pen.translate((offset.x % wide) - wide, (offset.y % high) - high);
    pen.scale(scale, scale);
    pen.fillStyle = pattern;
    pen.fillRect(0, 0, width / scale + 2 * this.tile.width, height / scale + 2 * this.tile.height);
    pen.restore();
    pen.drawImage(this.spot, 0, 0, width, height);
  }
}

/** Ends a piece of work at once. */
export function atOnce<T>(work: Generator<void, T>): T {
  for (;;) {
    const { done, value } = work.next();
    if (done) return value;
  }
}

/** Ends a piece of work in slices. */
async function inSlices<T>(work: Generator<void, T>): Promise<T> {
  for (;;) {
    const { done, value } = work.next();
    if (done) return value;
    await breathe();
  }
}

/** Size of the relief of a small picture. */
const SMALL = [256, 128] as const;

let shared: LitTile | null = null;

/** Fills a small picture with the look of a texture at a motion. */
export async function paintSmall(pen: CanvasRenderingContext2D, width: number, height: number, texture: Texture, model: string, at: Slid) {
  shared ??= new LitTile();
  const appearance = appearanceOf(texture);
  const relief = await inSlices(surface(fineSpectrum(texture, model, at), appearance.pattern, SMALL));
  shared.light(relief, appearance, USUAL_LAMP, width / height);
  shared.fill(pen, width, height);
}
