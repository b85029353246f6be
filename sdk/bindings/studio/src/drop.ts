// Files that are dropped or chosen: textures, libraries, recordings, files of other haptic formats, folders.

import { Library } from "htex";

import { EXTENSIONS, isImported, takeImports } from "./imports.ts";
import { isolated } from "./names.ts";
import { sayOpened, withProgress, type Problem, type Work } from "./opening.ts";
import { openRecordings } from "./recordings.ts";
import { addAll, lostText, type Source } from "./shelf.ts";
import { begin, fail, screen } from "./state.ts";

async function bytesOf(file: File) {
  return new Uint8Array(await file.arrayBuffer());
}

/** Files with their bytes; those that cannot be read are problems. */
async function named(files: readonly File[], problems: Problem[]) {
  const read = async (file: File) => [{ name: file.name, bytes: await bytesOf(file) }];
  const all = await Promise.all(files.map((file) => read(file).catch((error) => (problems.push({ name: file.name, error }), []))));
  return all.flat();
}

const RECORDINGS = ["csv", "tsv", "txt", "wav", "flac", "npy"];

const isRecording = (name: string) => RECORDINGS.some((extension) => name.toLowerCase().endsWith(`.${extension}`));

const dotted = (extensions: readonly string[]) => extensions.map((extension) => `.${extension}`).join(",");

/** What is chosen as a recording, and all that is opened, for inputs of files. */
export const READ = dotted([...RECORDINGS, ...EXTENSIONS]);
export const OPENED = dotted(["htex", "htexlib", ...RECORDINGS, ...EXTENSIONS]);

interface OpenLibrary {
  readonly name: string;
  readonly library: Library;
}

async function openLibraries(files: readonly File[], problems: Problem[]): Promise<OpenLibrary[]> {
  const open = async (file: File) => [{ name: file.name, library: await Library.open(await bytesOf(file)) }];
  const all = await Promise.all(files.map((file) => open(file).catch((error) => (problems.push({ name: file.name, error }), []))));
  return all.flat();
}

/** The textures of files and of libraries. */
async function* sourcesOf(files: readonly File[], libraries: readonly OpenLibrary[], problems: Problem[]): AsyncGenerator<Source> {
  for (const file of files) yield { name: file.name, bytes: () => bytesOf(file) };
  for (const { name, library } of libraries) {
    try {
      for await (const entry of library.entries()) yield { name: entry.name, bytes: () => library.bytes(entry.name) };
    } catch (error) {
      problems.push({ name, error });
    }
  }
}

const number = (count: number) => count.toLocaleString("en");

/** Puts textures on the shelf, and the first file's on the pad; a sentence of what was done, and what was not. */
async function takeTextures(files: readonly File[], libraryFiles: readonly File[]) {
  const failed: Problem[] = [];
  const libraries = await openLibraries(libraryFiles, failed);
  const count = libraries.reduce((sum, { library }) => sum + library.count, files.length);
  // A library is to be looked through.
  if (libraries.length > 0) screen.value = "shelf";
  const { added, problems, isStopped } = await withProgress(count, async (work) => ({
    ...(await addAll(sourcesOf(files, libraries, failed), work)),
    isStopped: work.signal.aborted,
  }));
  libraries.forEach(({ library }) => library.free());
  const [first] = added;
  if (first && files.length > 0) await begin(first.bytes, `open ${isolated(files[0]?.name ?? "")}`);
  return { problems: [...failed, ...problems], text: textOf(), lost: lostText(added) };

  function textOf() {
    if (isStopped) return `Stopped: ${number(added.length)} of ${number(count)} textures are on the shelf.`;
    if (!first) return "";
    if (added.length === 1) return `${isolated(first.name)} is on the shelf${files.length > 0 ? " and on the pad" : ""}.`;
    const [only] = libraries;
    return `${number(added.length)} textures ${files.length === 0 && only && libraries.length === 1 ? `of ${isolated(only.name)} ` : ""}are on the shelf.`;
  }
}

/** Takes files: textures go to the shelf, and the first one to the pad; recordings to their screen; files of other formats become textures. */
async function takeAll(files: readonly File[], problems: Problem[]) {
  const textures = files.filter(({ name }) => /\.htex$/i.test(name));
  const libraries = files.filter(({ name }) => /\.htexlib$/i.test(name));
  const taken = files.filter(({ name }) => isRecording(name));
  const others = files.filter(({ name }) => isImported(name));
  const sentences: string[] = [];
  let lost = "";
  if (textures.length + libraries.length > 0) {
    const opened = await takeTextures(textures, libraries);
    problems.push(...opened.problems);
    sentences.push(opened.text);
    lost = opened.lost;
  }
  if (taken.length > 0) {
    const all = await named(taken, problems);
    if (all.length > 0) {
      openRecordings(all);
      screen.value = "record";
    }
  } else if (textures.length + libraries.length + others.length === 0 && files.length > 0) {
    const known = EXTENSIONS.map((extension) => `.${extension}`).join(", ");
    throw new Error(`${isolated(files[0]?.name ?? "")} is no texture (.htex), library (.htexlib), recording (CSV, WAV, FLAC, NPY) or file of another haptic format (${known}).`);
  }
  if (others.length > 0) {
    const all = await named(others, problems);
    const made = await withProgress(all.length, (work: Work) => takeImports(all, work));
    problems.push(...made.problems);
    sentences.push(made.text);
    lost ||= made.lost;
  }
  sayOpened(sentences, lost, problems);
}

let last: Promise<void> = Promise.resolve();

/** Takes files once those that were taken before are open. */
export function take(files: readonly File[], problems: Problem[] = []) {
  last = last.catch(() => {}).then(() => takeAll(files, problems));
  return last;
}

interface Dropped {
  readonly files: readonly File[];
  readonly problems: readonly Problem[];
}

/** What is dropped. All is asked for at once, since the items of a drop are gone after its event. */
async function droppedIn(transfer: DataTransfer): Promise<Dropped> {
  const items = [...transfer.items].filter(({ kind }) => kind === "file");
  return joined(await Promise.all(items.map(dropped)));
}

/** Chromium's other way to folders. */
type Handled = DataTransferItem & { getAsFileSystemHandle?(): Promise<FileSystemDirectoryHandle> };

/** A file is taken as it is. In a page from disk, Chromium reads nothing by entries, and folders only by handles. */
async function dropped(item: Handled): Promise<Dropped> {
  const entry = item.webkitGetAsEntry();
  if (entry?.isDirectory) {
    const handle = location.protocol === "file:" ? item.getAsFileSystemHandle?.() : undefined;
    return inFolder(entry.name, () => (handle ? handle.then(inHandle) : inEntry(entry as FileSystemDirectoryEntry)));
  }
  const file = item.getAsFile();
  return { files: file ? [file] : [], problems: [] };
}

const joined = (all: readonly Dropped[]): Dropped => ({ files: all.flatMap(({ files }) => files), problems: all.flatMap(({ problems }) => problems) });

/** What is in a folder, in the order of the names. What cannot be read is a problem. */
async function inFolder(name: string, read: () => Promise<[string, () => Promise<Dropped>][]>): Promise<Dropped> {
  try {
    const all = await read();
    all.sort(([a], [b]) => a.localeCompare(b, "en", { numeric: true }));
    return joined(await Promise.all(all.map(([own, open]) => open().catch((error): Dropped => ({ files: [], problems: [{ name: own, error }] })))));
  } catch (error) {
    return { files: [], problems: [{ name, error }] };
  }
}

const one = (file: File): Dropped => ({ files: [file], problems: [] });

async function inEntry(folder: FileSystemDirectoryEntry): Promise<[string, () => Promise<Dropped>][]> {
  const reader = folder.createReader();
  const all: FileSystemEntry[] = [];
  for (;;) {
    const batch = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (batch.length === 0) break;
    all.push(...batch);
  }
  const open = (entry: FileSystemEntry) => () =>
    entry.isDirectory ? inFolder(entry.name, () => inEntry(entry as FileSystemDirectoryEntry)) : new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject)).then(one);
  return all.map((entry) => [entry.name, open(entry)]);
}

async function inHandle(folder: FileSystemDirectoryHandle): Promise<[string, () => Promise<Dropped>][]> {
  const all: [string, () => Promise<Dropped>][] = [];
  for await (const handle of folder.values()) all.push([handle.name, () => (handle.kind === "directory" ? inFolder(handle.name, () => inHandle(handle)) : handle.getFile().then(one))]);
  return all;
}

/** Takes what is dropped anywhere on the page. */
export function listenForDrops(target: HTMLElement) {
  const over = (event: DragEvent) => {
    event.preventDefault();
    target.classList.add("dropping");
  };
  target.addEventListener("dragover", over);
  target.addEventListener("dragleave", () => target.classList.remove("dropping"));
  target.addEventListener("drop", (event) => {
    event.preventDefault();
    target.classList.remove("dropping");
    if (event.dataTransfer) droppedIn(event.dataTransfer).then(({ files, problems }) => take(files, [...problems])).catch(fail);
  });
}
