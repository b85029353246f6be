// Files of other haptic formats, in the screen of recordings: what they do not say is asked, and what was made of them is told.

import type { RecordedQuantity } from "htex";

import { actuators, done, importing, importWaiting, leaveOut, list, stop, toPad, waiting, type Done, type Given, type Waiting } from "../imports.ts";
import { Notices } from "../parts/notices.tsx";
import { NumberField } from "../parts/number-field.tsx";
import { RankedModels } from "../parts/ranked.tsx";
import { fail, screen } from "../state.ts";

/** What a full scale may be of. */
const QUANTITIES: readonly [RecordedQuantity, string][] = [
  ["lateral_force", "N of lateral force"],
  ["normal_force", "N of normal force"],
  ["acceleration", "m/s² of acceleration"],
  ["velocity", "m/s of velocity"],
  ["displacement", "m of displacement"],
];

type Said = Waiting["given"];

function say(given: Said, change: Partial<Given>) {
  given.value = { ...given.peek(), ...change };
}

function Actuator({ own, given }: { own: string; given: Said }) {
  return (
    <label class="field whole">
      Its frequencies are positions in the range of
      <select value={given.value.profile ?? own} onChange={(event) => say(given, { profile: event.currentTarget.value })}>
        {actuators.value.map(({ name, title, low_hz, high_hz }) => (
          <option key={name} value={name}>
            {title}, {low_hz} to {high_hz} Hz
          </option>
        ))}
      </select>
    </label>
  );
}

function Quantity({ given }: { given: Said }) {
  return (
    <label class="field">
      Its unit
      <select value={given.value.quantity ?? "lateral_force"} onChange={(event) => say(given, { quantity: event.currentTarget.value as RecordedQuantity })}>
        {QUANTITIES.map(([name, words]) => (
          <option key={name} value={name}>
            {words}
          </option>
        ))}
      </select>
    </label>
  );
}

function Fields({ one: { format, asks, given } }: { one: Waiting }) {
  const { full_scale, speed_mm_s, force_n, pitch_mm, license } = given.value;
  const number = (name: "full_scale" | "speed_mm_s" | "force_n" | "pitch_mm") => (value: number | null) => say(given, { [name]: value ?? undefined });
  const isPitchAsked = asks.some(({ setting }) => setting === "pitch_mm");
  return (
    <div class="fields">
      <NumberField label={format.fitted ? "How strong 1 is" : "How strong white is"} value={full_scale} isRequired onValue={number("full_scale")} />
      <Quantity given={given} />
      <NumberField label="Speed, mm/s" value={speed_mm_s} isRequired onValue={number("speed_mm_s")} />
      <NumberField label="Force, N" value={force_n} isRequired onValue={number("force_n")} />
      {format.settings.includes("pitch_mm") && (
        <NumberField label="mm per pixel" value={pitch_mm} isRequired={isPitchAsked} placeholder={isPitchAsked ? undefined : "as the file states"} onValue={number("pitch_mm")} />
      )}
      <label class="field">
        Licence
        <input type="text" placeholder="none stated" value={license} onInput={(event) => say(given, { license: event.currentTarget.value })} />
      </label>
      {format.profile && <Actuator own={format.profile} given={given} />}
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

function Asking({ one }: { one: Waiting }) {
  const isRead = importing.value === one.file.name;
  return (
    <form
      class="panel stack"
      aria-label={`Import ${one.file.name}`}
      onSubmit={(event) => {
        event.preventDefault();
        importWaiting(one).catch(fail);
      }}
    >
      <h2>{one.file.name}</h2>
      <Kept format={one.format} />
      <p class="small" role="status">
        The file does not say {list(one.asks.map(({ words }) => words))}.
      </p>
      <Fields one={one} />
      <div class="row">
        <button type="submit" class="button strong" disabled={importing.value !== null}>
          Import
        </button>
        <button type="button" class="button" onClick={() => leaveOut(one)}>
          Leave it out
        </button>
        {isRead && (
          <>
            <span class="small soft" role="status">Importing…</span>
            <button type="button" class="button" onClick={stop}>Stop</button>
          </>
        )}
      </div>
    </form>
  );
}

function Told({ one }: { one: Done }) {
  const { file, format, report } = one;
  return (
    <article class="panel stack">
      <h2>{file.name}</h2>
      <Kept format={format} />
      <ul class="findings">
        <Notices notices={report.warnings} kind="Warning" />
        <Notices notices={report.notes} kind="Note" />
      </ul>
      {format.fitted && <RankedModels ranked={report.ranked} models={report.models} isRecorded={false} onPad={(model) => toPad(one, model)} />}
      <div class="row">
        <button class="button" onClick={() => (screen.value = "shape")}>
          Shape it
        </button>
      </div>
    </article>
  );
}

export function Imports() {
  if (waiting.value.length + done.value.length === 0) return null;
  return (
    <div class="stack imports">
      {waiting.value.map((one) => (
        <Asking key={one.file.name} one={one} />
      ))}
      {done.value.map((one) => (
        <Told key={one.file.name} one={one} />
      ))}
    </div>
  );
}
