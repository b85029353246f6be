// A player of one texture, in one file: the library and the texture stand in the page, compressed and as base64.

import { HtexNode, follow, open, prepare, setLibrary } from "htex";

import "./player.css";

/** Motion of the arrow keys. */
const [KEY_MM_S, KEY_N] = [80, 0.4];

function bytesOf(id: string) {
  return Uint8Array.from(atob(document.getElementById(id)?.textContent ?? ""), (letter) => letter.charCodeAt(0));
}

async function inflated(bytes: Uint8Array<ArrayBuffer>) {
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("gzip"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}

function tell(text: string) {
  const told = document.getElementById("told");
  if (told) told.textContent = text;
}

async function start() {
  const pad = document.getElementById("pad");
  if (!pad) return;
  setLibrary(await inflated(bytesOf("library")));
  const texture = await open(bytesOf("texture"));
  const context = new AudioContext({ latencyHint: "interactive" });
  await prepare(context);
  const node = new HtexNode(context, texture);
  const limiter = new DynamicsCompressorNode(context, { threshold: -8, ratio: 20, attack: 0.002 });
  node.connect(limiter).connect(context.destination);
  node.onerror = ({ error }) => tell(error.message);
  follow(pad, node);
  pad.addEventListener("keydown", (event) => {
    if (!event.key.startsWith("Arrow")) return;
    event.preventDefault();
    void context.resume();
    node.speed.value = event.shiftKey ? 2 * KEY_MM_S : KEY_MM_S;
    node.force.value = KEY_N;
  });
  const rest = () => {
    node.speed.value = 0;
    node.force.value = 0;
  };
  pad.addEventListener("keyup", rest);
  pad.addEventListener("blur", rest);
  addEventListener("keydown", (event) => event.key === "Escape" && rest());
  document.documentElement.dataset["ready"] = "yes";
}

start().catch((error) => tell(String(error.message ?? error)));
