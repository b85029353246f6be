// What a screen reader says on its own. Many sentences on the page change, but only one matters at
// a time.

import { signal } from "@preact/signals";

/** The sentence that the page's only live region says in addition to the message. */
export const spoken = signal("");

/** Says a sentence. Returns a function that takes it back, so that it can be said again. */
export function speak(text: string) {
  spoken.value = text;
  return () => {
    if (spoken.peek() === text) spoken.value = "";
  };
}
