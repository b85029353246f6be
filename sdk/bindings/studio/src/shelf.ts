// The textures on the shelf: the page's own textures, and the user's.

import { computed, signal } from "@preact/signals";
import { Library, open, type Texture } from "htex";

import shelfAddress from "../shelf/shelf.htexlib?url";
import { forgetOwn, keepOwn, ownTextures, type Own } from "./store.ts";

export interface Item {
  readonly id: string;
  readonly name: string;
  readonly tags: readonly string[];
  readonly bytes: Uint8Array;
  readonly texture: Texture;
  /** Model that plays. */
  readonly model: string;
  readonly isOwn: boolean;
}

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
  const has = ({ name, tags: own }: Item) => {
    const text = [name, ...own].join(" ").toLowerCase();
    return words.every((word) => text.includes(word));
  };
  return items.value.filter((item) => has(item) && (!chosenTag.value || item.tags.includes(chosenTag.value)));
});

async function item(id: string, bytes: Uint8Array, isOwn: boolean): Promise<Item> {
  const texture = await open(bytes);
  const voice = texture.voice();
  const { model } = voice;
  voice.free();
  const own = isOwn ? ["yours"] : [];
  return { id, name: texture.name, tags: [...own, ...((texture.manifest["tags"] as string[] | undefined) ?? [])], bytes, texture, model, isOwn };
}

/** Puts the textures of a library on the shelf. */
async function unpack(library: Library, isOwn: boolean) {
  const unpacked: Item[] = [];
  for await (const { name } of library.entries()) {
    const bytes = await library.bytes(name);
    unpacked.push(await item(isOwn ? `own ${name}` : name, bytes, isOwn));
  }
  library.free();
  return unpacked;
}

/** Reads what comes with the page, and what is kept on this device. */
export async function fill() {
  const response = await fetch(shelfAddress);
  if (!response.ok) throw new Error(`the shelf cannot be read: ${response.status} ${response.statusText}; reload the page`);
  items.value = await unpack(await Library.open(await response.arrayBuffer()), false);
  const own = await ownTextures().catch(() => [] as Own[]);
  const mine = await Promise.all(own.map(({ id, bytes }) => item(id, bytes, true)));
  items.value = [...mine, ...items.value];
}

/** Keeps a texture on this device. */
export async function add(bytes: Uint8Array): Promise<Item> {
  const id = `own ${crypto.randomUUID()}`;
  const added = await item(id, bytes, true);
  items.value = [added, ...items.value];
  await keepOwn({ id, name: added.name, bytes, added: Date.now() });
  return added;
}

/** Keeps all textures of a library on this device. */
export async function addLibrary(bytes: Uint8Array) {
  const library = await Library.open(bytes);
  const added: Item[] = [];
  for await (const { name } of library.entries()) added.push(await add(await library.bytes(name)));
  library.free();
  return added.length;
}

export async function forget(gone: Item) {
  items.value = items.value.filter((other) => other !== gone);
  await forgetOwn(gone.id);
  gone.texture.free();
}
