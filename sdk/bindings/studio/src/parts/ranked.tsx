// Models of a texture, by what is felt of the difference from what they were fitted to.

import type { FeltError } from "htex";

import { words } from "./difference.tsx";
import { fail } from "../state.ts";
import { nameOf } from "../screens/shape.tsx";

interface Fitted {
  readonly model: string;
  readonly bytes: number;
  readonly felt: FeltError | null;
}

function told(error: FeltError | null, isRecorded: boolean) {
  if (!error) return "not measured";
  const own = isRecorded && error.within_repeatability ? " It is as near as the recording is to itself." : "";
  return words(error) + own;
}

interface Props {
  ranked: readonly string[];
  models: readonly Fitted[];
  /** Whether they were fitted to a touch, which another touch would differ from. */
  isRecorded: boolean;
  onPad: (model: string) => Promise<void>;
}

export function RankedModels({ ranked, models, isRecorded, onPad }: Props) {
  return (
    <ol class="ranked">
      {ranked.map((id, i) => {
        const one = models.find(({ model }) => model === id);
        return (
          <li key={id}>
            <div>
              <b>{nameOf(id)}</b> <span class="soft small">{one?.bytes} bytes</span>
              <p class="small">{told(one?.felt ?? null, isRecorded)}</p>
            </div>
            <button class={i === 0 ? "button strong" : "button"} onClick={() => onPad(id).catch(fail)}>
              To the pad
            </button>
          </li>
        );
      })}
    </ol>
  );
}
