// What the tests share: the page as a file and from a server, a browser, and the command.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { mkdtemp, readFile, rm } from "node:fs/promises";
import { createServer } from "node:http";
import { createRequire } from "node:module";
import { tmpdir } from "node:os";
import path from "node:path";
import test, { after, before } from "node:test";
import { pathToFileURL } from "node:url";
import { gzipSync } from "node:zlib";

import { chromium } from "playwright-core";

/** The folder that `cargo xtask studio` wrote, the command, and the browsers. */
export const { HTEX_STUDIO, HTEX_COMMAND, HTEX_CHROMIUM = "/usr/bin/chromium", HTEX_FIREFOX = "/usr/bin/firefox-esr" } = process.env;

export const FILE = pathToFileURL(path.join(HTEX_STUDIO, "studio.html")).href;

/** Screens, by the names of their tabs. */
export const SCREENS = ["Shelf", "Shape", "Mix", "Vary", "Compare", "Record", "Save"];

const TYPES = { ".html": "text/html", ".js": "text/javascript", ".css": "text/css", ".svg": "image/svg+xml", ".wasm": "application/wasm", ".txt": "text/plain" };

/** The strict policy that the folder is served with. */
const POLICY = "default-src 'none'; script-src 'self' 'wasm-unsafe-eval'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; worker-src 'self'";

/** Serves the static folder, compressed as most web servers do if that is asked for; `close` ends it. */
export async function serve({ isCompressed = false } = {}) {
  const asked = [];
  const server = createServer(async (request, response) => {
    const { pathname } = new URL(request.url, "http://x");
    asked.push(pathname);
    const file = path.join(HTEX_STUDIO, "static", path.normalize(pathname === "/" ? "/index.html" : pathname));
    try {
      const bytes = await readFile(file);
      response.setHeader("Content-Type", TYPES[path.extname(file)] ?? "application/octet-stream").setHeader("Content-Security-Policy", POLICY);
      if (isCompressed) response.setHeader("Content-Encoding", "gzip");
      response.end(isCompressed ? gzipSync(bytes) : bytes);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const close = () => new Promise((resolve) => (server.close(resolve), server.closeAllConnections()));
  return { address: `http://127.0.0.1:${server.address().port}/`, asked, close };
}

/** Chromium under its default policy: sound needs a press. */
export function launch(options = {}) {
  return chromium.launch({ executablePath: HTEX_CHROMIUM, args: ["--no-sandbox", "--disable-gpu", "--disable-background-networking"], ...options });
}

/** What `prepare` brings: Chromium, the page on a server, and a folder for files. */
export let browser, server, folder;

/** A file of the folder. */
export const file = (name) => path.join(folder, name);

/** Brings what the tests of a file need, and takes it away after them. `more` runs before the first test. */
export function prepare(more) {
  before(async () => {
    [browser, server, folder] = await Promise.all([launch(), serve(), mkdtemp(path.join(tmpdir(), "htex-studio-"))]);
    await more?.();
  });
  after(async () => {
    await browser?.close();
    await server?.close();
    if (folder) await rm(folder, { recursive: true });
  });
}

/** Closes a page that must not have complained of anything. */
export async function closed(page) {
  assert.deepEqual(page.errors, []);
  await page.context().close();
}

/** That axe finds nothing on the page, once it has changed its colours. */
export async function assertAccessible(page, what) {
  await page.evaluate(await readFile(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8"));
  await page.waitForTimeout(400);
  const { violations } = await page.evaluate(() => axe.run(document, { resultTypes: ["violations"] }));
  assert.deepEqual(violations.map(({ id, nodes }) => `${id}: ${nodes.map((node) => node.html.slice(0, 120)).join(" | ")}`), [], what);
}

/** Opens the page, in which `init` runs first, and waits until it is ready; `page.errors` has what it complained of, `page.requests` what it asked for. */
export async function openStudio(browser, address, { init, ...options } = {}) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, acceptDownloads: true, ...options });
  if (init) await context.addInitScript(init);
  const page = await context.newPage();
  Object.assign(page, { errors: [], requests: [] });
  page.on("pageerror", (error) => page.errors.push(String(error)));
  page.on("console", (message) => message.type() === "error" && page.errors.push(message.text()));
  page.on("request", (request) => /^https?:/.test(request.url()) && page.requests.push(request.url()));
  await page.goto(address);
  await ready(page);
  return page;
}

export async function ready(page) {
  await page.waitForFunction(() => document.documentElement.dataset.ready === "yes");
}

/** Waits until `predicate` promises something true in the page; `waitForFunction` takes the promise itself for true. */
export async function until(page, predicate, argument) {
  while (!(await page.evaluate(predicate, argument))) await page.waitForTimeout(20);
}

/** Opens a screen, and waits until it is there. */
export async function goTo(page, name) {
  await page.getByRole("navigation").getByRole("button", { name }).click();
  await page.locator(".tab[aria-current]", { hasText: name }).waitFor();
  await page.locator("main h1").waitFor();
}

/** Waits until the page was drawn some times: what an event changes is drawn after a few frames. */
export async function frames(page, count = 6) {
  await page.evaluate(async (wanted) => {
    for (let i = 0; i < wanted; i++) await new Promise(requestAnimationFrame);
  }, count);
}

/** Waits until the audio thread has played for some seconds, while the finger slides. */
export async function sounded(page, seconds) {
  const end = seconds + (await page.evaluate(() => htexStudio.audioContext().currentTime));
  await page.waitForFunction((time) => htexStudio.audioContext().currentTime >= time, end);
}

/** Waits until the author module is there and handles can be moved. */
export async function shaping(page) {
  await goTo(page, "Shape");
  await page.waitForFunction(() => htexStudio.handles.value.length > 0);
}

/** Whether the tests take everything instead of a sample, as in `cargo xtask prove studio`. */
export const isWhole = Boolean(process.env.HTEX_WHOLE);

/** A test that takes long. Only the whole proof runs it. */
export const thorough = (name, run) => test(name, { skip: !isWhole && "only `cargo xtask prove studio` runs it" }, run);

/** The bytes of the present texture. */
export async function bytesOf(page) {
  // As a text, which takes a page milliseconds for megabytes. An array of numbers takes minutes.
  const text = () => new Promise((resolve, reject) => {
    const reader = Object.assign(new FileReader(), { onload: () => resolve(reader.result.split(",")[1] ?? ""), onerror: reject });
    reader.readAsDataURL(new Blob([htexStudio.present.value.bytes]));
  });
  return Buffer.from(await page.evaluate(text), "base64");
}

/** The bytes of a file that a press saves. */
export async function saved(page, press) {
  const [download] = await Promise.all([page.waitForEvent("download"), press()]);
  return { name: download.suggestedFilename(), bytes: await readFile(await download.path()) };
}

export function htex(...words) {
  return execFileSync(HTEX_COMMAND, words, { encoding: "utf8", stdio: ["ignore", "pipe", "pipe"] });
}

/** The samples of a WAV file of 32-bit numbers. */
export function samplesOf(wav) {
  const at = wav.indexOf("data", 12, "latin1") + 8;
  // Chunks with the licence and the author may follow.
  return new Float32Array(wav.buffer.slice(wav.byteOffset + at, wav.byteOffset + at + wav.readUInt32LE(at - 4)));
}

/** Drops files or folders of the disk on the page, as a hand does. */
export async function dropPaths(page, paths, { x = 400, y = 300 } = {}) {
  const session = await page.context().newCDPSession(page);
  const data = { items: [], files: paths, dragOperationsMask: 1 };
  for (const type of ["dragEnter", "dragOver", "drop"]) await session.send("Input.dispatchDragEvent", { type, x, y, data });
  await session.detach();
}

/** Moves a finger over the page. */
export async function swipe(page, from, to, steps = 12) {
  const session = await page.context().newCDPSession(page);
  const touch = (type, points) => session.send("Input.dispatchTouchEvent", { type, touchPoints: points });
  await touch("touchStart", [{ x: from[0], y: from[1] }]);
  for (let i = 1; i <= steps; i++) {
    const at = (axis) => from[axis] + ((to[axis] - from[axis]) * i) / steps;
    await touch("touchMove", [{ x: at(0), y: at(1) }]);
    await page.waitForTimeout(16);
  }
  // A finger that rests before it leaves does not throw the page.
  await page.waitForTimeout(150);
  await touch("touchMove", [{ x: to[0], y: to[1] }]);
  await touch("touchEnd", []);
  await frames(page);
}
