// Record: from recordings to a texture.

import { useEffect, useRef } from "preact/hooks";
import type { Columns, Finding, Notice } from "htex";

import { author } from "../author.ts";
import { Icon } from "../parts/icons.tsx";
import { Notices } from "../parts/notices.tsx";
import { NumberField } from "../parts/number-field.tsx";
import { RankedModels } from "../parts/ranked.tsx";
import { Waveform } from "../parts/waveform.tsx";
import { READ, take } from "../drop.ts";
import { done, waiting } from "../imports.ts";
import { abort, canFit, fitAll, fitted, force, isReading, keepReading, license, maps, progress, rate, reads, recordings, speed, toPad, type Read } from "../recordings.ts";
import { fail } from "../state.ts";
import { Imports } from "./import.tsx";
import { nameOf } from "./shape.tsx";

const ROLES = ["", "lateral", "lateral_y", "normal", "time", "x", "y", "speed"];

/** The map with another role of a column. */
function withRole({ columns }: Columns, index: number, role: string) {
  const all = columns.map((column, i) => ({ ...column, role: i === index ? role || null : column.role }));
  return all.filter((column) => column.role).map(({ role: own, name, scale }) => `${own}=${name}${scale === 1 ? "" : `:${scale}`}`).join(",");
}

function ColumnTable({ name, columns }: { name: string; columns: Columns }) {
  const roles = [...new Set([...ROLES, ...columns.columns.map(({ role }) => role ?? "")])];
  return (
    <div class="scroll-x">
      <table class="table">
        <thead>
          <tr>
            <th scope="col">Column</th>
            <th scope="col">Is read as</th>
            <th scope="col">First numbers</th>
          </tr>
        </thead>
        <tbody>
          {columns.columns.map((column, i) => (
            <tr key={column.name}>
              <th scope="row">{column.name}</th>
              <td>
                <select aria-label={`Role of ${column.name}`} value={column.role ?? ""} onChange={(event) => (maps.value = { ...maps.peek(), [name]: withRole(columns, i, event.currentTarget.value) })}>
                  {roles.map((role) => (
                    <option key={role} value={role}>
                      {role || "not read"}
                    </option>
                  ))}
                </select>
              </td>
              <td class="soft">{column.first.slice(0, 4).map((x) => Number(x.toPrecision(4))).join(", ")}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}

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
        <p class="small soft">{finding.code}</p>
      </details>
    </li>
  );
}

/** Notices that no finding tells. */
function beside(notices: Notice[], findings: Finding[]) {
  return notices.filter(({ text }) => !findings.some(({ code }) => text.includes(code)));
}

function OneRead({ read: { recording, columns, processed, problem } }: { read: Read }) {
  return (
    <article class="panel stack">
      <h2>{recording.name}</h2>
      {problem && (
        <p class="problem">
          <Icon name="warn" /> {problem}
        </p>
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
            <Notices notices={beside(processed.warnings, processed.findings)} kind="Warning" />
            <Notices notices={beside(processed.notes, processed.findings)} kind="Note" />
          </ul>
        </>
      )}
      {columns && (
        <details open={problem !== null}>
          <summary>
            <h2>Columns</h2>
          </summary>
          <ColumnTable name={recording.name} columns={columns} />
        </details>
      )}
    </article>
  );
}

function FitPanel() {
  const now = progress.value;
  return (
    <div class="panel stack">
      <div class="columns">
        <NumberField label="Speed, mm/s" value={speed.value} placeholder="as recorded" onValue={(value) => (speed.value = value)} />
        <NumberField label="Force, N" value={force.value} placeholder="as recorded" onValue={(value) => (force.value = value)} />
        <NumberField label="Rate, Hz" value={rate.value} placeholder="as recorded" onValue={(value) => (rate.value = value)} />
        <label class="field">
          Licence
          <input type="text" value={license.value} onInput={(event) => (license.value = event.currentTarget.value)} />
        </label>
      </div>
      <div class="row">
        <button class="button strong" disabled={!canFit.value || now !== null} onClick={() => fitAll().catch(fail)}>
          Fit all models
        </button>
        {now && (
          <>
            <progress max={now.of} value={now.done} aria-label="Progress of the fit" />
            <span class="small soft" role="status">{now.text}</span>
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
      <h2>Models, by what is felt</h2>
      <RankedModels ranked={report.ranked} models={report.models} isRecorded onPad={toPad} />
      <ul class="findings">
        <Notices notices={report.warnings} kind="Warning" />
        <Notices notices={report.notes} kind="Note" />
        {report.skipped.map(({ model, reason }) => (
          <li key={model} class="finding">
            <b>{nameOf(model)} is left out:</b> {reason}
          </li>
        ))}
      </ul>
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
          <p>Choose CSV, WAV, FLAC or NPY files of one surface, or a file of another haptic format, or drop them. Nothing leaves this page.</p>
        </div>
        <input ref={input} type="file" hidden multiple accept={READ} onChange={() => take([...(input.current?.files ?? [])]).catch(fail)} />
        <button class="button strong" onClick={() => input.current?.click()}>
          <Icon name="folder" /> Choose files
        </button>
      </header>
      <Imports />
      {recordings.value.length === 0 ? (
        <p class="empty" hidden={waiting.value.length + done.value.length > 0}>No recording is open. A good one is ten seconds of a finger that slides to and fro, with the lateral force and, if they are known, the normal force and the position.</p>
      ) : (
        <div class="stack">
          {isReading.value && <p role="status">Reading…</p>}
          {reads.value.map((one) => (
            <OneRead key={one.recording.name} read={one} />
          ))}
          <FitPanel />
          <Ranked />
        </div>
      )}
    </section>
  );
}
