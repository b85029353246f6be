// The last steps of the work as small spectra. A step plays while it is looked at, and a press goes there.
//
// A history has up to 500 textures. Only those that are shown are opened, one after another between other work, and each is freed as soon
// as its outline is drawn.

import { effect, signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import { open, type Texture } from "htex";

import { auditionPresent, endAudition, onLook } from "../audition.ts";
import { isBlind } from "../comparing.ts";
import { near } from "../conditions.ts";
import { tried, type Sounding } from "../engine.ts";
import { documents, type Document } from "../history.ts";
import { LINE_HEIGHT, LINE_WIDTH, fineSpectrum, outline } from "../look/spectrum-line.ts";
import { sliders } from "../motion.ts";
import { whenFree } from "../slices.ts";
import { fail, history, visit } from "../state.ts";
import { Icon } from "./icons.tsx";

/** Steps that are shown. */
const SHOWN = 12;
/** Steps before the present one that are shown in any case, so that each press can lead further back. */
const SHOWN_BEFORE = 2;
/** Milliseconds for which a change is waited for to end. A drag makes another texture in each frame. */
const SETTLES_MS = 300;
/** Milliseconds for which a step is looked at before it plays. Pointers pass here on their way to other buttons. */
const RESTS_MS = 150;

/** Small windows have no room for the strip, unless it is unfolded. */
const large = matchMedia("(min-width: 1100px) and (min-height: 760px)");
const isUnfolded = signal(large.matches);
large.addEventListener("change", () => (isUnfolded.value = large.matches));

/** The history and the sliders, once they rest. */
const settled = signal({ history: history.peek(), sliders: sliders.peek() });
let timer = 0;

effect(() => {
  const now = { history: history.value, sliders: sliders.value };
  clearTimeout(timer);
  const isResting = now.history.gesture === null && now.sliders === settled.peek().sliders;
  if (isResting) settled.value = now;
  else timer = window.setTimeout(() => (settled.value = now), SETTLES_MS);
});

/** Textures of steps that are tried, with the ids of the steps. */
const heard = new Map<Texture, string>();

effect(() => {
  const now = tried.value?.texture;
  for (const texture of heard.keys()) {
    if (texture === now) continue;
    heard.delete(texture);
    // Others look at it until they, too, were told that something else is tried.
    queueMicrotask(() => texture.free());
  }
});

async function opened({ bytes, model }: Document) {
  const texture = await open(bytes);
  return { texture, model: texture.models.includes(model) ? model : texture.models[0] ?? "" };
}

/** Opens a step to be heard: as loud as it is on the pad. */
async function listen(document: Document): Promise<Sounding> {
  const now = await opened(document);
  heard.set(now.texture, document.id);
  // If nobody looks at it any more, it is not tried.
  setTimeout(() => {
    if (tried.peek()?.texture !== now.texture && heard.delete(now.texture)) now.texture.free();
  });
  return { ...now, gain: document.origin.gain };
}

/** Puts a step on the pad. */
async function take({ id }: Document) {
  await visit(id);
  auditionPresent();
}

/** The outline of a step; empty until it is drawn. */
function useOutline(document: Document) {
  const [path, setPath] = useState("");
  const isOfOne = useRef(false);
  const { sliders: at } = settled.value;
  const draw = async () => {
    const { texture, model } = await opened(document);
    try {
      isOfOne.current = texture.conditions.length < 2;
      setPath(outline(fineSpectrum(texture, model, near(texture, model, at).at)));
    } finally {
      texture.free();
    }
  };
  // The outline follows the sliders only if there are several conditions. What cannot be opened has none; it is told why when it is pressed.
  useEffect(() => (isOfOne.current ? undefined : whenFree(() => draw().catch(() => {}))), [at]);
  return path;
}

function Step({ document, index, present }: { document: Document; index: number; present: number }) {
  const path = useOutline(document);
  const isHere = index === present;
  const place = useRef<HTMLButtonElement>(null);
  useEffect(() => {
    if (isHere) place.current?.scrollIntoView({ block: "nearest", inline: "nearest" });
  }, [isHere]);
  const leave = () => {
    const now = tried.peek();
    if (now && heard.get(now.texture) === document.id) endAudition();
  };
  // A step that is gone is not left by the pointer.
  useEffect(() => leave, []);
  const state = isHere ? ", now" : index > present ? ", undone" : "";
  // During a blind test, nothing else may play.
  const looks = isBlind.value ? {} : onLook(() => listen(document), RESTS_MS);
  return (
    <li>
      <button
        class={index > present ? "step undone" : "step"}
        ref={place}
        aria-current={isHere ? "step" : undefined}
        aria-label={`Step ${index + 1}${state}: ${document.change}`}
        title={`${document.change}${state}`}
        tabIndex={isHere ? 0 : -1}
        disabled={isBlind.value}
        {...looks}
        onClick={() => take(document).catch(fail)}
      >
        <svg class="step-outline" viewBox={`0 0 ${LINE_WIDTH} ${LINE_HEIGHT}`} preserveAspectRatio="none" aria-hidden="true">
          <path d={path} />
        </svg>
        <span class="step-change">{document.change}</span>
      </button>
    </li>
  );
}

/** Arrow keys go through the steps. */
function arrows(event: KeyboardEvent) {
  const steps = [...(event.currentTarget as HTMLElement).querySelectorAll("button")];
  const at = steps.indexOf(document.activeElement as HTMLButtonElement);
  const to = { ArrowLeft: at - 1, ArrowRight: at + 1, Home: 0, End: steps.length - 1 }[event.key];
  if (at < 0 || to === undefined) return;
  event.preventDefault();
  steps[to]?.focus();
}

/** The button that folds the strip and unfolds it. */
export function StripButton() {
  const text = isUnfolded.value ? "Hide the last steps" : "Show the last steps";
  return (
    <button class="icon-button" aria-expanded={isUnfolded.value} aria-label="Last steps" title={text} onClick={() => (isUnfolded.value = !isUnfolded.value)}>
      <Icon name="steps" />
    </button>
  );
}

export function Strip() {
  if (!isUnfolded.value) return null;
  const now = settled.value.history;
  const all = documents(now);
  const present = now.past.length;
  const first = Math.max(0, Math.min(all.length - SHOWN, present - SHOWN_BEFORE));
  return (
    <ol class="strip" aria-label="Last steps" onKeyDown={arrows}>
      {all.slice(first, first + SHOWN).map((document, i) => (
        <Step key={document.id} document={document} index={first + i} present={present} />
      ))}
    </ol>
  );
}
