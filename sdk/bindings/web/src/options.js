// Checks options: their names and types. An unknown name is an error, because otherwise it would
// silently have no effect.

import { HtexError, toBytes } from "./core.js";

/** Options that require a signature; see `Signed` in index.d.ts. */
export const SIGNED = { onlySignedBy: "any", signature: "any" };
export const OPEN = { modules: "array", embedded: "boolean", trusted: "boolean", ...SIGNED };
export const AT = { model: "string", at: "object" };
export const READ = { model: "string", condition: "number" };
export const VOICE = {
  model: "string",
  rate: "number",
  seed: "integer",
  motion: "object",
  synthesis: "string",
  frequencyScaling: "boolean",
  levelScaling: "boolean",
  contact: "boolean",
  ceiling: "number",
  fluctuation: "boolean",
  gain: "number",
  limit: "number",
  bands: "number",
};
const MOTION_OPTIONS = { speed: "number", force: "number", position: "number", x: "number", y: "number" };

/**
 * Returns the keys of which one must have signed, and the signature that was given; an empty object
 * if no signature is required.
 */
export function signedBy({ onlySignedBy, signature }, call) {
  if (onlySignedBy === undefined) {
    if (signature === undefined) return {};
    throw new HtexError(`${call}: a signature is of use only with onlySignedBy; give the keys that you accept`, "invalid-argument");
  }
  const keys = typeof onlySignedBy === "string" ? [onlySignedBy] : onlySignedBy;
  const areKeys = Array.isArray(keys) && keys.length > 0 && keys.every((key) => typeof key === "string");
  if (!areKeys) throw new HtexError(`${call}: onlySignedBy is a public key in hexadecimal digits, or an array of them`, "invalid-argument");
  return { onlySignedBy: keys, signature: signature === undefined ? undefined : toBytes(signature).slice() };
}

const IS = {
  array: Array.isArray,
  object: (value) => typeof value === "object" && value !== null,
  integer: (value) => typeof value === "bigint" || Number.isSafeInteger(value),
};

function typeIs(value, type) {
  return type === "any" || (IS[type] ? IS[type](value) : typeof value === type);
}

/** Returns the number of letters to add, remove or replace to turn one word into the other. */
function distance(a, b) {
  let row = Array.from({ length: b.length + 1 }, (_, i) => i);
  for (let i = 1; i <= a.length; i++) {
    const next = [i];
    for (let k = 1; k <= b.length; k++) {
      next.push(Math.min(next[k - 1] + 1, row[k] + 1, row[k - 1] + (a[i - 1] === b[k - 1] ? 0 : 1)));
    }
    row = next;
  }
  return row[b.length];
}

function unknown(name, known, what) {
  const nearest = known.map((other) => [distance(name.toLowerCase(), other.toLowerCase()), other]).sort(([a], [b]) => a - b)[0];
  const advice = nearest && nearest[0] <= 3 ? `did you mean \`${nearest[1]}\`?` : `there are ${known.join(", ")}`;
  return new HtexError(`${what} has no option \`${name}\`; ${advice}`, "invalid-argument");
}

/**
 * Checks the names and types of options against `known`, and returns the options. `what` names the
 * call in errors.
 */
export function checked(options, known, what) {
  if (!IS.object(options)) throw new HtexError(`the options of ${what} are an object, such as { model: "ar" }`, "invalid-argument");
  for (const [name, value] of Object.entries(options)) {
    if (!Object.hasOwn(known, name)) throw unknown(name, Object.keys(known), what);
    if (value !== undefined && !typeIs(value, known[name])) {
      const given = value === null ? "null" : Array.isArray(value) ? "array" : typeof value;
      throw new HtexError(`${what}: \`${name}\` must be of the type ${known[name]}, not ${given}`, "invalid-argument");
    }
  }
  for (const name of ["motion", "at"]) if (options[name]) checked(options[name], MOTION_OPTIONS, `\`${name}\` of ${what}`);
  return options;
}

/** Checks a motion that is passed as its own argument. */
export function checkedMotion(motion, what) {
  return motion === undefined ? motion : checked(motion, MOTION_OPTIONS, `the motion of ${what}`);
}
