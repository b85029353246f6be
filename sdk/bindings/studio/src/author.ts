// The author module: loaded when something is first made.

import { computed, signal } from "@preact/signals";
import { loadAuthor, type Author, type Model } from "htex";

import { setAuthor } from "./modules.ts";

let loading: Promise<Author> | null = null;

/** The module once it is there. */
export const author = signal<Author | null>(null);

/** The descriptors of its models. */
export const models = computed<Model[]>(() => author.value?.models() ?? []);

/** The name of a model by its id. */
export const nameOf = (id: string) => models.value.find((one) => one.id === id)?.name ?? id.replace("org.htex.", "");

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
