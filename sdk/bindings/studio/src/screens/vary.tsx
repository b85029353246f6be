// Vary: nine textures near the present one; a press takes one.

import { useEffect } from "preact/hooks";

import { endAudition, onLook } from "../audition.ts";
import { KeepsOne } from "../parts/keeps-one.tsx";
import { Name } from "../parts/name.tsx";
import { Picture } from "../parts/picture.tsx";
import { Slider } from "../parts/slider.tsx";
import { fail, present, say } from "../state.ts";
import { isTouch } from "../theme.ts";
import { again, keepVarying, reach, takeVariation, variations, type Variation } from "../varying.ts";

async function take(variation: Variation) {
  endAudition();
  await takeVariation(variation);
  say(`You took “${variation.text}”. Here are nine textures near it.`);
}

function Card({ variation, index }: { variation: Variation; index: number }) {
  const { texture, model, text } = variation;
  return (
    <li>
      <button class="card" aria-label={`Variation ${index + 1}: ${text}`} {...onLook(() => ({ texture, model }))} onClick={() => take(variation).catch(fail)}>
        <Picture texture={texture} model={model} />
        <span class="card-name">{text}</span>
      </button>
    </li>
  );
}

export function Vary() {
  useEffect(() => {
    const end = keepVarying();
    return () => {
      endAudition();
      end();
    };
  }, []);
  return (
    <section aria-labelledby="vary-title">
      <header class="screen-head">
        <div>
          <h1 id="vary-title">Vary</h1>
          <p>Nine textures near {present.value ? <Name>{present.value.name}</Name> : "the one on the pad"}. {isTouch.value ? "Tap one to take it." : "Hover over one to hear it. Click to take it."}</p>
        </div>
        <button class="button" onClick={() => again().catch(fail)}>
          Show nine others
        </button>
      </header>
      <KeepsOne />
      <div class="panel narrow">
        <Slider label="How far" min={0.1} max={1} step={0.01} value={reach.value} onValue={(value) => (reach.value = value)} onSettled={() => again().catch(fail)} />
      </div>
      <ul class="cards nine">
        {variations.value.map((variation, i) => (
          <Card key={variation.texture} variation={variation} index={i} />
        ))}
      </ul>
    </section>
  );
}
