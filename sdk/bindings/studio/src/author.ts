// The author module: loaded when something is first made.

import { computed, signal } from "@preact/signals";
import { loadAuthor, type Author, type Model } from "htex";

import { setAuthor } from "./modules.ts";

let loading: Promise<Author> | null = null;

/** The module once it is there. */
export const author = signal<Author | null>(null);

/** The descriptors of its models. */
export const models = computed<Model[]>(() => author.value?.models() ?? []);

export function theAuthor(): Promise<Author> {
  loading ??= setAuthor().then(loadAuthor).then(
    (loaded) => (author.value = loaded),
    (error) => {
      loading = null;
      throw error;
    },
  );
  return loading;
}
