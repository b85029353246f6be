// What stands above: the texture's name, undo and redo, the two versions, the sound, and the last steps.

import { isBlind } from "../comparing.ts";
import { audible, sound, toggleSound, volume } from "../engine.ts";
import { isUnsaved, toSave } from "../giving.ts";
import { depth, present } from "../state.ts";
import { refusal } from "../store.ts";
import { isNarrow, isTouch } from "../theme.ts";
import { FeelOn } from "./feel-on.tsx";
import { hinted } from "./hint.tsx";
import { Icon } from "./icons.tsx";
import { Name } from "./name.tsx";
import { Strip } from "./strip.tsx";
import { Versions } from "./versions.tsx";

function Sound() {
  const isOn = sound.value === "on";
  return (
    <div class="group">
      <button class="icon-button" aria-pressed={isOn} aria-label="Sound" title={isOn ? `Sound is on. Use headphones, because small loudspeakers play no low frequencies.${isTouch.value ? "" : " Press Esc for silence."}` : "Turn the sound on"} onClick={toggleSound}>
        <Icon name={isOn ? "sound" : "muted"} />
      </button>
      <input class="volume" type="range" min="0" max="1" step="0.01" aria-label="Volume" value={volume.value} onInput={(event) => (volume.value = event.currentTarget.valueAsNumber)} />
      <button class="toggle" aria-pressed={audible.value} disabled={isBlind.value} title="Plays all frequencies four times as high, for small loudspeakers. A finger would feel the original frequencies." onClick={() => (audible.value = !audible.value)}>
        <span>
          <span class="wide">Audible </span>×4{audible.value && " on"}
        </span>
      </button>
    </div>
  );
}

export function Top() {
  return (
    <header class="top">
      <span class="brand">
        <svg class="logo" viewBox="0 0 32 32" aria-hidden="true">
          <path d="M3 20c5 0 5-11 9-11s3 10 7 10 3-5 10-5" />
        </svg>
        <span class="brand-name">htex studio</span>
      </span>
      <span class="piece" title={present.value ? `${depth.value} steps can be undone` : ""}>
        {present.value ? <Name>{present.value.name}</Name> : "…"}
        {present.value && isUnsaved.value && <small> · edited</small>}
        {refusal.value && <small title={refusal.value}> · not stored</small>}
      </span>
      {!isNarrow.value && <Versions />}
      <Sound />
      <FeelOn />
      <button class={hinted.value === "keep" ? "toggle roomy hinted" : "toggle roomy"} title="Give it a name and save it as a file" onClick={toSave}>
        <Icon name="give" /> Save…
      </button>
      <Strip />
    </header>
  );
}
