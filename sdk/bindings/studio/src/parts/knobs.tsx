// The four knobs: how the texture on the pad feels, in words.

import { endChange } from "../audition.ts";
import { isBlind } from "../comparing.ts";
import { isolated } from "../names.ts";
import { limits, removeLimits } from "../shaping/limits.ts";
import { canTurn } from "../shaping/session.ts";
import type { Macros } from "../shaping/shaper.ts";
import { endTurn, knobs, prepareToTurn, turn } from "../shaping/turning.ts";
import { present } from "../state.ts";
import { isTouch } from "../theme.ts";
import { Icon } from "./icons.tsx";
import { Knob } from "./knob.tsx";

interface Felt {
  readonly id: keyof Macros;
  readonly name: string;
  readonly ends: readonly [string, string];
  /** How the texture becomes in each direction. */
  readonly becomes: readonly [string, string];
  readonly what: string;
}

const KNOBS: readonly Felt[] = [
  { id: "rougher", name: "Rougher", ends: ["smooth", "rough"], becomes: ["smoother", "rougher"], what: "less or more below 100 Hz" },
  { id: "brighter", name: "Brighter", ends: ["dull", "crisp"], becomes: ["duller", "crisper"], what: "less or more above 300 Hz" },
  { id: "peak", name: "Peak", ends: ["coarse", "fine"], becomes: ["coarser", "finer"], what: "the peak moves by up to an octave" },
  { id: "level", name: "Level", ends: ["faint", "strong"], becomes: ["fainter", "stronger"], what: "by up to 14 dB" },
];

/** Parts of a turn up to which it is "a little", and from which it is "much". */
const [LITTLE, MUCH] = [0.34, 0.67];

function textOf({ becomes: [less, more] }: Felt, value: number) {
  if (value === 0) return "unchanged";
  const far = Math.abs(value);
  return `${far < LITTLE ? "a little " : far < MUCH ? "" : "much "}${value < 0 ? less : more}`;
}

/** What limits the knobs. It is set on the curve, but the knobs are on every screen. */
function Limited() {
  const { locked, range } = limits.value;
  if (!range && locked.size === 0) return null;
  const parts = [range && `only ${range[0].toFixed(0)} to ${range[1].toFixed(0)} Hz`, locked.size > 0 && `${locked.size} locked`].filter(Boolean).join(", ");
  return (
    <button class="chip knobs-limited" aria-label={`Change everything again; now ${parts}`} onClick={removeLimits}>
      {parts.charAt(0).toUpperCase() + parts.slice(1)} <Icon name="close" />
    </button>
  );
}

export function Knobs() {
  const how = isTouch.value ? "" : " Drag up or down, with Shift in fine steps. Double-click to reset.";
  const isOff = !present.value || isBlind.value;
  return (
    <div class="knobs" role="group" aria-label={`How ${present.value ? isolated(present.value.name) : "the texture"} feels`} onFocusOut={endChange}>
      {KNOBS.map((one) => {
        const value = knobs.value[one.id];
        const isHeld = !canTurn(one.id);
        return (
          <Knob
            key={one.id}
            name={one.name}
            ends={one.ends}
            value={value}
            text={textOf(one, value)}
            title={isHeld ? "What this knob changes is locked." : `${one.ends.join(" to ")}: ${one.what}.${how}`}
            disabled={isOff || isHeld}
            onNear={prepareToTurn}
            onTurn={(next) => turn(one.id, next)}
            onSettled={endTurn}
          />
        );
      })}
      <Limited />
    </div>
  );
}
