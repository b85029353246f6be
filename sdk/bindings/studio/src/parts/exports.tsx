// The section that saves files of other haptic formats. The user chooses a format and its settings. After saving, the section shows what is
// lost and under which licence the file is.

import type { ExportFormat } from "htex/import";

import { actuators, choices, choose, chosen, formats, isExporting, readFormats, saved, saveExport, set, useOf, type Saved } from "../exporting.ts";
import { fail } from "../state.ts";
import { words } from "./difference.tsx";
import { Notices } from "./notices.tsx";
import { NumberField } from "./number-field.tsx";
import { useSpoken } from "./spoken.tsx";

/** Settings that are numbers: name, label, and the default in words. */
const NUMBERS: readonly ["speed_mm_s" | "force_n" | "seconds" | "rate_hz", string, string][] = [
  ["speed_mm_s", "Speed, mm/s", "of the first condition"],
  ["force_n", "Force, N", "of the first condition"],
  ["seconds", "Seconds", "2"],
  ["rate_hz", "Rate, Hz", "8000"],
];

const CODINGS = [
  ["vectorial", "seven tones"],
  ["wavelet", "samples"],
] as const;

const dotted = ({ extensions }: ExportFormat) => extensions.map((extension) => `.${extension}`).join(", ");

function Formats() {
  return (
    <div class="columns" role="group" aria-label="Format">
      {formats.value.map((format) => (
        <button key={format.name} type="button" class="menu-item" aria-pressed={chosen.value?.name === format.name} onClick={() => choose(format)}>
          <b>{useOf(format)}</b>
          <small>
            {format.title} ({dotted(format)})
          </small>
        </button>
      ))}
    </div>
  );
}

interface SelectProps<T extends string> {
  label: string;
  value: T;
  options: readonly (readonly [T, string])[];
  onValue: (value: T) => void;
  isWhole?: boolean;
}

function Select<T extends string>({ label, value, options, onValue, isWhole = false }: SelectProps<T>) {
  return (
    <label class={isWhole ? "field whole" : "field"}>
      {label}
      <select value={value} onChange={(event) => onValue(event.currentTarget.value as T)}>
        {options.map(([one, text]) => (
          <option key={one} value={one}>
            {text}
          </option>
        ))}
      </select>
    </label>
  );
}

function Fields({ format: { settings, extensions, profile } }: { format: ExportFormat }) {
  const now = choices.value;
  return (
    <div class="fields">
      {NUMBERS.filter(([name]) => settings.includes(name)).map(([name, label, otherwise]) => (
        <NumberField key={name} label={label} value={now[name]} placeholder={otherwise} onValue={(value) => set({ [name]: value ?? undefined })} />
      ))}
      {settings.includes("coding") && <Select label="Coded as" value={now.coding ?? "vectorial"} options={CODINGS} onValue={(coding) => set({ coding })} />}
      {extensions.length > 1 && (
        <Select label="File" value={now.extension ?? extensions[0] ?? ""} options={extensions.map((one) => [one, `.${one}`])} onValue={(extension) => set({ extension })} />
      )}
      {profile && (
        <Select isWhole label="Actuator that will play it" value={now.profile ?? profile} options={actuators.value.map(({ name, title }) => [name, title])} onValue={(one) => set({ profile: one })} />
      )}
    </div>
  );
}

function SavedFile({ file, length, report }: Saved) {
  const { loses, lost, rights, limited = 0, notes, profile, seconds } = report;
  useSpoken(`${file} is saved.`);
  const actuator = actuators.value.find(({ name }) => name === profile);
  return (
    <div class="stack small exported">
      <p>
        <b>{file}</b> is saved: {length} bytes{actuator && `, ${seconds} s for: ${actuator.title}`}. {rights}
      </p>
      <p>
        Lost: {loses}. {lost && words(lost.felt, "the file")} {limited > 0 && `The actuator is too weak in ${(100 * limited).toFixed(0)} % of the time.`}
      </p>
      <ul class="findings">
        <Notices notices={notes.map((text) => ({ text, settings: [] }))} kind="Note" />
      </ul>
    </div>
  );
}

/** The section. It calls `first` before each export. */
export function Exports({ first }: { first: () => Promise<void> }) {
  const format = chosen.value;
  return (
    <details class="panel" onToggle={(event) => event.currentTarget.open && readFormats().catch(fail)}>
      <summary>
        <h2>Other haptic formats</h2>
      </summary>
      {format ? (
        <form
          class="stack"
          aria-label="Export"
          onSubmit={(event) => {
            event.preventDefault();
            first().then(saveExport).catch(fail);
          }}
        >
          <Formats />
          <Fields format={format} />
          <div class="row">
            <button type="submit" class="button strong" disabled={isExporting.value}>
              Save .{choices.value.extension ?? format.extensions[0]}
            </button>
            <span class="small soft">Nobody has played these files yet. The losses are computed with a model of the actuator.</span>
          </div>
          {saved.value && <SavedFile {...saved.value} />}
        </form>
      ) : (
        <p>Reading the formats…</p>
      )}
    </details>
  );
}
