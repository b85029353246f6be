// The textures on the shelf: the page's own textures, and the user's.

import { computed, signal } from "@preact/signals";
import { Library } from "htex";

import shelfAddress from "../shelf/shelf.htexlib?url";
import { factsOf, shelved, type Item } from "./item.ts";
import type { Problem, Work } from "./opening.ts";
import { breathe } from "./slices.ts";
import { forgetOwn, keepOwn, ownIds, ownTextures, type Own } from "./store.ts";

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

async function item(id: string, bytes: Uint8Array, isOwn: boolean, added = 0): Promise<Item> {
  return shelved({ id, bytes, isOwn, added, ...(await factsOf(bytes)) });
}

/** The textures that come with the page. */
async function unpack(library: Library) {
  const unpacked: Item[] = [];
  for await (const { name } of library.entries()) unpacked.push(await item(name, await library.bytes(name), false));
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
  readOwn().catch(() => {});
}

async function readOwn() {
  const ids = await ownIds();
  const mine: Item[] = [];
  for (let at = 0; at < ids.length; at += BATCH) {
    for (const own of await ownTextures(ids.slice(at, at + BATCH))) {
      const read = own && (await kept(own).catch(() => null));
      if (read) mine.push(read);
    }
  }
  place(mine);
}

/** What was kept of a texture. One that an earlier version of the page kept is opened to be read. */
async function kept({ id, name, tags: own, bytes, added }: Own): Promise<Item> {
  await breathe();
  return own ? shelved({ id, name, tags: own, bytes, added, isOwn: true }) : item(id, bytes, true, added);
}

function ownOf({ id, name, tags: all, bytes, added }: Item): Own {
  return { id, name, tags: all.slice(1), bytes, added };
}

/** Puts textures on the shelf: the user's own, the newest first, then those of the page. */
function place(some: readonly Item[]) {
  const ids = new Set(some.map(({ id }) => id));
  items.value = [...some, ...items.peek().filter(({ id }) => !ids.has(id))].sort((a, b) => b.added - a.added);
}

const newId = () => `own ${crypto.randomUUID()}`;

/** Keeps a texture on this device. */
export async function add(bytes: Uint8Array): Promise<Item> {
  const added = await item(newId(), bytes, true, Date.now());
  place([added]);
  await keepOwn([ownOf(added)]);
  return added;
}

/** A texture in a file or a library, which is not yet read. */
export interface Source {
  readonly name: string;
  readonly bytes: () => Promise<Uint8Array>;
}

/** Keeps textures on this device, in their order. One that cannot be read is told, and the next one is taken. */
export async function addAll(sources: AsyncIterable<Source>, { step, signal: stopped }: Work) {
  const [added, problems]: [Item[], Problem[]] = [[], []];
  const began = Date.now();
  let batch: Item[] = [];
  const put = async () => {
    const some = batch;
    batch = [];
    added.push(...some);
    place(some);
    await keepOwn(some.map(ownOf)).catch((error) => problems.push({ name: "This device", error }));
  };
  for await (const { name, bytes } of sources) {
    if (stopped.aborted) break;
    step(name);
    try {
      // The first is the newest.
      batch.push(await item(newId(), await bytes(), true, began - (added.length + batch.length) / 1e3));
    } catch (error) {
      problems.push({ name, error });
    }
    if (batch.length === BATCH) await put();
    await breathe();
  }
  await put();
  return { added, problems };
}

export async function forget(gone: Item) {
  items.value = items.value.filter((other) => other !== gone);
  await forgetOwn(gone.id);
  gone.free();
}
