// Record: from recordings to a texture.

import { useEffect, useRef } from "preact/hooks";
import type { Columns, Finding, Notice, RecordedQuantity } from "htex";

import { author, nameOf } from "../author.ts";
import { QUANTITIES, unitOf } from "../columns.ts";
import { ColumnTable } from "../parts/column-table.tsx";
import { Details } from "../parts/details.tsx";
import { Icon } from "../parts/icons.tsx";
import { Name } from "../parts/name.tsx";
import { Notices } from "../parts/notices.tsx";
import { NumberField } from "../parts/number-field.tsx";
import { RankedModels } from "../parts/ranked.tsx";
import { Spoken } from "../parts/spoken.tsx";
import { ToSettings } from "../parts/to-settings.tsx";
import { Waveform } from "../parts/waveform.tsx";
import { READ, take } from "../drop.ts";
import { done, waiting } from "../imports.ts";
import { abort, asksScale, canFit, fitAll, fitted, haltReading, isFitOld, isLevelKnown, isStopped, keepReading, license, progress, read, reading, reads, recordings, state, stated, stateMotion, stateQuantity, toPad, type Read, type Stated } from "../recordings.ts";
import { fail } from "../state.ts";
import { isTouch } from "../theme.ts";
import { Imports } from "./import.tsx";

const SEVERITY = { error: "Error", warning: "Warning", info: "Note" };

function Found({ finding }: { finding: Finding }) {
  const more = author.value?.explain(finding.code);
  return (
    <li class={`finding ${finding.severity}`}>
      <details>
        <summary>
          <b>{SEVERITY[finding.severity]}:</b> {finding.message}
        </summary>
        <p class="small">{more?.explanation}</p>
        {more?.fix && <p class="small">What to do: {more.fix}</p>}
        <ToSettings names={finding.settings} />
        <p class="small soft">{finding.code}</p>
      </details>
    </li>
  );
}

/** Notices that no finding tells. That the scale is assumed is not told to those who have said that they do not know it. */
function beside(notices: Notice[], findings: Finding[]) {
  const isAsked = ({ settings }: Notice) => asksScale.value && settings.includes("scale");
  return notices.filter((notice) => !isAsked(notice) && !findings.some(({ code }) => notice.text.includes(code)));
}

/** They unfold where they are wanted, and do not fold while they are corrected. */
function ColumnsOf({ columns, isWanted }: { columns: Columns; isWanted: boolean }) {
  const place = useRef<HTMLDetailsElement>(null);
  useEffect(() => {
    if (isWanted && place.current) place.current.open = true;
  }, [isWanted]);
  return (
    <details ref={place}>
      <summary>
        <h2>Columns</h2>
      </summary>
      <ColumnTable columns={columns} />
    </details>
  );
}

function OneRead({ read: { recording, columns, processed, problem }, index }: { read: Read; index: number }) {
  const motion = stated.value.motions[index];
  return (
    <article class="panel stack">
      <h2>
        <Name>{recording.name}</Name>
      </h2>
      {problem && (
        <div>
          <p class="problem">
            <Icon name="warn" /> This recording cannot be read yet. Check what each column contains, what was recorded, and the rate.
          </p>
          <ToSettings names={["map", "quantity", "rate_hz"]} />
          <Details text={problem} />
        </div>
      )}
      {processed && (
        <>
          <Waveform processed={processed} />
          <p class="small soft">
            {processed.duration_s.toFixed(1)} s at {processed.rate_hz.toFixed(0)} Hz; {processed.segments} segments of {processed.from_sweeps ? "strokes" : "even windows"} are read (shaded)
            {processed.condition.speed !== null && `, at ${processed.condition.speed.toFixed(1)} mm/s`}
            {processed.condition.force !== null && ` and ${processed.condition.force.toFixed(2)} N`}.
          </p>
          <ul class="findings">
            {processed.findings.map((finding) => (
              <Found key={finding.code} finding={finding} />
            ))}
            <Notices notices={beside(processed.warnings, processed.findings)} kind="Warning" isAdvised />
            <Notices notices={beside(processed.notes, processed.findings)} kind="Note" isAdvised />
          </ul>
        </>
      )}
      <div class="fields">
        <NumberField label="Speed, mm/s" setting="speed_mm_s" value={motion?.speed} placeholder="as recorded" onValue={(speed) => stateMotion(index, { speed })} />
        <NumberField label="Force, N" setting="force_n" value={motion?.force} placeholder="as recorded" onValue={(force) => stateMotion(index, { force })} />
      </div>
      {columns && <ColumnsOf columns={columns} isWanted={problem !== null} />}
    </article>
  );
}

/** What full scale stands for: a number, or nobody knows. */
function FullScale() {
  const { isScaleKnown, scale, quantity } = stated.value;
  return (
    <fieldset class="question">
      <legend>How loud is full scale?</legend>
      <label class="check">
        <input type="radio" name="full-scale" checked={!isScaleKnown} onChange={() => state({ isScaleKnown: false })} /> I do not know
      </label>
      <label class="check">
        <input type="radio" name="full-scale" data-setting="scale" checked={isScaleKnown} onChange={() => state({ isScaleKnown: true })} /> I know:
      </label>
      {isScaleKnown && <NumberField label={`Full scale is, ${unitOf(quantity)}`} value={scale} min={null} isRequired onValue={(value) => state({ scale: value })} />}
      {!isLevelKnown.value && <p class="small soft">The page then compares shapes, and says nothing of what a finger feels. The texture states that its level is not known.</p>}
    </fieldset>
  );
}

const SEGMENTS: readonly [Stated["segments"], string][] = [
  ["auto", "strokes, or windows where there are few"],
  ["sweeps", "the middles of strokes"],
  ["windows", "even windows"],
];

function Settings() {
  const { quantity, rate, from, to, segments } = stated.value;
  return (
    <>
      <div class="fields">
        <label class="field">
          What was recorded
          <select data-setting="quantity" value={quantity} onChange={(event) => stateQuantity(event.currentTarget.value as RecordedQuantity)}>
            {QUANTITIES.map(({ id, name, unit }) => (
              <option key={id} value={id}>
                {name}, {unit}
              </option>
            ))}
          </select>
        </label>
        <NumberField label="Rate, Hz" setting="rate_hz" value={rate} placeholder="as recorded" onValue={(value) => state({ rate: value })} />
        <NumberField label="Read from, s" setting="from_s" value={from} placeholder="the beginning" onValue={(value) => state({ from: value })} />
        <NumberField label="Read to, s" setting="to_s" value={to} placeholder="the end" onValue={(value) => state({ to: value })} />
        <label class="field">
          What is read
          <select data-setting="segments" value={segments} onChange={(event) => state({ segments: event.currentTarget.value as Stated["segments"] })}>
            {SEGMENTS.map(([id, name]) => (
              <option key={id} value={id}>
                {name}
              </option>
            ))}
          </select>
        </label>
        <label class="field">
          Licence
          <input type="text" value={license.value} onInput={(event) => (license.value = event.currentTarget.value)} />
        </label>
      </div>
      {asksScale.value && <FullScale />}
    </>
  );
}

function FitPanel() {
  const now = progress.value;
  return (
    <div class="panel stack">
      <Settings />
      <div class="row">
        <button class="button strong" disabled={!canFit.value || now !== null} onClick={() => fitAll().catch(fail)}>
          Fit all models
        </button>
        {now && (
          <>
            <progress max={now.of} value={now.done} aria-label="Progress of the fit" />
            <Spoken text={now.text} />
            <button class="button" onClick={abort}>Stop</button>
          </>
        )}
      </div>
    </div>
  );
}

function Ranked() {
  const result = fitted.value;
  if (!result) return null;
  const { report } = result;
  return (
    <div class="panel stack">
      <h2>Models, by {result.isLevelKnown ? "what is felt" : "their shape"}</h2>
      {isFitOld.value && <p class="small" role="status">They were fitted before the settings were changed. Fit again to use the new ones.</p>}
      <RankedModels report={report} isRecorded isLevelKnown={result.isLevelKnown} onPad={toPad} />
      <ul class="findings">
        <Notices notices={beside(report.warnings, [])} kind="Warning" isAdvised />
        <Notices notices={beside(report.notes, [])} kind="Note" isAdvised />
        {report.skipped.map(({ model, reason }) => (
          <li key={model} class="finding">
            <b>{nameOf(model)} is left out:</b> {reason}
          </li>
        ))}
      </ul>
    </div>
  );
}

/** How far the reading is, or that it was stopped. */
function Reading() {
  const now = reading.value;
  if (!now) {
    if (!isStopped.value) return null;
    return (
      <div class="row">
        <button class="button" onClick={() => read().catch(fail)}>
          Read the recordings
        </button>
      </div>
    );
  }
  return (
    <div class="row">
      <progress max={now.of} value={now.of > 1 ? now.done : undefined} aria-label="Progress of the reading" />
      <span role="status">
        Reading <Name>{now.name}</Name>
        {now.of > 1 && `, ${now.done + 1} of ${now.of}`}
      </span>
      <button class="button" onClick={haltReading}>
        Stop reading
      </button>
    </div>
  );
}

export function Record() {
  const input = useRef<HTMLInputElement>(null);
  useEffect(keepReading, []);
  return (
    <section aria-labelledby="record-title">
      <header class="screen-head">
        <div>
          <h1 id="record-title">From a recording</h1>
          <p>Choose{isTouch.value ? "" : " or drop"} CSV, WAV, FLAC or NPY files of one surface, or a file of another haptic format. Nothing leaves this page.</p>
        </div>
        <input ref={input} type="file" hidden multiple accept={READ} onChange={() => take([...(input.current?.files ?? [])]).catch(fail)} />
        <button class="button strong" onClick={() => input.current?.click()}>
          <Icon name="folder" /> Choose files
        </button>
      </header>
      <Imports />
      {recordings.value.length === 0 ? (
        <p class="empty" hidden={waiting.value.length + done.value.length > 0}>No recording is open. A good recording is ten seconds of a finger sliding back and forth. It contains the lateral force and, if possible, the normal force and the position.</p>
      ) : (
        <div class="stack">
          <Reading />
          {reads.value.map((one, i) => (
            <OneRead key={i} read={one} index={i} />
          ))}
          <FitPanel />
          <Ranked />
        </div>
      )}
    </section>
  );
}
