// Files of other haptic formats. A file that states everything is opened at once. What the others do
// not state, the user gives once for all of them.

import { signal } from "@preact/signals";
import { importFile, type ActuatorRange, type Asked, type Imported, type ImportFormat, type ImportReport, type ImportSettings } from "htex/import";

import { theImporter } from "./importer.ts";
import { isolated } from "./names.ts";
import { sayOpened, type Problem, type Work } from "./opening.ts";
import { add, lostText, type Item } from "./shelf.ts";
import { breathe } from "./slices.ts";
import { begin, screen } from "./state.ts";
import { troubleOf, type Trouble } from "./trouble.ts";

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
  /** Whether it is imported with what is given now. */
  readonly isChosen: boolean;
  /** Why it could not be imported with what was given. */
  readonly problem: Trouble | null;
}

/** A file that was imported. */
export interface Done {
  readonly file: NamedFile;
  readonly format: ImportFormat;
  readonly bytes: Uint8Array;
  readonly report: ImportReport;
}

/** What the user states about the files that wait. It stays for those that come after them. */
export interface Given extends Pick<ImportSettings, "full_scale" | "quantity" | "speed_mm_s" | "force_n" | "pitch_mm"> {
  readonly license: string;
  /** The actuator for each format whose files are for one. */
  readonly profiles: Readonly<Record<string, string>>;
}

export const waiting = signal<readonly Waiting[]>([]);
export const given = signal<Given>({ license: "", profiles: {} });
export const done = signal<readonly Done[]>([]);
export const actuators = signal<readonly ActuatorRange[]>([]);
/** Name of the file that is read now. */
export const importing = signal<string | null>(null);

const extensionOf = (name: string) => name.slice(name.lastIndexOf(".") + 1).toLowerCase();

export const isImported = (name: string) => name.includes(".") && EXTENSIONS.includes(extensionOf(name));

/** How many of something, in words. */
export const counted = (count: number, what: string) => `${count.toLocaleString("en")} ${what}${count === 1 ? "" : "s"}`;

/** What a format's file becomes, or that it waits. */
interface Known {
  readonly file: NamedFile;
  readonly format: ImportFormat;
  readonly asks: readonly Asked[];
}

/** Takes files: they are imported, or wait for what they do not say. One that cannot be read is told, and the next one is taken. */
export async function takeImports(files: readonly NamedFile[], work: Work) {
  const importer = await theImporter();
  const { formats, profiles } = importer.formats();
  actuators.value = profiles;
  const problems: Problem[] = [];
  const known: Known[] = [];
  for (const file of files) {
    const format = formats.find(({ extensions }) => extensions.includes(extensionOf(file.name)));
    try {
      if (format) known.push({ file, format, asks: importer.asks(file) });
    } catch (error) {
      problems.push({ name: file.name, error });
    }
    await breathe();
  }
  const asking = known.filter(({ asks }) => asks.length > 0).map((one) => ({ ...one, isChosen: true, problem: null }));
  if (asking.length > 0) {
    waiting.value = [...without(asking), ...asking];
    screen.value = "record";
  }
  const complete = known.filter(({ asks }) => asks.length === 0).map((one) => ({ ...one, settings: {} }));
  const made = await importAll(complete, work);
  return { ...made, problems: [...problems, ...made.problems] };
}

const without = (all: readonly Known[]) => waiting.peek().filter(({ file }) => !all.some((other) => other.file.name === file.name));

export function leaveOut(all: readonly Waiting[]) {
  waiting.value = without(all);
}

/** Chooses whether a file that waits is imported with what is given now. */
export function chooseWaiting(one: Waiting, isChosen: boolean) {
  waiting.value = waiting.peek().map((other) => (other === one ? { ...one, isChosen } : other));
}

let aborting: AbortController | null = null;

export function stop() {
  aborting?.abort();
}

/** The settings that a format takes of what is given. */
function settingsFor({ name, settings }: ImportFormat): ImportSettings {
  const { license, profiles, ...all } = given.peek();
  const taken = Object.entries({ ...all, profile: profiles[name] }).filter(([setting, value]) => settings.includes(setting) && value !== undefined);
  return { ...Object.fromEntries(taken), ...(license ? { license } : {}) };
}

/** Imports the chosen ones of the files that wait. Those that cannot be stay, with the reason. */
export async function importChosen() {
  const chosen = waiting.peek().filter(({ isChosen }) => isChosen);
  aborting = new AbortController();
  try {
    const all = chosen.map((one) => ({ ...one, settings: settingsFor(one.format) }));
    const { text, lost, problems } = await importAll(all, { step: () => {}, signal: aborting.signal });
    waiting.value = waiting.peek().map((one) => ({ ...one, isChosen: true, problem: problems.find(({ name }) => name === one.file.name)?.trouble ?? null }));
    // The distance of pixels and the actuator are of these files.
    if (waiting.peek().length === 0) given.value = { ...given.peek(), pitch_mm: undefined, profiles: {} };
    sayOpened([text], lost, problems);
  } finally {
    aborting = null;
  }
}

/** Imports files one after the other, in a worker; puts the textures on the shelf, and the first one on the pad. */
async function importAll(all: readonly (Known & { settings: ImportSettings })[], { step, signal: stopped }: Work) {
  const problems: (Problem & { trouble: Trouble })[] = [];
  const made: Item[] = [];
  for (const { file, format, settings } of all) {
    if (stopped.aborted) break;
    step(file.name);
    importing.value = file.name;
    try {
      made.push(await importOne(file, format, settings, stopped, made.length === 0));
      waiting.value = waiting.peek().filter((one) => one.file !== file);
    } catch (error) {
      if (!stopped.aborted) problems.push({ name: file.name, error, trouble: troubleOf(error, file.name) });
    }
  }
  importing.value = null;
  const [first] = made;
  const name = isolated(first?.name ?? "");
  const sentence = made.length > 1 ? `${counted(made.length, "texture")} are on the shelf. ${name} is on the pad.` : first ? `${name} is on the shelf and on the pad.` : "";
  return { problems, lost: lostText(made), text: [stopped.aborted ? "The import was stopped." : "", sentence].filter(Boolean).join(" ") };
}

async function importOne(file: NamedFile, format: ImportFormat, settings: ImportSettings, stopped: AbortSignal, isFirst: boolean) {
  const { texture, report }: Imported = await importFile({ ...file }, { ...settings, signal: stopped });
  const bytes = texture.toBytes();
  texture.free();
  const item = await add(bytes);
  const one: Done = { file, format, bytes, report };
  done.value = [...done.peek().filter((other) => other.file.name !== file.name), one];
  if (isFirst) await toPad(one, format.fitted ? report.ranked[0] : undefined);
  if (report.warnings.length > 0) screen.value = "record";
  return item;
}

/** Puts an imported texture on the pad, played by a model. */
export async function toPad(one: Done, model?: string) {
  await begin(one.bytes, `import ${isolated(one.file.name)}`, model);
}
