// The blind test: ten trials, in which X is one of two sides. From the first trial on, the pair and
// the settings stay the same.

import { batch, computed, signal } from "@preact/signals";
import { open } from "htex";

import { isSame } from "./bytes.ts";
import { chosen, frozen, isMatched, pair, play, stop, type Pair, type Played, type Side } from "./comparing.ts";
import { AUDIBLE, audible } from "./engine.ts";

export const TRIALS = 10;

interface Trial {
  readonly x: Side;
  readonly answer: Side;
  readonly seconds: number;
}

/** The pair of the running or last test, and the factor of its frequencies. */
const tested = signal<(Pair & { readonly pitch: number }) | null>(null);
const trials = signal<readonly Trial[]>([]);
/** The side that X is. Nothing on the page may depend on it. */
let x: Side = "a";
let began = 0;
let begins = 0;

function draw() {
  const [bit = 0] = crypto.getRandomValues(new Uint8Array(1));
  x = bit % 2 === 0 ? "a" : "b";
  began = performance.now();
}

/** The pair with its own copies of the textures, which no edit frees. */
async function withCopies(of: Pair): Promise<Pair> {
  const { a, b } = of;
  const textures = [...new Set([a.texture, b.texture])];
  const copies = await Promise.all(textures.map((texture) => open(texture.toBytes())));
  const own = (side: Played) => ({ ...side, texture: copies[textures.indexOf(side.texture)] ?? side.texture });
  return { ...of, a: own(a), b: own(b) };
}

function free({ a, b }: Pair) {
  for (const texture of new Set([a.texture, b.texture])) texture.free();
}

function forget() {
  const before = tested.peek();
  tested.value = null;
  trials.value = [];
  if (before) free(before);
}

export async function beginTest() {
  const now = pair();
  if (!now || frozen.peek()) return;
  begins += 1;
  const ticket = begins;
  const own = await withCopies(now);
  if (ticket !== begins) return free(own);
  batch(() => {
    forget();
    tested.value = { ...own, pitch: audible.peek() ? AUDIBLE : 1 };
    frozen.value = own;
    draw();
    playX();
  });
}

export function playX() {
  if (frozen.peek()) play("x", x);
}

export function answer(given: Side) {
  if (!frozen.peek()) return;
  trials.value = [...trials.peek(), { x, answer: given, seconds: (performance.now() - began) / 1e3 }];
  if (trials.peek().length === TRIALS) return end();
  draw();
  playX();
}

function end() {
  batch(() => {
    stop();
    frozen.value = null;
  });
}

/** Silences both sides, and discards an unfinished test. */
export function abandon() {
  begins += 1;
  const isOn = frozen.peek() !== null;
  end();
  if (isOn) forget();
}

function playsAlike(one: Played, other: Played | null) {
  if (!other || one.model !== other.model || one.loop?.recording !== other.loop?.recording) return false;
  return isSame(one.texture.toBytes(), other.texture.toBytes());
}

export interface Result {
  readonly pair: Pair;
  /** Whether another pair or another setting of the levels is chosen now. */
  readonly isOther: boolean;
  readonly trials: readonly Trial[];
  readonly right: number;
}

/** The trials so far, with the pair that they test. */
export const result = computed<Result | null>(() => {
  const of = tested.value;
  if (!of) return null;
  const { a, b } = chosen.value;
  const isOther = !frozen.value && !(of.isMatched === isMatched.value && playsAlike(of.a, a) && playsAlike(of.b, b));
  return { pair: of, isOther, trials: trials.value, right: trials.value.filter(({ x: was, answer: given }) => was === given).length };
});

/** The p-value: the probability that guessing is at least as far from half right (two-sided). */
export function chance(right: number, of: number) {
  const far = Math.max(right, of - right);
  let [sum, ways] = [0, 1];
  for (let k = 0; k <= of; k++) {
    if (k >= far) sum += ways;
    ways = (ways * (of - k)) / (k + 1);
  }
  return Math.min((2 * sum) / 2 ** of, 1);
}

/** The trials as a CSV table. Each row names the pair that was tested. */
export function toCsv() {
  const of = tested.peek();
  const quoted = (text = "") => `"${text.replaceAll('"', '""')}"`;
  const rows = trials.peek().map(({ x: was, answer: given, seconds }, i) =>
    [i + 1, was, given, Number(was === given), seconds.toFixed(2), of?.pitch, quoted(of?.a.name), quoted(of?.b.name), Number(of?.isMatched)].join(","),
  );
  return ["trial,x,answer,correct,seconds,pitch,a,b,levels_matched", ...rows, ""].join("\n");
}
