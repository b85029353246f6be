// The recording against each model that was fitted to it.

import { words } from "./difference.tsx";
import { fitted } from "../recordings.ts";
import { presentWork } from "../reference.ts";
import { sides } from "../comparing.ts";
import { texture } from "../state.ts";

export function AgainstRecording({ nameOf }: { nameOf: (id: string) => string }) {
  const report = fitted.value?.report;
  const recording = presentWork.value?.names[0];
  if (!report || recording === undefined) return null;
  const hasModel = (id: string) => texture.value?.models.includes(id);
  return (
    <div class="panel stack below">
      <h2>The recording against each model</h2>
      <ol class="ranked">
        {report.ranked.map((id) => {
          const felt = report.models.find(({ model }) => model === id)?.felt;
          return (
            <li key={id}>
              <div>
                <b>{nameOf(id)}</b>
                <p class="small">
                  {felt ? words(felt) : "Not measured."} {felt?.within_repeatability && "It is as near as the recording is to itself."}
                </p>
              </div>
              {hasModel(id) && (
                <button class="button" onClick={() => (sides.value = { a: `recording ${recording}`, b: `model ${id}` })}>
                  Compare by ear
                </button>
              )}
            </li>
          );
        })}
      </ol>
    </div>
  );
}
