// Paints the pad: the lit relief, which moves with the finger, the spectrum as a line in the corner, and the finger. It paints when
// something has changed, and not else.

import { effect, type ReadonlySignal } from "@preact/signals";
import type { Texture } from "htex";

import { near } from "../conditions.ts";
import type { Appearance } from "../look/appearance.ts";
import { ghost } from "../ghost.ts";
import { appearanceOf } from "../look/guess.ts";
import { LitTile } from "../look/lit-tile.ts";
import { fineSpectrum, outline, paintLine } from "../look/spectrum-line.ts";
import { surface, type Surface } from "../look/surface.ts";
import { finger, sliders } from "../motion.ts";
import { colour, isCalm, scheme } from "../theme.ts";
import { lamp } from "./lamp.tsx";

/** Milliseconds between two reliefs while a spectrum is edited, and between two lights while only the appearance is. */
const [RELIEF_MS, LIGHT_MS] = [120, 16];
/** Milliseconds between two pieces of one. */
const PIECE_MS = 4;
/** Part of the finger's way by which the relief moves. */
const CARRIED = 0.3;
const SIZE = [256, 256] as const;

/** What is on the pad. */
interface Shown {
  readonly magnitudes: Float64Array;
  readonly appearance: Appearance;
  readonly relief: Surface;
  readonly line: Path2D;
}

const isEqual = (a: Float64Array, b: Float64Array) => a.every((magnitude, i) => magnitude === b[i]);

/** Part of a finger's colour that a ghost has. */
const GHOST = 0.45;

/** What a pad shows. */
export interface Look {
  /** The texture that sounds; null for a bare pad. */
  readonly sounding: ReadonlySignal<{ texture: Texture; model: string } | null>;
  /** Index of the condition whose grain is shown. */
  readonly pictured: ReadonlySignal<number | null>;
}

export class PadPainter {
  private readonly tile = new LitTile();
  private shown: Shown | null = null;
  private pause = 0;
  /** Whether the lamp, the pad or the texture has changed since the relief was lit. */
  private isUnlit = false;
  private frame = 0;
  private timer = 0;
  /** The relief that is being drawn. */
  private drawing: Generator<void, Surface> | null = null;
  /** Whether the texture has changed since the drawing began. */
  private isStale = false;
  private offset = { x: 0, y: 0 };
  private before = { x: 0.5, y: 0.5 };
  private readonly ends: (() => void)[];

  constructor(
    private readonly canvas: HTMLCanvasElement,
    private readonly look: Look,
  ) {
    const observer = new ResizeObserver(() => this.fit());
    observer.observe(canvas);
    this.ends = [
      effect(() => {
        void look.pictured.value;
        // During a blind test there is no texture to show: the pad is bare at once.
        if (!look.sounding.value) return this.wish();
        if (!this.drawing) this.timer ||= window.setTimeout(() => this.renew(), this.pause);
        else this.isStale = true;
      }),
      effect(() => {
        void [finger.value, ghost.value, scheme.value];
        this.wish();
      }),
      effect(() => {
        void lamp.value;
        this.relight();
      }),
      () => observer.disconnect(),
    ];
  }

  end() {
    for (const end of this.ends) end();
    cancelAnimationFrame(this.frame);
    clearTimeout(this.timer);
    this.drawing = null;
  }

  private fit() {
    const { clientWidth, clientHeight } = this.canvas;
    const scale = Math.min(devicePixelRatio, 2);
    this.canvas.width = Math.max(Math.round(clientWidth * scale), 1);
    this.canvas.height = Math.max(Math.round(clientHeight * scale), 1);
    this.isUnlit = true;
    // A canvas of another size is empty, and is shown before the next frame.
    cancelAnimationFrame(this.frame);
    this.paint();
  }

  private renew() {
    this.timer = 0;
    const now = this.look.sounding.peek();
    if (!now) return;
    const { at } = near(now.texture, now.model, sliders.peek());
    const magnitudes = fineSpectrum(now.texture, now.model, at);
    const appearance = appearanceOf(now.texture);
    const line = new Path2D(outline(magnitudes));
    const { shown } = this;
    if (shown && shown.appearance.pattern === appearance.pattern && isEqual(shown.magnitudes, magnitudes)) return this.show({ ...shown, appearance }, LIGHT_MS);
    const drawing = surface(magnitudes, appearance.pattern, SIZE);
    this.drawing = drawing;
    this.draw(drawing, (relief) => this.show({ magnitudes, appearance, relief, line }, RELIEF_MS));
  }

  /** Goes on with the relief: the first one at once, others in pieces between frames. */
  private draw(drawing: Generator<void, Surface>, show: (relief: Surface) => void) {
    if (drawing !== this.drawing) return;
    for (;;) {
      const { done, value } = drawing.next();
      if (done) {
        this.drawing = null;
        if (this.isStale) this.timer ||= window.setTimeout(() => this.renew(), RELIEF_MS);
        this.isStale = false;
        return show(value);
      }
      if (this.shown) return void setTimeout(() => this.draw(drawing, show), PIECE_MS);
    }
  }

  private show(shown: Shown, pause: number) {
    this.shown = shown;
    this.pause = pause;
    this.relight();
  }

  private relight() {
    this.isUnlit = true;
    this.wish();
  }

  private wish() {
    this.frame ||= requestAnimationFrame(() => this.paint());
  }

  private paint() {
    this.frame = 0;
    const pen = this.canvas.getContext("2d");
    if (!pen) return;
    const { width, height } = this.canvas;
    const isGhost = finger.peek().force === 0 && ghost.peek() !== null;
    const { x, y, force, speed } = (isGhost && ghost.peek()) || finger.peek();
    this.carry(x, y, width, height, force > 0);
    pen.setTransform(1, 0, 0, 1, 0, 0);
    pen.clearRect(0, 0, width, height);
    const scale = Math.min(devicePixelRatio, 2);
    if (this.shown && this.look.sounding.peek()) this.material(pen, this.shown, width, height, scale);
    if (force === 0) return;
    pen.globalAlpha = isGhost ? GHOST : 1;
    this.touch(pen, x * width, y * height, scale, force, speed);
    pen.globalAlpha = 1;
  }

  private material(pen: CanvasRenderingContext2D, { relief, appearance, line }: Shown, width: number, height: number, scale: number) {
    if (this.isUnlit) this.tile.light(relief, appearance, lamp.peek(), width / height);
    this.isUnlit = false;
    this.tile.fill(pen, width, height, scale, this.offset);
    const [r, g, b] = colour("--panel");
    paintLine(pen, line, scale, `rgba(${r}, ${g}, ${b}, 0.8)`, `rgb(${colour("--ink").join()})`);
  }

  /** Moves the relief with the finger; a finger that comes in on the other side has not moved back. */
  private carry(x: number, y: number, width: number, height: number, isDown: boolean) {
    const way = (now: number, before: number) => (Math.abs(now - before) > 0.5 ? 0 : now - before);
    if (isDown && !isCalm.matches) {
      this.offset.x += CARRIED * width * way(x, this.before.x);
      this.offset.y += CARRIED * height * way(y, this.before.y);
    }
    this.before = { x, y };
  }

  private touch(pen: CanvasRenderingContext2D, x: number, y: number, scale: number, force: number, speed: number) {
    const radius = scale * (16 + 16 * Math.sqrt(Math.min(force, 3)));
    const [r, g, b] = colour("--accent");
    const glow = pen.createRadialGradient(x, y, radius * 0.2, x, y, radius * 2.2);
    glow.addColorStop(0, `rgba(${r}, ${g}, ${b}, 0.55)`);
    glow.addColorStop(1, `rgba(${r}, ${g}, ${b}, 0)`);
    pen.fillStyle = glow;
    pen.beginPath();
    pen.arc(x, y, radius * 2.2, 0, 2 * Math.PI);
    pen.fill();
    pen.lineWidth = 2 * scale;
    pen.strokeStyle = "rgba(255, 255, 255, 0.95)";
    pen.beginPath();
    pen.arc(x, y, radius, 0, 2 * Math.PI);
    pen.stroke();
    pen.lineWidth = 4 * scale;
    pen.strokeStyle = `rgb(${r}, ${g}, ${b})`;
    pen.beginPath();
    pen.arc(x, y, radius, -Math.PI / 2, -Math.PI / 2 + 2 * Math.PI * Math.min(speed / 300, 1));
    pen.stroke();
  }
}
