// Compare: two textures on one key, blind trials, and the difference that a finger feels.

import { useEffect } from "preact/hooks";
import type { RecordedLoop } from "htex";

import { AgainstRecording } from "../parts/against-recording.tsx";
import { Difference } from "../parts/difference.tsx";
import { Icon } from "../parts/icons.tsx";
import { Name } from "../parts/name.tsx";
import { Spoken, useSpoken } from "../parts/spoken.tsx";
import { save } from "../save.ts";
import { isTouch } from "../theme.ts";
import { abandon, answer, beginTest, chance, playX, result, toCsv, TRIALS, type Result } from "../blind-test.ts";
import { both, choices, heardSide, isBlind, isMatched, play, sides, stop, type Side } from "../comparing.ts";
import { fail } from "../state.ts";

function Chooser({ side }: { side: Side }) {
  return (
    <label class="field">
      {side.toUpperCase()}
      <select value={sides.value[side]} disabled={isBlind.value} onChange={(event) => (sides.value = { ...sides.peek(), [side]: event.currentTarget.value })}>
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
      It plays as it was recorded{at && `, at ${at}`}, {(of.samples.length / of.rate_hz).toFixed(1)} s again and again, while the finger slides. It does not follow the finger. For a fair comparison, slide steadily{at && " at this speed and force"}.
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

/** What the number of right answers means. */
function meaning(right: number, count: number) {
  if (chance(right, count) >= 0.05) return "Nothing shows that you can tell them apart: guessing often gives such a result.";
  if (right > count / 2) return "You can tell them apart: guessing is right this often in fewer than one of twenty tests.";
  return "You can tell them apart, but you take A for B and B for A: guessing is wrong this often in fewer than one of twenty tests.";
}

function SaveTable() {
  return (
    <button class="button" onClick={() => save(new TextEncoder().encode(toCsv()), "abx.csv", "text/csv")}>
      Save as CSV
    </button>
  );
}

function Results() {
  const found = result.value;
  if (!found || found.trials.length === 0) return null;
  const count = found.trials.length;
  if (count < TRIALS) return <p><Spoken text={`${count} of ${TRIALS} answered.`} /></p>;
  return found.isOther ? <OtherPair of={found} /> : <Outcome of={found} />;
}

function OtherPair({ of: { pair } }: { of: Result }) {
  return (
    <div class="stack">
      <p class="soft small">
        The last test compared {pair.a.name} with {pair.b.name}. Levels were {pair.isMatched ? "" : "not "}matched. Choose the same again to see the result.
      </p>
      <SaveTable />
    </div>
  );
}

function Outcome({ of: { pair, trials, right } }: { of: Result }) {
  const count = trials.length;
  useSpoken(`${right} of ${count} right.`);
  const p = chance(right, count);
  return (
    <div class="stack">
      <p>
        <b>{right} of {count} right</b>, p = {p < 0.001 ? "< 0.001" : p.toFixed(3)}. {meaning(right, count)}
      </p>
      <p class="soft small">
        A was {pair.a.name}, and B was {pair.b.name}. Levels were {pair.isMatched ? "" : "not "}matched. p is the probability that guessing gives a result at least this far from half right (two-sided binomial test).
      </p>
      <ol class="trials">
        {trials.map(({ x, answer: given }, i) => (
          <li key={i}>{x === given ? "right" : "wrong"}</li>
        ))}
      </ol>
      <SaveTable />
    </div>
  );
}

function Abx() {
  return (
    <div class="panel stack">
      <h2>Blind test</h2>
      <p class="soft small">
        In each of ten trials, X is either A or B at random. Say which one it is. Slide over the pad, or press <em>Back and forth</em>. Until the last answer, you cannot change the sides and the settings, and the pad does not show what plays.
      </p>
      {isBlind.value ? (
        <>
          <Play side="x" name="the unknown one" />
          <div class="row">
            <button class="button strong" onClick={() => answer("a")}>X is A</button>
            <button class="button strong" onClick={() => answer("b")}>X is B</button>
            <button class="button" onClick={abandon}>Stop the test</button>
          </div>
        </>
      ) : (
        <button class="button strong" onClick={() => beginTest().catch(fail)}>
          Begin ten trials
        </button>
      )}
      <Results />
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
            {isTouch.value ? "Tap A or B to hear it." : <>Press <kbd>C</kbd> to switch between A and B.</>} The sound cross-fades in 20 ms.
          </p>
        </div>
        <div class="row">
          <label class="check">
            <input type="checkbox" checked={isMatched.value} disabled={isBlind.value} onChange={(event) => (isMatched.value = event.currentTarget.checked)} /> Match levels
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
      <AgainstRecording />
    </section>
  );
}
