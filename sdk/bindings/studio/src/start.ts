// What happens once, when the page is opened: the shelf is filled, the texture of the address or of last time comes to the pad, and sound
// waits for the first press.

import { effect } from "@preact/signals";

import { listenForDrops } from "./drop.ts";
import { author } from "./author.ts";
import { audioContext, heard, playingNode, run, sound, tried, wake, warm } from "./engine.ts";
import { fromLink } from "./link.ts";
import { done, finish } from "./first-steps.ts";
import { slideGhost } from "./ghost.ts";
import { finger, isPiloted, rest } from "./motion.ts";
import { handles, moveHandle, setMacro } from "./shaping/session.ts";
import { setPlayer } from "./modules.ts";
import { fill, items } from "./shelf.ts";
import { begin, depth, fail, notice, present, redo, say, screen, texture, undo, type Notice } from "./state.ts";
import { loadScreens } from "./screens/scripts.ts";
import { reference } from "./reference.ts";
import { inTime, refusal } from "./store.ts";
import { keep, keepWork, suggest } from "./work.ts";

/** Texture that is on the pad when the page is opened for the first time. */
const FIRST = "Coarse fabric";

/** A texture of the address comes to the pad; true if there is one. */
async function openLink() {
  const bytes = fromLink(location.href);
  if (!bytes) return false;
  await begin(bytes, "open a link");
  // The browser keeps this over a reload, which then brings back what was made of the texture.
  history.replaceState({ isOpened: true }, "");
  say(`${present.peek()?.name ?? "A texture"} came with the link.`, "good");
  screen.value = "shape";
  return true;
}

async function openFirst() {
  const first = items.peek().find(({ name }) => name === FIRST) ?? items.peek()[0];
  if (first) await suggest(first.bytes, `open ${first.name}`);
}

/** Opens the texture of the address, or the work of last time. */
async function openWork() {
  // A link that is cut off is told, and the page goes on without it.
  const or = (error: unknown) => (fail(error), false);
  const isReload = history.state?.isOpened === true;
  if (!isReload && (await openLink().catch(or))) return;
  await inTime(keep()).catch(() => {});
  if (isReload && !present.peek()) await openLink().catch(or);
}

/** Says that the browser stores nothing, for as long as this is so. */
function tellRefusal() {
  let told: Notice | null = null;
  effect(() => {
    const why = refusal.value;
    if (why) told = say(`${why} The page works, but what you make is gone when you close it: save it as a file.`, "bad");
    else if (told && notice.peek() === told) notice.value = null;
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
  // While a message offers Undo, that is what was done last.
  const back = notice.peek()?.undo ?? undo;
  const action = key === "z" ? (event.shiftKey ? redo : back) : key === "y" ? redo : null;
  if (!action) return;
  event.preventDefault();
  Promise.resolve(action()).catch(fail);
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

/** Shows how to slide over the pad, until something is pressed. */
function showFirst() {
  effect(() => {
    if (finger.value.force > 0 && !isPiloted()) finish("touch");
  });
  if (!done.peek().has("touch")) slideGhost(() => sound.peek() !== "off" || finger.peek().force > 0);
}

export function start() {
  run();
  const player = setPlayer();
  tellRefusal();
  stayAwake();
  listenForDrops(document.body);
  addEventListener("pointerdown", wake, { capture: true });
  addEventListener("keydown", wake, { capture: true });
  addEventListener("keydown", keys);
  addEventListener("hashchange", () => openLink().catch(fail));
  // Leaving the page in the middle of a stroke leaves no sound behind.
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && silence());
  player
    .then(() => {
      warm().catch(fail);
      return Promise.all([openWork(), fill()]);
    })
    .then(async () => {
      if (!present.peek()) await openFirst();
      keepWork();
      showFirst();
      document.documentElement.dataset["ready"] = "yes";
      performance.mark("ready");
      await loadScreens();
    })
    .catch(fail);
  // `htex studio` serves at a name of `.localhost`, and refuses the worker: it is there without a network anyway.
  const isServed = location.protocol.startsWith("http") && !location.hostname.endsWith(".localhost");
  if ("serviceWorker" in navigator && isServed && import.meta.env.MODE === "static") {
    navigator.serviceWorker.register("./sw.js").catch(() => {});
  }
}

/** What scripts, such as the tests', may look at and call in the console: `htexStudio`. */
export const scripted = { audioContext, playingNode, heard, finger, present, texture, author, begin, undo, redo, depth, moveHandle, setMacro, handles, reference };
Object.assign(globalThis, { htexStudio: scripted });
