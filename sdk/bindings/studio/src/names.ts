// Names that other people wrote, in the page's sentences.

const CONTROLS = /[\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069]/g;
const RIGHT_TO_LEFT = /[\u0590-\u08ff\ufb1d-\ufdff\ufe70-\ufeff\u{10800}-\u{10fff}\u{1e800}-\u{1efff}]/u;
const [ISOLATE, END] = ["\u2068", "\u2069"];

/** A name without the characters that change the direction of text. Not even an element for isolation holds them: one that is left open reaches beyond it. */
export const withoutControls = (name: string) => name.replaceAll(CONTROLS, "");

/** A name for plain text, such as a message or an option: one of another direction does not turn the words around it. Where there are elements, use `Name`. */
export function isolated(name: string): string {
  const plain = withoutControls(name);
  return RIGHT_TO_LEFT.test(plain) ? ISOLATE + plain + END : plain;
}

/** Words in a row: "a, b and c". */
export const list = (words: readonly string[]) => [words.slice(0, -1).join(", "), ...words.slice(-1)].filter(Boolean).join(" and ");
