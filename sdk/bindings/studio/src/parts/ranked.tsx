// Models of a texture, the best first.

import type { FitReport } from "htex";

import { nameOf } from "../author.ts";
import { rankedBy } from "../ranking.ts";
import { fail } from "../state.ts";

interface Props {
  report: Pick<FitReport, "ranked"> & { models: readonly Omit<FitReport["models"][number], "fit_ms">[] };
  /** Whether they were fitted to a touch, which another touch would differ from. */
  isRecorded: boolean;
  /** Whether the level is one of what was recorded: only then is something said of what is felt. */
  isLevelKnown?: boolean;
  onPad: (model: string) => Promise<void>;
}

export function RankedModels({ report, isRecorded, isLevelKnown = true, onPad }: Props) {
  const { ranked, told } = rankedBy(report, isLevelKnown, isRecorded);
  return (
    <ol class="ranked">
      {ranked.map((id, i) => (
        <li key={id}>
          <div>
            <b>{nameOf(id)}</b> <span class="soft small">{report.models.find(({ model }) => model === id)?.bytes} bytes</span>
            <p class="small">{told(id)}</p>
          </div>
          <button class={i === 0 ? "button strong" : "button"} onClick={() => onPad(id).catch(fail)}>
            To the pad
          </button>
        </li>
      ))}
    </ol>
  );
}
