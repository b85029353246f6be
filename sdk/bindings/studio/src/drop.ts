// Files that are dropped or chosen: textures, libraries, recordings, files of other haptic formats, folders.

import { EXTENSIONS, isImported, takeImports } from "./imports.ts";
import { add, addLibrary } from "./shelf.ts";
import { begin, fail, say, screen } from "./state.ts";
import { recordings } from "./recordings.ts";

async function bytesOf(file: File) {
  return new Uint8Array(await file.arrayBuffer());
}

async function named(file: File) {
  return { name: file.name, bytes: await bytesOf(file) };
}

const RECORDINGS = ["csv", "tsv", "txt", "wav", "flac", "npy"];

const isRecording = (name: string) => RECORDINGS.some((extension) => name.toLowerCase().endsWith(`.${extension}`));

const dotted = (extensions: readonly string[]) => extensions.map((extension) => `.${extension}`).join(",");

/** What is chosen as a recording, and all that is opened, for inputs of files. */
export const READ = dotted([...RECORDINGS, ...EXTENSIONS]);
export const OPENED = dotted(["htex", "htexlib", ...RECORDINGS, ...EXTENSIONS]);

/** Takes files: textures go to the shelf, and the first one to the pad; recordings to their screen; files of other formats become textures. */
export async function take(files: readonly File[]) {
  const textures = files.filter(({ name }) => /\.htex$/i.test(name));
  const libraries = files.filter(({ name }) => /\.htexlib$/i.test(name));
  const taken = files.filter(({ name }) => isRecording(name));
  const others = files.filter(({ name }) => isImported(name));
  let first = true;
  for (const file of textures) {
    const item = await add(await bytesOf(file));
    if (first) await begin(item.bytes, `open ${file.name}`, item.model);
    first = false;
    say(`${item.name} is on the shelf${textures.length === 1 ? " and on the pad" : ""}.`, "good");
  }
  for (const file of libraries) {
    const count = await addLibrary(await bytesOf(file));
    say(`${count} textures of ${file.name} are on the shelf.`, "good");
  }
  if (taken.length > 0) {
    recordings.value = await Promise.all(taken.map(named));
    screen.value = "record";
  } else if (textures.length + libraries.length + others.length === 0 && files.length > 0) {
    const known = EXTENSIONS.map((extension) => `.${extension}`).join(", ");
    say(`${files[0]?.name} is no texture (.htex), library (.htexlib), recording (CSV, WAV, FLAC, NPY) or file of another haptic format (${known}).`, "bad");
  }
  await takeImports(await Promise.all(others.map(named)));
}

/** All dropped files, including the files in dropped folders. */
async function filesOf(transfer: DataTransfer): Promise<File[]> {
  const entries = [...transfer.items].map((item) => item.webkitGetAsEntry()).filter((entry) => entry !== null);
  if (entries.length === 0) return [...transfer.files];
  return (await Promise.all(entries.map(inEntry))).flat();
}

async function inEntry(entry: FileSystemEntry): Promise<File[]> {
  if (entry.isFile) return [await new Promise<File>((resolve, reject) => (entry as FileSystemFileEntry).file(resolve, reject))];
  const reader = (entry as FileSystemDirectoryEntry).createReader();
  const found: File[] = [];
  for (;;) {
    const batch = await new Promise<FileSystemEntry[]>((resolve, reject) => reader.readEntries(resolve, reject));
    if (batch.length === 0) return found;
    found.push(...(await Promise.all(batch.map(inEntry))).flat());
  }
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
    if (event.dataTransfer) filesOf(event.dataTransfer).then(take).catch(fail);
  });
}
