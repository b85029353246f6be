// The textures on the shelf: the page's own textures, and the user's.

import { computed, signal } from "@preact/signals";
import { Library } from "htex";

import shelfAddress from "../shelf/shelf.htexlib?url";
import { factsOf, shelved, type Item } from "./item.ts";
import { isolated } from "./names.ts";
import type { Problem, Work } from "./opening.ts";
import { breathe } from "./slices.ts";
import { notice, say, type Notice } from "./state.ts";
import { forgetOwn, inTime, keepOwn, ownIds, ownTextures, type Own } from "./store.ts";
import { onTold, tell } from "./tabs.ts";

export type { Item };

export const items = signal<readonly Item[]>([]);
export const search = signal("");
export const chosenTag = signal<string | null>(null);

export const tags = computed(() => {
  const counts = new Map<string, number>();
  for (const tag of items.value.flatMap((item) => item.tags)) counts.set(tag, (counts.get(tag) ?? 0) + 1);
  return [...counts].sort(([a, m], [b, n]) => n - m || a.localeCompare(b)).map(([tag]) => tag);
});

export const found = computed(() => {
  const words = search.value.toLowerCase().split(/\s+/).filter(Boolean);
  const has = ({ text }: Item) => words.every((word) => text.includes(word));
  return items.value.filter((item) => has(item) && (!chosenTag.value || item.tags.includes(chosenTag.value)));
});

async function item(id: string, bytes: Uint8Array, added: number): Promise<Item> {
  return shelved({ id, bytes, isOwn: true, added, ...(await factsOf(bytes)) });
}

/** The textures that come with the page. The library states their names and tags, so none is opened yet. */
async function unpack(library: Library) {
  const unpacked: Item[] = [];
  for await (const { name, tags } of library.entries()) unpacked.push(shelved({ id: name, name, tags, bytes: await library.bytes(name), isOwn: false, added: 0 }));
  library.free();
  return unpacked;
}

/** Textures that are read, kept and shown at once: each time costs a transaction and a new list, and all of them are in one task. */
const BATCH = 64;

/** Reads what comes with the page, and then, without being waited for, what is kept on this device. */
export async function fill() {
  const response = await fetch(shelfAddress);
  if (!response.ok) throw new Error(`the shelf cannot be read: ${response.status} ${response.statusText}; reload the page`);
  items.value = await unpack(await Library.open(await response.arrayBuffer()));
  onTold("own", () => void readOwn());
  void readOwn();
}

let reading: Promise<void> = Promise.resolve();

/** Brings the shelf in step with what this browser keeps: another tab may have added textures, or forgotten some. */
function readOwn(): Promise<void> {
  // If it fails, the store's `refusal` says so.
  return (reading = reading.then(compareOwn).catch(() => {}));
}

async function compareOwn() {
  // What comes to the shelf from here on may not be among the ids.
  const before = items.peek();
  const there = new Set(await ownIds());
  const gone = new Set(before.filter(({ id, isOwn, isKept }) => isOwn && isKept.peek() && !there.has(id)));
  const here = new Set(items.peek().map(({ id }) => id));
  const missing = [...there].filter((id) => !here.has(id));
  const mine: Item[] = [];
  for (let at = 0; at < missing.length; at += BATCH) {
    for (const own of await ownTextures(missing.slice(at, at + BATCH))) {
      const read = own && (await kept(own).catch(() => null));
      if (read) mine.push(read);
    }
  }
  if (mine.length + gone.size > 0) place(mine, gone);
}

/** What was kept of a texture. One that an earlier version of the page kept is opened to be read. */
async function kept({ id, name, tags: own, bytes, added }: Own): Promise<Item> {
  await breathe();
  return own ? shelved({ id, name, tags: own, bytes, added, isOwn: true }) : item(id, bytes, added);
}

function ownOf({ id, name, tags: all, bytes, added }: Item): Own {
  return { id, name, tags: all.slice(1), bytes, added };
}

/** Puts textures on the shelf: the user's own, the newest first, then those of the page. */
function place(some: readonly Item[], gone: ReadonlySet<Item> = new Set()) {
  const ids = new Set(some.map(({ id }) => id));
  const others = items.peek().filter((one) => !ids.has(one.id) && !gone.has(one));
  items.value = [...some, ...others].sort((a, b) => b.added - a.added);
}

const newId = () => `own ${crypto.randomUUID()}`;

/** Puts a texture on the shelf, and keeps it on this device if the browser does. */
export async function add(bytes: Uint8Array): Promise<Item> {
  const added = await item(newId(), bytes, Date.now());
  await keepAll([added]);
  return added;
}

async function keepAll(some: readonly Item[]) {
  const setKept = (isKept: boolean) => some.forEach((one) => (one.isKept.value = isKept));
  const writing = keepOwn(some.map(ownOf)).then(() => tell("own"));
  const isKept = await inTime(writing).then(() => true, () => false);
  setKept(isKept);
  place(some);
  // They may be written late.
  if (!isKept) writing.then(() => setKept(true), () => {});
}

/** What is to be said of those textures that the browser did not store; empty if it stored all. */
export function lostText(some: readonly Item[]) {
  const lost = some.filter(({ isKept }) => !isKept.peek()).length;
  if (lost === 0) return "";
  const what = some.length === 1 ? "it" : lost === some.length ? "them" : `${lost} of them`;
  return `The browser did not store ${what}: save as a file what you want to have later.`;
}

/** A texture in a file or a library, which is not yet read. */
export interface Source {
  readonly name: string;
  readonly bytes: () => Promise<Uint8Array>;
}

/** Puts textures on the shelf, in their order. One that cannot be read is told, and the next one is taken. */
export async function addAll(sources: AsyncIterable<Source>, { step, signal: stopped }: Work) {
  const [added, problems]: [Item[], Problem[]] = [[], []];
  const began = Date.now();
  let batch: Item[] = [];
  const put = async () => {
    const some = batch;
    batch = [];
    added.push(...some);
    await keepAll(some);
  };
  for await (const { name, bytes } of sources) {
    if (stopped.aborted) break;
    step(name);
    try {
      // The first is the newest.
      batch.push(await item(newId(), await bytes(), began - (added.length + batch.length) / 1e3));
    } catch (error) {
      problems.push({ name, error });
    }
    if (batch.length === BATCH) await put();
    await breathe();
  }
  await put();
  return { added, problems };
}

/** What the message on the page offers to bring back. */
let forgotten: { items: readonly Item[]; told: Notice | null } = { items: [], told: null };

/** Takes a texture from the shelf. The message offers Undo. */
export async function forget(gone: Item) {
  items.value = items.peek().filter((other) => other !== gone);
  gone.free();
  const before = notice.peek() === forgotten.told ? forgotten.items : [];
  const all = [...before, gone];
  const what = all.length === 1 ? `${isolated(gone.name)} is` : `${all.length} textures are`;
  forgotten = { items: all, told: say(`${what} no longer on the shelf.`, "plain", { undo: () => bringBack(all) }) };
  if (gone.isKept.peek()) await forgetOwn(gone.id);
  // Meanwhile another tab may have made this one read it again.
  items.value = items.peek().filter(({ id }) => id !== gone.id);
  tell("own");
}

async function bringBack(some: readonly Item[]) {
  notice.value = null;
  await keepAll(some);
  const lost = lostText(some);
  const what = some.length === 1 ? `${isolated(some[0]?.name ?? "")} is` : `${some.length} textures are`;
  say(`${what} on the shelf. ${lost}`.trim(), lost ? "bad" : "good");
}
