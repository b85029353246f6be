// The fixtures of the tests: assets and samples that the `htex` command wrote.

import { readFile } from "node:fs/promises";
import path from "node:path";

/** The package under test, and the fixtures. */
export const { HTEX_PACKAGE, HTEX_FIXTURES } = process.env;

export const bytes = (name) => readFile(path.join(HTEX_FIXTURES, name));

/** The short names of the built-in models. `vinyl.htex` has a representation of each. */
export const MODELS = JSON.parse(await bytes("info.json")).representations.map(({ model }) => model.split(".").pop());

/** Returns the samples of a WAV file of 32-bit floats. */
export async function samples(name) {
  const file = await bytes(name);
  for (let at = 12; at < file.length; ) {
    const len = file.readUInt32LE(at + 4);
    if (file.toString("latin1", at, at + 4) === "data") {
      const data = file.buffer.slice(file.byteOffset + at + 8, file.byteOffset + at + 8 + len);
      return new Float32Array(data);
    }
    at += 8 + len + (len & 1);
  }
  throw new Error(`${name}: no data`);
}

/** Returns the index of the first difference, or -1. */
export function difference(a, b) {
  if (a.length !== b.length) return Math.min(a.length, b.length);
  const [x, y] = [a, b].map((s) => new Uint32Array(s.buffer, s.byteOffset, s.length));
  return x.findIndex((bits, i) => bits !== y[i]);
}
