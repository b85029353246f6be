// The author module: loaded when something is first made.

import { signal } from "@preact/signals";
import { loadAuthor, type Author } from "htex";

import { setAuthor } from "./modules.ts";

let loading: Promise<Author> | null = null;

/** The module once it is there. */
export const author = signal<Author | null>(null);

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
