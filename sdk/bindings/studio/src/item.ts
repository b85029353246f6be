// A texture on the shelf. It is opened when it is first seen or heard: a shelf may have thousands.

import { signal, type ReadonlySignal, type Signal } from "@preact/signals";
import { open, type Texture } from "htex";

import { whenFree } from "./slices.ts";

/** An open texture, and the model that plays. */
export interface Opened {
  readonly texture: Texture;
  readonly model: string;
}

/** What is said of a texture without opening it. */
export interface Facts {
  readonly id: string;
  readonly name: string;
  readonly tags: readonly string[];
  readonly bytes: Uint8Array;
  readonly isOwn: boolean;
  /** When it came to the shelf, for the user's own textures. */
  readonly added: number;
}

export interface Item extends Facts {
  /** What a search looks at: the name and the tags in small letters. */
  readonly text: string;
  /** Whether it is there again when the page is opened the next time. */
  readonly isKept: Signal<boolean>;
  /** The texture; null until it was opened. */
  readonly opened: ReadonlySignal<Opened | null>;
  readonly open: () => Promise<Opened>;
  /** Opens it to be seen, after those that were asked for before. The function that is returned takes that back. */
  readonly see: () => () => void;
  readonly free: () => void;
}

/** A texture with the model that plays. A texture that cannot be played is freed. */
export function withModel(texture: Texture): Opened {
  try {
    const voice = texture.voice();
    const { model } = voice;
    voice.free();
    return { texture, model };
  } catch (error) {
    texture.free();
    throw error;
  }
}

const openWithModel = async (bytes: Uint8Array) => withModel(await open(bytes));

/** The name and the tags of a texture. One that cannot be played is refused. */
export async function factsOf(bytes: Uint8Array) {
  const { texture } = await openWithModel(bytes);
  const { name, manifest } = texture;
  texture.free();
  return { name, tags: (manifest["tags"] as string[] | undefined) ?? [] };
}

export function shelved(facts: Facts): Item {
  const tags = facts.isOwn ? ["yours", ...facts.tags] : facts.tags;
  const opened = signal<Opened | null>(null);
  let opening: Promise<Opened> | null = null;
  const openOnce = () => {
    opening ??= openWithModel(facts.bytes).then((now) => (opened.value = now));
    return opening;
  };
  return {
    ...facts,
    tags,
    text: [facts.name, ...tags].join(" ").toLowerCase(),
    isKept: signal(true),
    opened,
    open: openOnce,
    // What cannot be opened has no picture; it is told why when it is pressed.
    see: () => (opening ? () => {} : whenFree(() => openOnce().catch(() => {}))),
    free: () => {
      opened.peek()?.texture.free();
      opened.value = null;
      opening = null;
    },
  };
}
