// Starts a browser with the same policies as users have, and a web server for its pages.

import { cp, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import path from "node:path";

import { chromium } from "playwright-core";

import { HTEX_FIXTURES, HTEX_PACKAGE } from "./fixtures.mjs";

const { HTEX_CHROMIUM = "/usr/bin/chromium", HTEX_EXAMPLE } = process.env;
const TYPES = { ".js": "text/javascript", ".html": "text/html", ".wasm": "application/wasm", ".css": "text/css" };
/**
 * A host name of this machine. Browsers treat its pages as not secure, like pages from another
 * machine in the network.
 */
const ELSEWHERE = "elsewhere.example";

const SURFACE = '<div id=surface tabindex=0 style="width:600px;height:300px"></div>';

/**
 * Records what an audio node plays: call `record(node)`, then `await recorded()`. The recording
 * begins with the first quantum that has input, because a busy browser connects the recorder some
 * quanta after it made it. A later quantum without input, for example after a node was
 * disconnected, is silent. A quantum that was not rendered is an error, because it would look like a
 * click. `hold(context, ms)` blocks the audio thread for a while, as on a busy machine.
 */
const RECORDER = `
const source = \`registerProcessor("record", class extends AudioWorkletProcessor {
  constructor() { super(); this.blocks = []; this.port.onmessage = () => this.port.postMessage(this.blocks.splice(0)); }
  process([[input]]) { this.isConnected ||= !!input; if (this.isConnected) this.blocks.push({ frame: currentFrame, samples: input ? input.slice() : new Float32Array(128) }); return true; } });
registerProcessor("hold", class extends AudioWorkletProcessor {
  constructor() { super(); this.port.onmessage = ({ data }) => { this.port.postMessage(0); for (const end = Date.now() + data; Date.now() < end; ); }; }
  process() { return true; } });\`;
const modules = new WeakMap();
const added = (context) => {
  if (!modules.has(context)) modules.set(context, context.audioWorklet.addModule("data:text/javascript," + encodeURIComponent(source)));
  return modules.get(context);
};
window.record = async (node) => {
  await added(node.context);
  const recorder = new AudioWorkletNode(node.context, "record", { numberOfOutputs: 0, channelCount: 1, channelCountMode: "explicit" });
  node.connect(recorder);
  window.recorded = () => new Promise((done, fail) => {
    recorder.port.onmessage = ({ data }) => {
      // Chromium tells the frame of the quantum before of some, which have their samples.
      const places = data.map(({ frame }, i) => frame - 128 * i);
      const skipped = places.findIndex((place) => place > Math.max(...places.slice(0, 2)));
      if (skipped > 0) fail(new Error("quanta were skipped before frame " + data[skipped].frame));
      else done(data.flatMap(({ samples }) => Array.from(samples)));
    };
    recorder.port.postMessage(0);
  });
};
window.hold = async (context, ms) => {
  await added(context);
  const { port } = new AudioWorkletNode(context, "hold");
  const held = new Promise((done) => (port.onmessage = done));
  port.postMessage(ms);
  await held;
};`;

/**
 * Starts the browser and the server. `close` ends both, and removes the copies that the server has
 * served.
 */
export async function start() {
  const folder = await mkdtemp(path.join(tmpdir(), "htex-browser-"));
  await cp(HTEX_PACKAGE, path.join(folder, "htex"), { recursive: true });
  await cp(HTEX_FIXTURES, path.join(folder, "fixtures"), { recursive: true });
  await cp(HTEX_EXAMPLE, path.join(folder, "example"), { recursive: true });
  await cp(HTEX_PACKAGE, path.join(folder, "example/htex"), { recursive: true });
  await cp(path.join(HTEX_FIXTURES, "vinyl.htex"), path.join(folder, "cloth.htex"));
  await writeFile(path.join(folder, "recorder.js"), RECORDER);
  await writeFile(path.join(folder, "empty.html"), `<!doctype html><title>empty</title><script src=/recorder.js></script>${SURFACE}`);
  const here = { folder, answer: null };
  const server = createServer((request, response) => serve(here, request, response));
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const { port } = server.address();
  const args = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", `--host-resolver-rules=MAP ${ELSEWHERE} 127.0.0.1`];
  const browser = await chromium.launch({ executablePath: HTEX_CHROMIUM, args });
  return Object.assign(here, {
    browser,
    address: `http://127.0.0.1:${port}`,
    elsewhere: `http://${ELSEWHERE}:${port}`,
    page: (at = "empty.html", options = {}) => page(here, at, options),
    close: async () => {
      await browser.close();
      server.closeAllConnections();
      server.close();
      await rm(folder, { recursive: true, force: true });
    },
  });
}

/** Answers a request with a file, unless `here.answer` answers it. */
async function serve(here, request, response) {
  const { pathname } = new URL(request.url, "http://x");
  if (pathname === "/favicon.ico") return void response.writeHead(204).end();
  if (await here.answer?.(pathname, response)) return;
  const file = path.join(here.folder, path.normalize(pathname));
  try {
    response.setHeader("content-type", TYPES[path.extname(file)] ?? "application/octet-stream").end(await readFile(file));
  } catch {
    response.writeHead(404).end();
  }
}

/**
 * Opens a page. `errors` has the errors that it reports. `run` evaluates an expression. Unlike
 * Playwright's `evaluate`, this does not count as a user gesture.
 */
async function page(here, at, { origin = here.address, ...options }) {
  const made = await here.browser.newPage({ viewport: { width: 1000, height: 700 }, ...options });
  made.errors = [];
  made.on("pageerror", (error) => made.errors.push(String(error)));
  made.on("console", (message) => message.type() === "error" && made.errors.push(message.text()));
  made.input = await made.context().newCDPSession(made);
  made.run = async (expression) => {
    const asked = { expression: `(async () => ${expression})()`, awaitPromise: true, returnByValue: true, userGesture: false };
    const { result, exceptionDetails } = await made.input.send("Runtime.evaluate", asked);
    if (exceptionDetails) throw new Error(exceptionDetails.exception?.description ?? exceptionDetails.text);
    return result.value;
  };
  made.until = async (expression) => {
    for (let tries = 0; tries < 200; tries++) {
      if (await made.run(expression)) return;
      await pause(50);
    }
    throw new Error(`${expression} has not come true; errors: ${made.errors.join("; ")}`);
  };
  await made.goto(`${origin}/${at}`);
  return made;
}

/**
 * Writes a page with the second example of the README. The page stores the constants of the example
 * in `window`.
 */
export async function writeExample(folder, file = "readme.html") {
  const page = `<!doctype html><script type=importmap>{"imports":{"htex":"/htex/index.js"}}</script><script src=/recorder.js></script>${SURFACE}`;
  await writeFile(path.join(folder, file), `${page}<script type=module>${await example()}</script>`);
}

export async function example() {
  const readme = await readFile(path.join(HTEX_PACKAGE, "README.md"), "utf8");
  const [, code] = [...readme.matchAll(/```js\n([\s\S]*?)```/g)].map(([, text]) => text);
  return `${code}\nwindow.node = node; window.context = context; await window.record?.(node);`;
}

export const pause = (ms) => new Promise((done) => setTimeout(done, ms));

/** Drags the mouse or a finger along a line, through the browser's input protocol. */
export async function drag(made, { touch = false, from = 50, to = 450, y = 100, lift = true } = {}) {
  const send = (kind, x) =>
    touch
      ? made.input.send("Input.dispatchTouchEvent", { type: `touch${kind}`, touchPoints: kind === "End" ? [] : [{ x, y, id: 1 }] })
      : made.input.send("Input.dispatchMouseEvent", { type: MOUSE[kind], x, y, button: "left", buttons: kind === "End" ? 0 : 1, clickCount: 1 });
  await send("Start", from);
  for (let x = from; x <= to; x += 10) {
    await send("Move", x);
    await pause(10);
  }
  if (lift) await send("End", to);
}

const MOUSE = { Start: "mousePressed", Move: "mouseMoved", End: "mouseReleased" };

/** Returns the RMS of numbers. */
export const rms = (numbers) => Math.sqrt(numbers.reduce((sum, x) => sum + x * x, 0) / Math.max(numbers.length, 1));

/**
 * Returns the largest RMS over a tenth of a second at 48 kHz. An input lasts longer than this, and
 * on a busy machine the sound comes late.
 */
export function loudest(numbers, frames = 4800) {
  const starts = Array.from({ length: Math.max(Math.ceil(numbers.length / frames), 1) }, (_, i) => i * frames);
  return Math.max(...starts.map((start) => rms(numbers.slice(start, start + frames))));
}

/** Returns the largest step between neighbouring samples from `start` to `end`. */
export function largestStep(numbers, start = 0, end = numbers.length) {
  let largest = 0;
  for (let i = Math.max(start, 1); i < end; i++) largest = Math.max(largest, Math.abs(numbers[i] - numbers[i - 1]));
  return largest;
}
