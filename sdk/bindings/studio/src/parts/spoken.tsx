// Sentences that a screen reader says when they appear or change.

import { useEffect } from "preact/hooks";

import { speak } from "../spoken.ts";

/** Says a sentence, and takes it back when the component is removed. */
export function useSpoken(text: string) {
  useEffect(() => speak(text), [text]);
}

/** A sentence that is also shown. */
export function Spoken({ text }: { text: string }) {
  useSpoken(text);
  return <span class="small soft">{text}</span>;
}
