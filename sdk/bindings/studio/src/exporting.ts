// Files of other haptic formats, to which the present texture is exported.

import { signal } from "@preact/signals";
import { exportFile, type ActuatorRange, type ExportFormat, type ExportReport, type ExportSettings } from "htex/import";

import { theImporter } from "./importer.ts";
import { fileName, save } from "./save.ts";
import { present } from "./state.ts";

/** What formats are for, in a designer's words. */
const USES: Record<string, string> = {
  haptic: "Controllers of Meta Quest",
  ahap: "iPhones",
  android: "Android phones, as data or as program code",
  hjif: "Players of the MPEG standard for haptics",
  wav: "Controllers and shakers that play sound",
  png: "Screens that change how slippery they are",
  gltf: "3D models: the mesh carries the whole texture",
};

/** What the user chooses. A missing choice has the default of `htex export`. */
export type Choices = Pick<ExportSettings, "speed_mm_s" | "force_n" | "seconds" | "profile" | "rate_hz" | "coding" | "extension">;

/** A file that was saved. */
export interface Saved {
  readonly file: string;
  readonly length: number;
  readonly report: ExportReport;
}

export const formats = signal<readonly ExportFormat[]>([]);
export const actuators = signal<readonly ActuatorRange[]>([]);
export const chosen = signal<ExportFormat | null>(null);
export const choices = signal<Choices>({});
export const saved = signal<Saved | null>(null);
export const isExporting = signal(false);

export const useOf = ({ name, keeps }: ExportFormat) => USES[name] ?? keeps;

/** Reads the formats from the module of imports, which is loaded if it is not there yet. */
export async function readFormats() {
  const { exports, profiles } = (await theImporter()).formats();
  actuators.value = profiles;
  formats.value = exports;
  chosen.value ??= exports[0] ?? null;
}

/** Chooses a format. Forgets the actuator and the extension, which this format may not have. */
export function choose(format: ExportFormat) {
  chosen.value = format;
  set({ profile: undefined, extension: undefined });
}

export function set(change: Partial<Choices>) {
  choices.value = { ...choices.peek(), ...change };
  saved.value = null;
}

/** Exports the present texture with the model that plays on the pad, and saves the file. */
export async function saveExport() {
  const [document, format] = [present.peek(), chosen.peek()];
  if (!document || !format) return;
  const { extension, ...given } = choices.peek();
  const taken = Object.entries({ model: document.model, ...given }).filter(([name]) => format.settings.includes(name as keyof ExportSettings));
  const settings: ExportSettings = Object.fromEntries(taken);
  saved.value = null;
  isExporting.value = true;
  try {
    const made = await exportFile(document.bytes, format.name, { ...settings, extension });
    const file = fileName(document.name, made.extension);
    save(made.bytes, file, "application/octet-stream");
    saved.value = { file, length: made.bytes.length, report: made.report };
  } finally {
    isExporting.value = false;
  }
}
