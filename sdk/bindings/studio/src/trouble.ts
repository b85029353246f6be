// Errors in the words of someone who makes textures. The exact words are behind *Details*.

import { isolated } from "./names.ts";

export interface Trouble {
  readonly text: string;
  /** The exact message, with the code or the name of the error. */
  readonly details?: string;
}

const SOMETHING = "Something went wrong. Your texture is unchanged.";

/** Sentences by code of an `HtexError`. `%` stands for the name of the file, or for "The file". */
const BY_CODE: Readonly<Record<string, string>> = {
  "invalid-asset": "% cannot be opened. It is damaged, or it is not a texture.",
  "invalid-library": "% cannot be opened. It is damaged, or it is not a library of textures.",
  "invalid-file": "% cannot be opened. It is damaged, or it is not what its name says.",
  "truncated": "% cannot be opened. A part of it is missing.",
  "invalid-argument": "A value is missing or too large or too small.",
  "no-representation": "This texture has no model that can play here.",
  "no-model": "This page does not have the model that the texture needs.",
  "model": "The model of this texture has failed.",
  "untrusted": "The texture brings its own program as a model, and the page does not run it here.",
  "io": "The page could not load one of its parts. Check the connection and reload the page.",
  "unsupported": "This browser cannot do that.",
  "device": "The output has failed. Choose another one.",
};

/** Sentences by name of a `DOMException`. */
const BY_NAME: Readonly<Record<string, string>> = {
  NotAllowedError: "The browser did not allow this.",
  NotFoundError: "The file or the output is not there any more.",
  NotReadableError: "The file cannot be read. Another program may use it, or you may not have access.",
  QuotaExceededError: "There is no room left for textures on this device. Save the texture as a file instead.",
};

/** The file name at the beginning of a message, e.g. of "torn.ahap: line 3 …". */
const fileOf = (message: string) => /^([^:]{1,80}\.\w{1,7}): /.exec(message)?.[1];

/** `file`: the name of the file that was to be opened. */
export function troubleOf(error: unknown, file?: string): Trouble {
  if (!(error instanceof Error)) return { text: String(error) };
  const { message, name } = error;
  const { code } = error as { code?: unknown };
  if (typeof code === "string") {
    const text = (BY_CODE[code] ?? SOMETHING).replace("%", () => isolated(fileOf(message) ?? file ?? "The file"));
    return { text, details: `${message} (${code})` };
  }
  // The page's own errors are already written for users.
  if (name === "Error") return { text: message.charAt(0).toUpperCase() + message.slice(1) };
  return { text: BY_NAME[name] ?? SOMETHING, details: `${message} (${name})` };
}
