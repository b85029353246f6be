// The page's pad: what sounds, with the lamp, and with the words of a first visit.

import { isBlind } from "../comparing.ts";
import { wake } from "../engine.ts";
import { present } from "../state.ts";
import { coverage, pictured, sounding } from "../shadow.ts";
import { FirstWords } from "./first-words.tsx";
import { LampHandle } from "./lamp.tsx";
import { PadSurface } from "./pad-surface.tsx";

export function Pad() {
  const name = isBlind.value ? "a blind test" : sounding.value?.texture.name ?? present.value?.name ?? "no texture";
  return (
    <PadSurface name={name} isOutside={!coverage.value.inside} shown={{ sounding, pictured }} wake={wake}>
      <FirstWords />
      {!isBlind.value && <LampHandle />}
    </PadSurface>
  );
}
