// The studio in Firefox, by WebDriver BiDi: the folder from a server, and the file. Firefox renders no sound without a sound device; a sound
// server of this test is one.

import assert from "node:assert/strict";
import { execFileSync, spawn } from "node:child_process";
import { existsSync } from "node:fs";
import { mkdtemp } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import test, { after, before } from "node:test";

import puppeteer from "puppeteer-core";

import { FILE, HTEX_FIREFOX, isWhole, SCREENS, serve } from "./studio.mjs";

const skip = existsSync(HTEX_FIREFOX) ? false : `no ${HTEX_FIREFOX}; to have it: apt-get install firefox-esr`;

let browser, server, sound;

/** Whether a program is installed. */
function has(program) {
  try {
    execFileSync(program, ["--version"], { stdio: "ignore" });
    return true;
  } catch {
    return false;
  }
}

const hasSound = has("pulseaudio");

/** A sound server that throws the samples away; in a folder of its own. */
async function startSound() {
  const folder = await mkdtemp(path.join(tmpdir(), "htex-sound-"));
  const env = { ...process.env, XDG_RUNTIME_DIR: folder, HOME: folder };
  const modules = ["-n", "-L", "module-native-protocol-unix", "-L", "module-null-sink"];
  const server = spawn("pulseaudio", [...modules, "--daemonize=no", "--exit-idle-time=-1", "--use-pid-file=no"], { env, stdio: "ignore" });
  for (let i = 0; i < 50 && !existsSync(path.join(folder, "pulse/native")); i++) await new Promise((resolve) => setTimeout(resolve, 100));
  return { server, env };
}

before(async () => {
  if (skip) return;
  server = await serve();
  if (hasSound) sound = await startSound();
  const env = sound?.env ?? process.env;
  browser = await puppeteer.launch({ browser: "firefox", executablePath: HTEX_FIREFOX, headless: true, env });
});

after(async () => {
  await browser?.close();
  await server?.close();
  sound?.server.kill();
});

async function opened(address) {
  const page = await browser.newPage();
  await page.setViewport({ width: 1400, height: 900 });
  page.errors = [];
  page.on("pageerror", (error) => page.errors.push(String(error)));
  await page.goto(address);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "yes", { timeout: 20_000 });
  return page;
}

/** Slides over the pad until it is heard; returns the loudest sample. */
async function slide(page) {
  const pad = await page.$eval(".pad canvas", (canvas) => ({ x: canvas.getBoundingClientRect().x, y: canvas.getBoundingClientRect().y }));
  await page.mouse.move(pad.x + 40, pad.y + 80);
  await page.mouse.down();
  let loudest = 0;
  for (let i = 0; i < 400 && loudest < 0.02; i++) {
    await page.mouse.move(pad.x + 40 + 3 * (i % 80), pad.y + 80);
    await new Promise((resolve) => setTimeout(resolve, 20));
    loudest = await page.evaluate(() => Math.max(...htexStudio.heard(new Float32Array(1024))));
  }
  await page.mouse.up();
  return loudest;
}

for (const [way, address] of [["the folder", () => server.address], ["the file", () => FILE]].slice(0, isWhole ? 2 : 1)) {
  test(`Firefox: ${way} plays, shapes and shows all screens`, { skip }, async (t) => {
    const page = await opened(address());
    const loudest = await slide(page);
    if (hasSound) assert.ok(loudest >= 0.02, `the loudest sample is ${loudest}`);
    else t.diagnostic("no sound was listened to; to have a sound server: apt-get install pulseaudio");
    for (const name of SCREENS) {
      await page.evaluate((wanted) => [...document.querySelectorAll(".tab")].find((tab) => tab.textContent === wanted).click(), name);
      await page.waitForFunction((wanted) => document.querySelector(".tab[aria-current]").textContent === wanted && document.querySelector("main h1"), {}, name);
    }
    await page.evaluate(() => [...document.querySelectorAll(".tab")].find((tab) => tab.textContent === "Shape").click());
    await page.waitForFunction(() => htexStudio.handles.value.length > 0, { timeout: 20_000 });
    const [first, edited, undone] = await page.evaluate(async () => {
      const bytes = () => htexStudio.present.value.bytes.join();
      const before = bytes();
      htexStudio.moveHandle(5, 0, htexStudio.handles.value[5].db + 10, "one");
      const after = bytes();
      await htexStudio.undo();
      return [before, after, bytes()];
    });
    assert.notEqual(edited, first);
    assert.equal(undone, first);
    assert.deepEqual(page.errors, []);
    await page.close();
  });
}
