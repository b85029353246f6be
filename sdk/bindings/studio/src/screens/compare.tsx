// Compare: two textures on one key, blind trials, and what is felt of the difference.

import { useEffect } from "preact/hooks";
import type { RecordedLoop } from "htex";

import { AgainstRecording } from "../parts/against-recording.tsx";
import { Difference } from "../parts/difference.tsx";
import { Icon } from "../parts/icons.tsx";
import { Name } from "../parts/name.tsx";
import { save } from "../save.ts";
import { nameOf } from "./shape.tsx";
import { abandon, answer, beginTest, both, chance, choices, correct, heardSide, isMatched, isTesting, play, playX, sides, stop, toCsv, trials, TRIALS, type Side } from "../comparing.ts";

function Chooser({ side }: { side: Side }) {
  return (
    <label class="field">
      {side.toUpperCase()}
      <select value={sides.value[side]} disabled={isTesting.value} onChange={(event) => (sides.value = { ...sides.peek(), [side]: event.currentTarget.value })}>
        {choices.value.map(({ id, name }) => (
          <option key={id} value={id}>
            {name}
          </option>
        ))}
      </select>
    </label>
  );
}

/** What a side does that plays a recording. */
function AsRecorded({ of }: { of: RecordedLoop | undefined }) {
  if (!of) return null;
  const { speed, force } = of.condition;
  const at = [speed === null ? "" : `${speed.toFixed(0)} mm/s`, force === null ? "" : `${force.toFixed(2)} N`].filter(Boolean).join(" and ");
  return (
    <p class="soft small">
      It plays as it was recorded{at && `, at ${at}`}, {(of.samples.length / of.rate_hz).toFixed(1)} s again and again, while the finger slides; it does not follow the finger. For a fair comparison slide steadily{at && ", as fast and with this force"}.
    </p>
  );
}

function Play({ side, name }: { side: Side | "x"; name: string }) {
  const isHeard = heardSide.value === side;
  return (
    <button class="side" aria-pressed={isHeard} onClick={() => (side === "x" ? playX() : play(side))}>
      <b>{side.toUpperCase()}</b>
      <span>
        <Name>{name}</Name>
        {isHeard && ", plays"}
      </span>
    </button>
  );
}

function Result() {
  const count = trials.value.length;
  if (count === 0) return null;
  const right = correct.value;
  if (count < TRIALS) return <p role="status">{count} of {TRIALS} answered.</p>;
  const p = chance(right, count);
  return (
    <div class="stack" role="status">
      <p>
        <b>{right} of {count} right</b>, p = {p < 0.001 ? "< 0.001" : p.toFixed(3)}.{" "}
        {p < 0.05 ? "Guessing is this good in fewer than one of twenty tests: you tell them apart." : "Guessing would do as well: nothing shows that you tell them apart."}
      </p>
      <ol class="trials">
        {trials.value.map(({ x, answer: given }, i) => (
          <li key={i}>{x === given ? "right" : "wrong"}</li>
        ))}
      </ol>
      <button class="button" onClick={() => save(new TextEncoder().encode(toCsv()), "abx.csv", "text/csv")}>
        Save as CSV
      </button>
    </div>
  );
}

function Abx() {
  return (
    <div class="panel stack">
      <h2>Blind test</h2>
      <p class="soft small">Ten times X is A or B, drawn anew. Say which. Slide, or press To and fro.</p>
      {isTesting.value ? (
        <>
          <Play side="x" name="the unknown one" />
          <div class="row">
            <button class="button strong" onClick={() => answer("a")}>X is A</button>
            <button class="button strong" onClick={() => answer("b")}>X is B</button>
            <button class="button" onClick={abandon}>Stop the test</button>
          </div>
        </>
      ) : (
        <button class="button strong" onClick={beginTest}>
          Begin ten trials
        </button>
      )}
      <Result />
    </div>
  );
}

/** One key changes sides. */
function keys(event: KeyboardEvent) {
  const isText = event.target instanceof HTMLInputElement && event.target.type !== "range";
  if (isText || event.ctrlKey || event.metaKey || event.altKey || event.key.toLowerCase() !== "c") return;
  play(heardSide.peek() === "b" ? "a" : "b");
}

export function Compare() {
  useEffect(() => {
    addEventListener("keydown", keys);
    return () => {
      removeEventListener("keydown", keys);
      abandon();
    };
  }, []);
  const { a, b } = both.value;
  return (
    <section aria-labelledby="compare-title">
      <header class="screen-head">
        <div>
          <h1 id="compare-title">Compare</h1>
          <p>
            The key <kbd>C</kbd> changes between A and B, with a cross-fade of 20 ms.
          </p>
        </div>
        <div class="row">
          <label class="check">
            <input type="checkbox" checked={isMatched.value} onChange={(event) => (isMatched.value = event.currentTarget.checked)} /> Match levels
          </label>
          <button class="button" disabled={!heardSide.value} onClick={stop}>
            <Icon name="stop" /> Neither
          </button>
        </div>
      </header>
      <div class="columns">
        <div class="panel stack">
          <Chooser side="a" />
          <Play side="a" name={a?.name ?? ""} />
          <AsRecorded of={a?.loop} />
        </div>
        <div class="panel stack">
          <Chooser side="b" />
          <Play side="b" name={b?.name ?? ""} />
          <AsRecorded of={b?.loop} />
        </div>
      </div>
      <div class="columns below">
        <Difference />
        <Abx />
      </div>
      <AgainstRecording nameOf={nameOf} />
    </section>
  );
}
