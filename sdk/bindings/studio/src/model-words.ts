// Models, named by what they do. Engineers know them by other names, which the page shows beside.

import { nameOf } from "./author.ts";

const WORDS: Readonly<Record<string, string>> = {
  "org.htex.bands": "free curve",
  "org.htex.speak": "ridges",
  "org.htex.sslope": "one hump",
  "org.htex.sbeta": "rise and fall",
  "org.htex.ar": "measured",
  "org.htex.arma": "measured, with dips",
  "org.htex.mfcc": "measured outline",
  "org.htex.map": "surface picture",
};

/** What a model does, in two or three words; for a third-party model, its name. */
export const wordsOf = (id: string) => WORDS[id] ?? nameOf(id);

/** The words with the name, e.g. "free curve (Bands)". */
export const titleOf = (id: string) => (WORDS[id] ? `${WORDS[id]} (${nameOf(id)})` : nameOf(id));
