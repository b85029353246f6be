// Files of other haptic formats, in the screen of recordings: what they do not say is asked once for all, and what was made of them is told.

import type { RecordedQuantity } from "htex";
import type { ImportFormat } from "htex/import";

import { actuators, chooseWaiting, counted, done, given, importChosen, importing, leaveOut, stop, toPad, waiting, type Done, type Given, type Waiting } from "../imports.ts";
import { isolated, list } from "../names.ts";
import { Details } from "../parts/details.tsx";
import { Name } from "../parts/name.tsx";
import { Notices } from "../parts/notices.tsx";
import { NumberField } from "../parts/number-field.tsx";
import { RankedModels } from "../parts/ranked.tsx";
import { Spoken } from "../parts/spoken.tsx";
import { fail, present, screen } from "../state.ts";

/** What a full scale may be of. */
const QUANTITIES: readonly [RecordedQuantity, string][] = [
  ["lateral_force", "N of lateral force"],
  ["normal_force", "N of normal force"],
  ["acceleration", "m/s² of acceleration"],
  ["velocity", "m/s of velocity"],
  ["displacement", "m of displacement"],
];

function say(change: Partial<Given>) {
  given.value = { ...given.peek(), ...change };
}

function Actuator({ format: { name, title, profile }, isOnly }: { format: ImportFormat; isOnly: boolean }) {
  const { profiles } = given.value;
  return (
    <label class="field whole">
      {isOnly ? "Its frequencies" : `The frequencies of ${title}`} are positions in the range of
      <select value={profiles[name] ?? profile ?? ""} onChange={(event) => say({ profiles: { ...profiles, [name]: event.currentTarget.value } })}>
        {actuators.value.map((actuator) => (
          <option key={actuator.name} value={actuator.name}>
            {actuator.title}, {actuator.low_hz} to {actuator.high_hz} Hz
          </option>
        ))}
      </select>
    </label>
  );
}

function Quantity() {
  return (
    <label class="field">
      Its unit
      <select value={given.value.quantity ?? "lateral_force"} onChange={(event) => say({ quantity: event.currentTarget.value as RecordedQuantity })}>
        {QUANTITIES.map(([name, words]) => (
          <option key={name} value={name}>
            {words}
          </option>
        ))}
      </select>
    </label>
  );
}

/** What stands for full scale: 1, or white in an image. */
function fullScaleOf(formats: readonly ImportFormat[]) {
  const words = [formats.some(({ fitted }) => fitted) ? "1" : "", formats.some(({ fitted }) => !fitted) ? "white" : ""].filter(Boolean);
  return `How strong ${words.join(" or ")} is`;
}

function Fields({ all, formats }: { all: readonly Waiting[]; formats: readonly ImportFormat[] }) {
  const { full_scale, speed_mm_s, force_n, pitch_mm, license } = given.value;
  const number = (name: "full_scale" | "speed_mm_s" | "force_n" | "pitch_mm") => (value: number | null) => say({ [name]: value ?? undefined });
  const isPitchAsked = all.some(({ asks }) => asks.some(({ setting }) => setting === "pitch_mm"));
  return (
    <div class="fields">
      <NumberField label={fullScaleOf(formats)} value={full_scale} isRequired onValue={number("full_scale")} />
      <Quantity />
      <NumberField label="Speed, mm/s" value={speed_mm_s} isRequired onValue={number("speed_mm_s")} />
      <NumberField label="Force, N" value={force_n} isRequired onValue={number("force_n")} />
      {formats.some(({ settings }) => settings.includes("pitch_mm")) && (
        <NumberField label="mm per pixel" value={pitch_mm} isRequired={isPitchAsked} placeholder={isPitchAsked ? undefined : "as the file states"} onValue={number("pitch_mm")} />
      )}
      <label class="field">
        Licence
        <input type="text" placeholder="none stated" value={license} onInput={(event) => say({ license: event.currentTarget.value })} />
      </label>
      {formats.map((format) => format.profile && <Actuator key={format.name} format={format} isOnly={formats.length === 1} />)}
    </div>
  );
}

function Kept({ format: { title, keeps, loses } }: Pick<Waiting, "format">) {
  return (
    <p class="small soft">
      {title}. Kept: {keeps}. Lost: {loses}.
    </p>
  );
}

/** The files of a form; each can be left for other numbers. */
function Files({ all }: { all: readonly Waiting[] }) {
  return (
    <ul class="files">
      {all.map((one) => (
        <li key={one.file.name}>
          <label class="check">
            <input type="checkbox" checked={one.isChosen} onChange={(event) => chooseWaiting(one, event.currentTarget.checked)} />
            <Name>{one.file.name}</Name>
          </label>
          {one.problem && (
            <div class="problem small">
              {one.problem.text}
              {one.problem.details && <Details text={one.problem.details} />}
            </div>
          )}
        </li>
      ))}
    </ul>
  );
}

/** One form for all files that wait. */
function Asking({ all }: { all: readonly Waiting[] }) {
  const chosen = all.filter(({ isChosen }) => isChosen);
  const formats = [...new Map((chosen.length > 0 ? chosen : all).map(({ format }) => [format.name, format])).values()];
  const words = [...new Set(chosen.flatMap(({ asks }) => asks.map((one) => one.words)))];
  const [first] = all;
  const isOnly = all.length === 1;
  const name = isOnly && first ? first.file.name : counted(all.length, "file");
  const isBusy = importing.value !== null;
  return (
    <form
      class="panel stack"
      aria-label={`Import ${name}`}
      onSubmit={(event) => {
        event.preventDefault();
        importChosen().catch(fail);
      }}
    >
      <h2>
        <Name>{name}</Name>
      </h2>
      {!isOnly && <Files all={all} />}
      {formats.map((format) => (
        <Kept key={format.name} format={format} />
      ))}
      <p>
        <Spoken text={chosen.length === 0 ? "Choose the files to import." : `${isOnly ? "The file does" : "The files do"} not say ${list(words)}.`} />
      </p>
      <Fields all={chosen} formats={formats} />
      <div class="row">
        <button type="submit" class="button strong" disabled={isBusy || chosen.length === 0}>
          {isOnly || chosen.length === 0 ? "Import" : `Import ${counted(chosen.length, "file")}`}
        </button>
        <button type="button" class="button" disabled={isBusy} onClick={() => leaveOut(all)}>
          {isOnly ? "Leave it out" : "Leave all out"}
        </button>
        {isBusy && (
          <>
            <Spoken text={`Importing ${isolated(importing.value ?? "")}…`} />
            <button type="button" class="button" onClick={stop}>Stop</button>
          </>
        )}
      </div>
    </form>
  );
}

async function shape(one: Done) {
  if (present.peek()?.bytes !== one.bytes) await toPad(one);
  screen.value = "shape";
}

function Told({ one, isOnly }: { one: Done; isOnly: boolean }) {
  const { file, format, report } = one;
  return (
    <details class="panel" open={isOnly}>
      <summary>
        <h2>
          <Name>{file.name}</Name>
        </h2>
      </summary>
      <div class="stack">
        <Kept format={format} />
        <ul class="findings">
          <Notices notices={report.warnings} kind="Warning" />
          <Notices notices={report.notes} kind="Note" />
        </ul>
        {format.fitted && <RankedModels report={report} isRecorded={false} onPad={(model) => toPad(one, model)} />}
        <div class="row">
          <button class="button" onClick={() => shape(one).catch(fail)}>
            Shape it
          </button>
        </div>
      </div>
    </details>
  );
}

export function Imports() {
  const [asked, told] = [waiting.value, done.value];
  if (asked.length + told.length === 0) return null;
  return (
    <div class="stack imports">
      {asked.length > 0 && <Asking all={asked} />}
      {told.map((one) => (
        <Told key={one.file.name} one={one} isOnly={told.length === 1} />
      ))}
    </div>
  );
}
