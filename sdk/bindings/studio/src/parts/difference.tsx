// What is felt of the difference of two textures, in words and by third octaves.

import type { Felt } from "htex";

import { author, theAuthor } from "../author.ts";
import { both } from "../comparing.ts";
import { isLevelKnown } from "../level.ts";
import { pilotForce, pilotSpeed } from "../motion.ts";
import { presentWork } from "../reference.ts";
import { fail } from "../state.ts";

/** The sentence for what is felt. */
export function words({ below_detection_threshold, below_difference_threshold, below_if_sensitive, largest_error_db, total_error_db }: Pick<Felt, "below_detection_threshold" | "below_difference_threshold" | "below_if_sensitive" | "largest_error_db" | "total_error_db">, which = "it") {
  if (below_detection_threshold) return "The texture itself is too weak to be felt, so no difference from it can be judged.";
  if (below_if_sensitive) return "Even a sensitive finger feels no difference.";
  if (below_difference_threshold) return "A finger feels no difference. A sensitive finger may feel one.";
  const whole = Math.abs(total_error_db) < 0.05 ? "" : ` Altogether, ${which} is ${Math.abs(total_error_db).toFixed(1)} dB ${total_error_db > 0 ? "stronger" : "weaker"}.`;
  return `A difference is felt. In the third octave with the largest difference, it is ${largest_error_db.toFixed(1)} dB.${whole}`;
}

/** Why nothing can be said of what is felt: the full scale of a recording is not known. */
function unknownLevel() {
  const { a, b } = both.value;
  const unknown = [a, b].find((side) => side && !isLevelKnown(side.texture));
  return unknown ? `It is not known how strong ${unknown.texture.name} was when it was recorded. So the page cannot say what a finger feels.` : null;
}

function difference() {
  const made = author.value;
  const { a, b } = both.value;
  if (!made || !a || !b || a.loop || b.loop || unknownLevel()) return null;
  const at = { speed: pilotSpeed.value, force: pilotForce.value };
  return made.felt({ texture: a.texture, model: a.model, at }, { texture: b.texture, model: b.model, at });
}

const [WIDTH, HEIGHT, MOST_DB] = [560, 120, 20];

function Bars({ of }: { of: Felt }) {
  const step = WIDTH / of.centre_hz.length;
  const middle = HEIGHT / 2;
  return (
    <svg class="felt-bars" viewBox={`0 0 ${WIDTH} ${HEIGHT + 18}`} role="img" aria-label="Felt difference by third octave, B against A">
      <line x1="0" x2={WIDTH} y1={middle} y2={middle} />
      {of.error_db.map((db, i) => {
        const height = (Math.min(Math.abs(db), MOST_DB) / MOST_DB) * (middle - 4);
        return <rect key={i} x={i * step + 2} width={step - 4} y={db > 0 ? middle - height : middle} height={Math.max(height, 0.5)} rx="2" />;
      })}
      {of.centre_hz.map((hz, i) => i % 3 === 0 && (
        <text key={hz} x={i * step + step / 2} y={HEIGHT + 14} text-anchor="middle">
          {hz.toFixed(0)}
        </text>
      ))}
    </svg>
  );
}

/** What the fit measured of a model and its recordings; null unless one side is a recording. */
function ofRecording() {
  const { a, b } = both.value;
  const [recorded, other] = a?.loop ? [a, b] : [b, a];
  if (!recorded?.loop || !other) return null;
  const felt = presentWork.value?.report.models.find(({ model }) => model === other.model && other.texture === recorded.texture && !other.loop)?.felt;
  return felt ? `${words(felt)} All recordings against the model as it was fitted, at the condition where most is felt.` : "The difference between a recording and this side was not measured. Choose a model of this texture as the other side.";
}

export function Difference() {
  if (!author.value) theAuthor().catch(fail);
  const found = difference();
  const told = unknownLevel() ?? ofRecording();
  return (
    <div class="panel stack">
      <h2>The difference that a finger feels</h2>
      {found ? (
        <>
          <p>{words(found, "B")}</p>
          <Bars of={found} />
          <p class="soft small">
            B against A at {pilotSpeed.value.toFixed(0)} mm/s and {pilotForce.value.toFixed(2)} N, in third octaves (Hz). A bar upwards means that B is stronger, by up to {MOST_DB} dB. Vibrations below the published detection thresholds of a resting finger do not count.
          </p>
        </>
      ) : (
        <p class={told ? "" : "soft"}>{told ?? (both.value.a && both.value.b ? "…" : "Choose two textures.")}</p>
      )}
    </div>
  );
}
