// Files that are dropped or chosen: textures, libraries, recordings, folders.

import { add, addLibrary } from "./shelf.ts";
import { begin, fail, say, screen } from "./state.ts";
import { recordings } from "./recordings.ts";

async function bytesOf(file: File) {
  return new Uint8Array(await file.arrayBuffer());
}

const isRecording = (name: string) => /\.(csv|tsv|txt|wav|flac|npy)$/i.test(name);

/** Takes files: textures go to the shelf, and the first one to the pad; recordings to their screen. */
export async function take(files: readonly File[]) {
  const textures = files.filter(({ name }) => /\.htex$/i.test(name));
  const libraries = files.filter(({ name }) => /\.htexlib$/i.test(name));
  const taken = files.filter(({ name }) => isRecording(name));
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
    recordings.value = await Promise.all(taken.map(async (file) => ({ name: file.name, bytes: await bytesOf(file) })));
    screen.value = "record";
  } else if (textures.length + libraries.length === 0 && files.length > 0) {
    say(`${files[0]?.name} is no texture (.htex), library (.htexlib) or recording (CSV, WAV, FLAC, NPY).`, "bad");
  }
}

/** All files of what was dropped, those in folders, too. */
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
