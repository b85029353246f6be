// Mix: four textures in the corners of a pad.

import { useEffect, useRef } from "preact/hooks";

import { isolated } from "../names.ts";
import { MixPicture } from "../parts/mix-picture.tsx";
import { Slider } from "../parts/slider.tsx";
import { chosen, corners, endListening, listen, onPad, parts, place, takeMixture } from "../mixing.ts";
import { items } from "../shelf.ts";
import { fail, present, say } from "../state.ts";

const NAMES = ["upper left", "upper right", "lower left", "lower right"];

function Corner({ index }: { index: number }) {
  const choose = (id: string) => {
    corners.value = corners.peek().map((own, i) => (i === index ? id : own));
    listen().catch(fail);
  };
  const own = chosen.value[index];
  // The texture on the pad has at most one corner.
  const isOffered = own === "" || !chosen.value.includes("");
  return (
    <label class={`corner corner-${index}`}>
      <span class="hidden">Texture {NAMES[index]}</span>
      <select value={own} onChange={(event) => choose(event.currentTarget.value)}>
        {isOffered && <option value="">{present.value ? isolated(present.value.name) : "the present texture"} (on the pad)</option>}
        {items.value.filter(({ id }) => id !== onPad.value).map(({ id, name }) => (
          <option key={id} value={id}>
            {isolated(name)}
          </option>
        ))}
      </select>
      <span class="corner-part">{Math.round(100 * (parts.value[index] ?? 0))} %</span>
    </label>
  );
}

function move(x: number, y: number) {
  const clamp = (part: number) => Math.min(Math.max(part, 0), 1);
  place.value = { x: clamp(x), y: clamp(y) };
  listen().catch(fail);
}

function Square() {
  const square = useRef<HTMLDivElement>(null);
  const isHeld = useRef(false);
  const to = (event: PointerEvent) => {
    const box = square.current?.getBoundingClientRect();
    if (box) move((event.clientX - box.left) / box.width, (event.clientY - box.top) / box.height);
  };
  const down = (event: PointerEvent) => {
    isHeld.current = true;
    square.current?.setPointerCapture(event.pointerId);
    to(event);
  };
  const { x, y } = place.value;
  return (
    <div
      ref={square}
      class="mix-square"
      onPointerDown={down}
      onPointerMove={(event) => isHeld.current && to(event)}
      onPointerUp={() => (isHeld.current = false)}
      onPointerCancel={() => (isHeld.current = false)}
    >
      <MixPicture />
      <span class="mix-knob" style={{ left: `${100 * x}%`, top: `${100 * y}%` }} />
    </div>
  );
}

async function take() {
  await takeMixture();
  say("The mixture is on the pad. Undo brings back the texture before it.", "good");
}

export function Mix() {
  useEffect(() => {
    listen().catch(fail);
    return endListening;
  }, []);
  const { x, y } = place.value;
  return (
    <section aria-labelledby="mix-title">
      <header class="screen-head">
        <div>
          <h1 id="mix-title">Mix</h1>
          <p>Choose four textures and drag the knob between them. The mixture is a free curve (Bands), and its file names the four textures.</p>
        </div>
        <button class="button strong" onClick={() => take().catch(fail)}>
          Take this mixture
        </button>
      </header>
      <div class="mix">
        <Corner index={0} />
        <Corner index={1} />
        <Square />
        <Corner index={2} />
        <Corner index={3} />
      </div>
      <div class="panel stack narrow">
        <Slider label="Across" min={0} max={1} step={0.01} value={x} onValue={(value) => move(value, y)} />
        <Slider label="Down" min={0} max={1} step={0.01} value={y} onValue={(value) => move(x, value)} />
      </div>
    </section>
  );
}
