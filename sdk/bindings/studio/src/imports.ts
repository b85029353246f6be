// Files of other haptic formats. A file that states everything is opened at once. Otherwise the
// user first gives what it does not state.

import { signal, type Signal } from "@preact/signals";
import { importFile, type ActuatorRange, type Asked, type Imported, type ImportFormat, type ImportReport, type ImportSettings } from "htex/import";

import { theImporter } from "./importer.ts";
import { add } from "./shelf.ts";
import { begin, fail, say, screen } from "./state.ts";

/** Extensions of the files, as `htex formats` lists them. */
export const EXTENSIONS = ["xml", "haptic", "ahap", "hjif", "png", "glb", "gltf"];

interface NamedFile {
  readonly name: string;
  readonly bytes: Uint8Array;
}

/** A file that waits for what it does not say. */
export interface Waiting {
  readonly file: NamedFile;
  readonly format: ImportFormat;
  readonly asks: readonly Asked[];
  readonly given: Signal<Given>;
}

/** A file that was imported. */
export interface Done {
  readonly file: NamedFile;
  readonly format: ImportFormat;
  readonly bytes: Uint8Array;
  readonly report: ImportReport;
}

/** What the user states about a file. */
export interface Given extends Pick<ImportSettings, "full_scale" | "quantity" | "speed_mm_s" | "force_n" | "pitch_mm" | "profile"> {
  readonly license: string;
}

export const waiting = signal<readonly Waiting[]>([]);
export const done = signal<readonly Done[]>([]);
export const actuators = signal<readonly ActuatorRange[]>([]);
/** Name of the file that is read now. */
export const importing = signal<string | null>(null);

let aborting: AbortController | null = null;

/** What was said of the last file, with which the next one begins. */
let said: Given = { license: "" };

const extensionOf = (name: string) => name.slice(name.lastIndexOf(".") + 1).toLowerCase();

export const isImported = (name: string) => name.includes(".") && EXTENSIONS.includes(extensionOf(name));

/** Words in a row: "a, b and c". */
export const list = (words: readonly string[]) => [words.slice(0, -1).join(", "), ...words.slice(-1)].filter(Boolean).join(" and ");

/** Takes a file: it is imported, or waits for what it does not say. */
export async function takeImport(file: NamedFile) {
  const importer = await theImporter();
  const { formats, profiles } = importer.formats();
  actuators.value = profiles;
  const asks = importer.asks(file);
  const format = formats.find(({ extensions }) => extensions.includes(extensionOf(file.name)));
  if (!format) return;
  if (asks.length === 0) {
    await finish(file, format, {});
    return;
  }
  waiting.value = [...without(file.name), { file, format, asks, given: signal(said) }];
  screen.value = "record";
}

const without = (name: string) => waiting.peek().filter(({ file }) => file.name !== name);

export function leaveOut({ file }: Waiting) {
  waiting.value = without(file.name);
}

/** Imports a file that waits, with what is given of what its format takes. */
export async function importWaiting({ file, format, given }: Waiting) {
  const { license, ...all } = given.peek();
  const taken = Object.entries(all).filter(([name, value]) => format.settings.includes(name) && value !== undefined);
  if (!(await finish(file, format, { ...Object.fromEntries(taken), ...(license ? { license } : {}) }))) return;
  const { full_scale, quantity, speed_mm_s, force_n } = all;
  said = { license, full_scale, quantity, speed_mm_s, force_n };
  waiting.value = without(file.name);
}

/** Imports in a worker; null if it was stopped. */
async function imported(file: NamedFile, settings: ImportSettings): Promise<Imported | null> {
  importing.value = file.name;
  aborting = new AbortController();
  try {
    return await importFile({ ...file }, { ...settings, signal: aborting.signal });
  } catch (error) {
    if ((error as { code?: string }).code !== "aborted") throw error;
    say("The import was stopped.");
    return null;
  } finally {
    importing.value = null;
    aborting = null;
  }
}

export function stop() {
  aborting?.abort();
}

/** Imports a file, and puts the texture on the shelf and on the pad; false if it was stopped. */
async function finish(file: NamedFile, format: ImportFormat, settings: ImportSettings) {
  const made = await imported(file, settings);
  if (!made) return false;
  const { texture, report } = made;
  const bytes = texture.toBytes();
  texture.free();
  const item = await add(bytes);
  done.value = [{ file, format, bytes, report }, ...done.peek().filter((one) => one.file.name !== file.name)];
  await toPad(done.peek()[0], format.fitted ? report.ranked[0] : item.model);
  if (report.warnings.length > 0) screen.value = "record";
  say(`${item.name} is on the shelf and on the pad.`, "good");
  return true;
}

/** Puts an imported texture on the pad, played by a model. */
export async function toPad(one: Done | undefined, model?: string) {
  if (one) await begin(one.bytes, `import ${one.file.name}`, model);
}

/** Takes files one after the other; one that cannot be read is told, and the next one is taken. */
export async function takeImports(files: readonly NamedFile[]) {
  for (const file of files) await takeImport(file).catch(fail);
}
