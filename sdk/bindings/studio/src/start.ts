// What happens once, when the page is opened: the shelf is filled, the texture of the address or of last time comes to the pad, and sound
// waits for the first press.

import { effect } from "@preact/signals";

import { listenForDrops } from "./drop.ts";
import { author } from "./author.ts";
import { audioContext, heard, playingNode, run, sound, tried, wake, warm } from "./engine.ts";
import { fromLink } from "./link.ts";
import { finger, rest } from "./motion.ts";
import { handles, moveHandle, setMacro } from "./shaping/session.ts";
import { setPlayer } from "./modules.ts";
import { fill, items } from "./shelf.ts";
import { begin, depth, fail, present, redo, say, screen, texture, undo, type Document } from "./state.ts";
import { keepWork, lastWork } from "./store.ts";

/** Texture that is on the pad when the page is opened for the first time. */
const FIRST = "Coarse fabric";
/** Milliseconds after the last edit at which the work is kept. */
const AUTOSAVE_MS = 400;

/** A texture of the address comes to the pad; true if there is one. */
async function openLink() {
  const bytes = fromLink(location.href);
  if (!bytes) return false;
  await begin(bytes, "open a link");
  say(`${present.peek()?.name ?? "A texture"} came with the link.`, "good");
  screen.value = "shape";
  return true;
}

async function openLast() {
  const work = await lastWork<Document>().catch(() => undefined);
  if (!work) return false;
  await begin(work.bytes, work.change, work.model);
  return true;
}

async function openFirst() {
  const first = items.peek().find(({ name }) => name === FIRST) ?? items.peek()[0];
  if (first) await begin(first.bytes, `open ${first.name}`);
}

function autosave() {
  let timer = 0;
  effect(() => {
    const now = present.value;
    clearTimeout(timer);
    if (now) timer = window.setTimeout(() => keepWork(now).catch(() => {}), AUTOSAVE_MS);
  });
}

function silence() {
  rest();
  tried.value = null;
}

function keys(event: KeyboardEvent) {
  if (event.key === "Escape") silence();
  const isText = event.target instanceof HTMLInputElement && /^(text|search|number)$/.test(event.target.type);
  if (isText || event.target instanceof HTMLTextAreaElement || !(event.ctrlKey || event.metaKey)) return;
  const key = event.key.toLowerCase();
  const action = key === "z" ? (event.shiftKey ? redo : undo) : key === "y" ? redo : null;
  if (!action) return;
  event.preventDefault();
  action().catch(fail);
}

/** Keeps a phone's screen on while one plays. */
function stayAwake() {
  let lock: WakeLockSentinel | null = null;
  const ask = async () => {
    if (!lock && "wakeLock" in navigator && document.visibilityState === "visible") {
      lock = await navigator.wakeLock.request("screen");
      lock.addEventListener("release", () => (lock = null));
    }
  };
  const quietly = () => void ask().catch(() => {});
  effect(() => {
    if (sound.value === "on") quietly();
    else void lock?.release();
  });
  document.addEventListener("visibilitychange", () => sound.peek() === "on" && quietly());
}

export function start() {
  run();
  const player = setPlayer();
  autosave();
  stayAwake();
  listenForDrops(document.body);
  addEventListener("pointerdown", wake, { capture: true });
  addEventListener("keydown", wake, { capture: true });
  addEventListener("keydown", keys);
  addEventListener("hashchange", () => openLink().catch(fail));
  // Leaving the page in the middle of a stroke leaves no sound behind.
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && silence());
  // A link that is cut off is told, and the page goes on without it.
  const or = (error: unknown) => (fail(error), false);
  const opened = async () => (await openLink().catch(or)) || (await openLast().catch(or));
  player
    .then(() => {
      warm().catch(fail);
      return Promise.all([opened(), fill()]);
    })
    .then(async ([isThere]) => {
      if (!isThere) await openFirst();
      document.documentElement.dataset["ready"] = "yes";
      performance.mark("ready");
    })
    .catch(fail);
  // `htex studio` serves at a name of `.localhost`, and refuses the worker: it is there without a network anyway.
  const isServed = location.protocol.startsWith("http") && !location.hostname.endsWith(".localhost");
  if ("serviceWorker" in navigator && isServed && import.meta.env.MODE === "static") {
    navigator.serviceWorker.register("./sw.js").catch(() => {});
  }
}

/** What scripts, such as the tests', may look at and call in the console: `htexStudio`. */
export const scripted = { audioContext, playingNode, heard, finger, present, texture, author, begin, undo, redo, depth, moveHandle, setMacro, handles };
Object.assign(globalThis, { htexStudio: scripted });
