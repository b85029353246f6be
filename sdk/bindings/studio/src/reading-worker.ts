// Reads recordings beside the page, with an author module of its own: a long recording takes seconds.

import { loadAuthor, setAuthorLibrary, setLibrary, type Author, type FitSettings, type NamedBytes, type ReadingSettings } from "htex";

/** What can be asked: functions of the author module. */
export interface Question {
  readonly call: "columns" | "process" | "recorded";
  readonly recordings: readonly NamedBytes[];
  readonly settings: ReadingSettings & Pick<FitSettings, "conditions"> & { rate?: number };
}

export type Reply = { readonly answer: unknown } | { readonly problem: string };

function answer(author: Author, { call, recordings, settings }: Question) {
  const [recording] = recordings;
  if (!recording) throw new Error("no recording is given");
  return call === "recorded" ? author.recorded([...recordings], { rate: 0, ...settings }) : author[call](recording, settings);
}

let loading: Promise<Author> | null = null;

/** Loads the module. It also contains the player, of which the library needs one. */
function load(module: WebAssembly.Module) {
  setLibrary(module);
  setAuthorLibrary(module);
  return loadAuthor();
}

addEventListener("message", async ({ data: { module, question } }: MessageEvent<{ module: WebAssembly.Module; question: Question }>) => {
  loading ??= load(module);
  const reply = await loading.then((author) => ({ answer: answer(author, question) })).catch((error): Reply => ({ problem: (error as Error).message }));
  postMessage(reply);
});
