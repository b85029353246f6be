// Appearance: how the texture looks wherever it is shown. The file states what is set here.

import { theAuthor } from "../author.ts";
import { EXTENSION, MOST, PATTERNS, stated, tidy, type Appearance as Look, type Part, type Pattern } from "../look/appearance.ts";
import { appearanceOf } from "../look/guess.ts";
import { edit, fail, present, settle, texture } from "../state.ts";
import { Picture } from "./picture.tsx";
import { Slider } from "./slider.tsx";

const PARTS: { id: Part; name: string }[] = [
  { id: "hue_deg", name: "Hue" },
  { id: "saturation", name: "Saturation" },
  { id: "lightness", name: "Lightness" },
  { id: "gloss", name: "Gloss" },
  { id: "relief", name: "Relief" },
];

const NAMES: Record<Pattern, string> = { grain: "Grain", ridges: "Ridges", fibres: "Fibres", weave: "Weave", bumps: "Bumps" };

/** Writes a change into the texture, or with null removes its appearance. Changes of one part are one step until the hand lets go. */
async function apply(change: Partial<Look> | null) {
  const made = await theAuthor();
  const [now, document] = [texture.peek(), present.peek()];
  if (!now || !document) return;
  const next = change && tidy({ ...appearanceOf(now), ...change });
  const edited = made.edit(now, { extensions: { [EXTENSION]: next } });
  edit({ texture: edited, bytes: edited.toBytes(), model: document.model, change: "appearance" }, `appearance ${Object.keys(change ?? {}).join()}`);
}

let writing: Promise<unknown> = Promise.resolve();

/** One change is written after the other, because the author module may have yet to be loaded. */
const write = (change: Partial<Look> | null) => (writing = writing.then(() => apply(change)).catch(fail));
const settled = () => writing.then(settle);

export function Appearance() {
  const [now, model] = [texture.value, present.value?.model];
  if (!now || !model) return null;
  const look = appearanceOf(now);
  const isStated = stated(now.manifest) !== null;
  const set = (change: Partial<Look> | null) => (write(change), settled());
  return (
    <div class="appearance stack" role="group" aria-labelledby="appearance-title">
      <h2 id="appearance-title">Appearance</h2>
      <Picture texture={now} model={now.models.includes(model) ? model : now.models[0] ?? model} />
      {PARTS.map(({ id, name }) => (
        <Slider key={id} label={name} unit={id === "hue_deg" ? "°" : ""} digits={id === "hue_deg" ? 0 : 2} min={0} max={MOST[id]} step={MOST[id] / (id === "hue_deg" ? 360 : 100)} value={look[id]} onValue={(value) => write({ [id]: value })} onSettled={settled} />
      ))}
      <div class="segments" role="group" aria-label="Pattern">
        {PATTERNS.map((pattern) => (
          <button key={pattern} aria-pressed={look.pattern === pattern} onClick={() => set({ pattern })}>
            {NAMES[pattern]}
          </button>
        ))}
      </div>
      <p class="small soft">
        The appearance changes only the picture, not what you feel. {isStated ? "The file states it." : "The page guesses it from the tags and the spectrum until you set it."}
      </p>
      {isStated && (
        <button class="button" onClick={() => set(null)}>
          Guess it again
        </button>
      )}
    </div>
  );
}
