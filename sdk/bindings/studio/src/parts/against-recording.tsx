// The recording against each model that was fitted to it.

import { nameOf } from "../author.ts";
import { isLevelKnown } from "../level.ts";
import { rankedBy } from "../ranking.ts";
import { presentWork } from "../reference.ts";
import { isBlind, sides } from "../comparing.ts";
import { texture } from "../state.ts";

export function AgainstRecording() {
  const work = presentWork.value;
  const [recording, now] = [work?.names[0], texture.value];
  if (!work || !now || recording === undefined) return null;
  const hasModel = (id: string) => now.models.includes(id);
  const { ranked, told } = rankedBy(work.report, isLevelKnown(now));
  return (
    <div class="panel stack below">
      <h2>The recording against each model</h2>
      <ol class="ranked">
        {ranked.map((id) => (
          <li key={id}>
            <div>
              <b>{nameOf(id)}</b>
              <p class="small">{told(id)}</p>
            </div>
            {hasModel(id) && (
              <button class="button" disabled={isBlind.value} onClick={() => (sides.value = { a: `recording ${recording}`, b: `model ${id}` })}>
                Compare by ear
              </button>
            )}
          </li>
        ))}
      </ol>
    </div>
  );
}
