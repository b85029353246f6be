// Advice that leads to the fields it speaks of.

/** Settings of recordings, as the page calls their fields. */
const FIELDS: Readonly<Record<string, string>> = {
  map: "Columns",
  quantity: "What was recorded",
  rate_hz: "Rate",
  scale: "Full scale",
  from_s: "Read from",
  to_s: "Read to",
  segments: "What is read",
  speed_mm_s: "Speed",
  force_n: "Force",
  // Speed and force of each recording.
  conditions: "Speed",
};

/** Goes to the field of a setting, of this recording if each has its own. */
function goTo(setting: string, from: HTMLElement) {
  const named = `[data-setting="${setting === "conditions" ? "speed_mm_s" : setting}"]`;
  const field = from.closest("article")?.querySelector<HTMLElement>(named) ?? document.querySelector<HTMLElement>(named);
  field?.closest("details")?.setAttribute("open", "");
  field?.focus();
}

/** A button for each setting that has a field; a setting may be told with a value, such as "segments sweeps". */
export function ToSettings({ names }: { names: readonly string[] }) {
  const settings = [...new Set(names.map((name) => name.split(" ")[0] ?? ""))].filter((name) => FIELDS[name]);
  if (settings.length === 0) return null;
  return (
    <p class="row small">
      Set:{" "}
      {settings.map((name) => (
        <button key={name} type="button" class="chip" onClick={(event) => goTo(name, event.currentTarget)}>
          {FIELDS[name]}
        </button>
      ))}
    </p>
  );
}
