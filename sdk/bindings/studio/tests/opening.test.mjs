// Files, folders, recordings and libraries that are opened, in Chromium and, as far as it can be driven, in Firefox: real files, dropped and
// chosen.

import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { mkdir, readFile, writeFile } from "node:fs/promises";
import { cpus, loadavg } from "node:os";
import test from "node:test";

import puppeteer from "puppeteer-core";

import { assertAccessible, browser, bytesOf, closed, dropPaths, FILE, file, folder, goTo, htex, HTEX_FIREFOX, isWhole, openStudio, prepare, ready, saved, server, shaping, thorough } from "./studio.mjs";

prepare(async () => {
  const make = (name, ...more) => htex("make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02", "--at", "speed=80,force=0.5", "--license", "CC0-1.0", "--name", name, ...more, "-o", file(`${name.toLowerCase()}.htex`));
  for (const name of ["Blanket", "Hum", "Purr"]) make(name);
  htex("simulate", "--surface", "fine-fabric", "--seconds", "3", "--speed", "80", "--force", "0.4", "-o", file("cloth.csv"));
  htex("export", file("hum.htex"), "--to", "ahap", "-o", file("taps.ahap"));
  await writeFile(file("torn.htex"), (await readFile(file("blanket.htex"))).subarray(0, 400));
  await mkdir(file("things/below"), { recursive: true });
  for (const [from, to] of [["blanket.htex", "things/blanket.htex"], ["hum.htex", "things/below/hum.htex"], ["torn.htex", "things/below/torn.htex"]]) await writeFile(file(to), await readFile(file(from)));
});

const onPad = (page, name) => page.waitForFunction((wanted) => htexStudio.texture.value?.name === wanted, name);
const card = (page, name) => page.getByRole("main").getByRole("button", { name: new RegExp(`^${name}`) });
const notice = (page, text) => page.locator(".notice", { hasText: text }).waitFor();

const WAYS = [["the file", () => FILE], ["the folder", () => server.address]];

for (const [way, address] of WAYS.slice(0, isWhole ? 2 : 1)) {
  test(`${way}: a dropped texture is on the pad`, async () => {
    const page = await openStudio(browser, address());
    await dropPaths(page, [file("blanket.htex")]);
    await onPad(page, "Blanket");
    await notice(page, "Blanket is on the shelf and on the pad.");
    assert.ok((await bytesOf(page)).equals(await readFile(file("blanket.htex"))));
    await closed(page);
  });

  test(`${way}: textures, a recording and a file of another format are dropped at once`, async () => {
    const page = await openStudio(browser, address());
    await dropPaths(page, ["blanket.htex", "cloth.csv", "hum.htex", "taps.ahap"].map(file));
    await page.getByRole("img", { name: /Signal of 3.0 s/ }).waitFor();
    await page.getByRole("form", { name: "Import taps.ahap" }).waitFor();
    await onPad(page, "Blanket");
    await notice(page, "2 textures are on the shelf.");
    await goTo(page, "Shelf");
    for (const name of ["Blanket", "Hum"]) await card(page, name).waitFor();
    await closed(page);
  });

  test(`${way}: the textures of a folder that is dropped are on the shelf, and a broken one is told`, async () => {
    const page = await openStudio(browser, address());
    await dropPaths(page, [file("things"), file("purr.htex")]);
    await notice(page, /3 textures are on the shelf\. torn\.htex cannot be opened\./);
    for (const name of ["Blanket", "Hum", "Purr"]) await card(page, name).waitFor();
    await closed(page);
  });

  test(`${way}: a broken file does not stop the files after it`, async () => {
    const page = await openStudio(browser, address());
    await writeFile(file("torn.htexlib"), Buffer.from("no library"));
    await writeFile(file("torn.ahap"), '{"Version": 1.0, ');
    await dropPaths(page, ["torn.htex", "torn.htexlib", "blanket.htex", "torn.ahap", "taps.ahap", "hum.htex"].map(file));
    await notice(page, /2 textures are on the shelf\. 3 files could not be opened: torn\.htexlib.*torn\.htex.*torn\.ahap/);
    await page.getByRole("form", { name: "Import taps.ahap" }).waitFor();
    await goTo(page, "Shelf");
    for (const name of ["Blanket", "Hum"]) await card(page, name).waitFor();
    await closed(page);
  });
}

test("files that are chosen open as dropped ones do", async () => {
  const page = await openStudio(browser, FILE);
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Open files" }).click()]);
  await chooser.setFiles(["torn.htex", "blanket.htex", "hum.htex"].map(file));
  await notice(page, /2 textures are on the shelf\. torn\.htex cannot be opened\./);
  await onPad(page, "Blanket");
  await closed(page);
});

thorough("twenty files of other formats make one form, which imports them all", async () => {
  const page = await openStudio(browser, FILE);
  const names = await Promise.all(Array.from({ length: 20 }, async (_, i) => {
    const name = `taps ${String(i + 1).padStart(2, "0")}.ahap`;
    await writeFile(file(name), await readFile(file("taps.ahap")));
    return name;
  }));
  htex("export", file("hum.htex"), "--to", "png", "-o", file("row.png"));
  await dropPaths(page, [...names, "row.png"].map(file));
  const form = page.getByRole("form");
  await form.getByRole("heading", { name: "21 files" }).waitFor();
  assert.equal(await form.count(), 1);
  for (const name of names) await form.getByLabel(name).waitFor();
  // One that needs other numbers is left for later.
  await form.getByLabel("taps 20.ahap").uncheck();
  await form.getByLabel("How strong 1 or white is").fill("0.2");
  await form.getByLabel("Speed, mm/s").fill("80");
  await form.getByLabel("Force, N").fill("0.4");
  await form.getByRole("button", { name: "Import 20 files" }).click();
  await notice(page, "20 textures are on the shelf. taps 01 is on the pad.");
  await onPad(page, "taps 01");
  assert.equal(await page.evaluate(() => htexStudio.depth.value), 1);
  assert.equal(await form.count(), 1);
  await page.getByRole("form", { name: "Import taps 20.ahap" }).getByLabel("How strong 1 is").fill("1");
  await form.getByRole("button", { name: "Import" }).click();
  await onPad(page, "taps 20");
  await form.waitFor({ state: "detached" });
  await goTo(page, "Shelf");
  assert.equal(await card(page, "taps").count(), 20);
  await closed(page);
});

/** Notes how long the page takes to answer to typing: to the frame after it. */
function listen() {
  window.answers = [];
  addEventListener("input", ({ timeStamp }) => requestAnimationFrame(() => setTimeout(() => window.answers.push(performance.now() - timeStamp))), { capture: true });
}

/**
 * What the page's main thread does while `run` runs: the seconds, those of the processor, and the longest tasks, ms. Tasks are measured in
 * time of the processor, which other programs do not lengthen.
 */
async function busy(page, run) {
  const session = await page.context().newCDPSession(page);
  const events = [];
  session.on("Tracing.dataCollected", ({ value }) => events.push(...value));
  await session.send("Tracing.start", { transferMode: "ReportEvents", traceConfig: { includedCategories: ["toplevel"] } });
  const begin = performance.now();
  await run();
  const seconds = (performance.now() - begin) / 1e3;
  const ended = new Promise((resolve) => session.once("Tracing.tracingComplete", resolve));
  await session.send("Tracing.end");
  await ended;
  await session.detach();
  const mains = events.filter(({ name, args }) => name === "thread_name" && args.name === "CrRendererMain");
  const tasksOf = ({ pid, tid }) => events.filter((one) => one.name.endsWith("RunTask") && one.pid === pid && one.tid === tid && one.tdur).map(({ tdur }) => tdur / 1e3);
  const sum = (tasks) => tasks.reduce((all, ms) => all + ms, 0);
  const tasks = mains.map(tasksOf).sort((a, b) => sum(b) - sum(a))[0];
  return { seconds, processor: sum(tasks) / 1e3, longest: Math.max(...tasks) };
}

/** Whether no other programs keep the machine busy: only then are seconds the page's. */
const isQuiet = () => loadavg()[0] < cpus().length;

const COUNT = 2000;

/** A library of textures with names and tags of their own, made of one that has six models. */
async function makeLibrary() {
  const library = file("big.htexlib");
  if (existsSync(library)) return library;
  htex("fit", file("cloth.csv"), "--license", "CC0-1.0", "-o", file("cloth.htex"));
  const page = await openStudio(browser, FILE);
  page.setDefaultTimeout(120_000);
  await shaping(page);
  const bytes = Array.from(await readFile(file("cloth.htex")));
  const { bytes: made } = await saved(page, () =>
    page.evaluate(([texture, count]) => {
      const author = htexStudio.author.value;
      const textures = {};
      for (let i = 0; i < count; i++) {
        const number = String(i).padStart(4, "0");
        const made = author.edit(new Uint8Array(texture), { name: `Cloth ${number}`, tags: ["cloth", `roll ${i % 40}`, i % 2 ? "odd" : "even"] });
        textures[`cloth/${number}`] = made.toBytes();
        made.free();
      }
      const href = URL.createObjectURL(new Blob([author.library(textures)]));
      Object.assign(document.createElement("a"), { href, download: "big.htexlib" }).click();
    }, [bytes, COUNT]),
  );
  await page.context().close();
  await writeFile(library, made);
  return library;
}

const count = (page) => page.locator(".card").count();

thorough("a library of 2,000 textures opens in 5 s, with progress, and the page stays free", async (t) => {
  const library = await makeLibrary();
  const page = await openStudio(browser, server.address, { init: listen });
  await page.waitForTimeout(500);
  // Next to other programs, everything takes longer.
  const slack = isQuiet() ? 1 : 5;
  const bar = page.getByRole("progressbar", { name: "Files that are opened" });
  const opened = await busy(page, async () => {
    await dropPaths(page, [library]);
    await bar.waitFor();
    assert.equal(await bar.evaluate(({ max }) => max), COUNT);
    await notice(page, "2,000 textures of big.htexlib are on the shelf.");
  });
  assert.equal(await bar.count(), 0);
  t.diagnostic(`opened in ${opened.seconds.toFixed(2)} s, ${opened.processor.toFixed(2)} s of the processor; the longest task ${opened.longest.toFixed(0)} ms`);
  assert.ok(opened.seconds < 5 * slack, `${opened.seconds} s`);
  assert.ok(opened.longest < 50 * slack, `${opened.longest} ms`);
  // The last one is found while it is typed.
  const typed = await busy(page, async () => {
    await page.getByLabel("Search textures").pressSequentially("roll 39 1999", { delay: 60 });
    await page.waitForFunction(() => document.querySelectorAll(".card").length === 1 && window.answers.length === 12);
  });
  const slowest = Math.max(...(await page.evaluate(() => window.answers)));
  t.diagnostic(`keys are answered in up to ${slowest.toFixed(0)} ms; the longest task ${typed.longest.toFixed(0)} ms`);
  assert.ok(typed.longest < 50 * slack && slowest < 100 * slack, `${typed.longest} ms, ${slowest} ms`);
  await card(page, "Cloth 1999").click();
  await onPad(page, "Cloth 1999");
  // All of them can be scrolled to, and each is drawn.
  await page.getByLabel("Search textures").fill("");
  await page.waitForFunction(() => document.querySelectorAll(".card").length >= 36);
  assert.ok((await count(page)) < 200);
  await page.mouse.move(500, 500);
  const scrolled = await busy(page, async () => {
    for (let i = 0; i < 400 && (await count(page)) < 500; i++) {
      await page.mouse.wheel(0, 1500);
      await page.waitForTimeout(20);
    }
    await page.waitForFunction(() => [...document.querySelectorAll(".card")].slice(0, 300).every((card) => card.querySelector("path")));
  });
  assert.ok((await count(page)) >= 500, `${await count(page)} cards`);
  t.diagnostic(`scrolled: the longest task ${scrolled.longest.toFixed(0)} ms`);
  assert.ok(scrolled.longest < 50 * slack, `${scrolled.longest} ms`);
  // They are there again, in their order.
  const again = await busy(page, async () => {
    await page.reload();
    await ready(page);
    await goTo(page, "Shelf");
    await card(page, "Cloth 0000").waitFor();
  });
  t.diagnostic(`opened again with them: ${again.processor.toFixed(2)} s of the processor; the longest task ${again.longest.toFixed(0)} ms`);
  assert.match(await page.locator(".card").first().textContent(), /^Cloth 0000/);
  await page.getByLabel("Search textures").fill("cloth 1999");
  await card(page, "Cloth 1999").waitFor();
  await closed(page);
});

thorough("the opening of a library is stopped, and what was opened stays", async () => {
  const library = await makeLibrary();
  const page = await openStudio(browser, FILE);
  await dropPaths(page, [library]);
  await page.getByRole("button", { name: "Stop" }).click();
  await notice(page, /Stopped: [\d,]+ of 2,000 textures are on the shelf\./);
  const [, number] = /Stopped: ([\d,]+) of/.exec(await page.locator(".notice").textContent());
  const kept = Number(number.replace(",", ""));
  assert.ok(kept > 0 && kept < COUNT, number);
  // What is shown is kept: this texture is the last.
  const last = `Cloth ${String(kept - 1).padStart(4, "0")}`;
  await page.reload();
  await ready(page);
  await page.getByLabel("Search textures").fill("cloth");
  await card(page, "Cloth 0000").waitFor();
  await page.getByLabel("Search textures").fill(last);
  await card(page, last).waitFor();
  await closed(page);
});

/** Opens recordings by the button of their screen. */
async function record(page, ...names) {
  await goTo(page, "Record");
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Choose files" }).click()]);
  await chooser.setFiles(names.map(file));
}

const picture = (page) => page.getByRole("img", { name: /^Signal of/ });

test("another recording clears the last fit and what was said of the one before", async () => {
  const page = await openStudio(browser, FILE);
  htex("simulate", "--surface", "vinyl", "--seconds", "3", "-o", file("vinyl.csv"));
  await record(page, "cloth.csv");
  await picture(page).waitFor();
  await page.getByLabel("Speed, mm/s").fill("82");
  await page.getByText("at 82.0 mm/s").waitFor();
  await page.getByRole("button", { name: "Fit all models" }).click();
  await page.locator(".ranked li").first().waitFor();
  // The fit is of the old number, and says so.
  await page.getByLabel("Speed, mm/s").fill("83");
  await page.getByText("They were fitted before the settings were changed.").waitFor();
  await page.getByRole("button", { name: "To the pad" }).first().click();
  await page.getByText("recording", { exact: true }).waitFor();
  await record(page, "vinyl.csv");
  await page.getByRole("heading", { name: "vinyl.csv" }).waitFor();
  await picture(page).waitFor();
  assert.equal(await page.locator(".ranked li").count(), 0);
  assert.equal(await page.getByLabel("Speed, mm/s").inputValue(), "");
  // The texture on the pad is still the one of its recording.
  await goTo(page, "Compare");
  await page.getByRole("heading", { name: "The recording against each model" }).waitFor();
  await page.getByRole("button", { name: "Compare by ear" }).first().click();
  await page.getByText(/It plays as it was recorded, /).waitFor();
  await closed(page);
});

/** The sheet of a recording in other columns. */
async function rewritten(name, head, row) {
  const lines = (await readFile(file("cloth.csv"), "utf8")).split("\n").filter((line) => line && !line.startsWith("#")).slice(1);
  await writeFile(file(name), [head, ...lines.map((line) => row(line.split(",").map(Number)))].join("\n") + "\n");
}

test("a column in volts gets its unit and its factor on the page", async () => {
  const page = await openStudio(browser, FILE);
  await rewritten("volts.csv", "t_s,lateral_V,normal_V", ([t, fx, , fz]) => `${t},${(fx / 0.4444).toFixed(7)},${(fz / 0.31).toFixed(7)}`);
  await record(page, "volts.csv");
  await page.getByText(/"lateral_V" is in volts, not N; map it with its scale to N/).waitFor();
  // The advice leads to its field.
  await page.getByRole("button", { name: "Columns", exact: true }).click();
  await page.getByLabel("Column map, as a text").waitFor();
  assert.equal(await page.evaluate(() => document.activeElement.dataset.setting), "map");
  await page.getByLabel("Role of lateral_V").selectOption("lateral");
  await page.getByLabel("Factor of lateral_V to N").fill("0.4444");
  await page.keyboard.press("Tab");
  await picture(page).waitFor();
  await page.getByLabel("Role of normal_V").selectOption("normal");
  await page.getByLabel("Factor of normal_V to N").fill("0.31");
  await page.keyboard.press("Tab");
  await page.getByText(/and 0\.4\d N/).waitFor();
  assert.equal(await page.getByLabel("Column map, as a text").inputValue(), 'lateral="lateral_V":0.4444,normal="normal_V":0.31');
  await page.getByRole("button", { name: "Fit all models" }).click();
  await page.getByRole("button", { name: "To the pad" }).first().click();
  await onPad(page, "volts");
  const level = await page.evaluate(() => htexStudio.texture.value.level());
  htex("fit", file("volts.csv"), "--map", "lateral=lateral_V:0.4444,normal=normal_V:0.31", "-o", file("volts.htex"));
  const [same] = JSON.parse(htex("info", file("volts.htex"), "--json")).representations ?? [];
  assert.ok(level > 0.001 && level < 1 && same !== null, String(level));
  await closed(page);
});

test("a coefficient of friction without a sample rate is read: the page has a field for each advice", async () => {
  const page = await openStudio(browser, FILE);
  await rewritten("friction.csv", "speed,force,accel,friction", ([, fx, , fz]) => `80,${fz},0,${(fx / fz).toFixed(6)}`);
  await record(page, "friction.csv");
  await page.getByText("it has no sample rate; give one").waitFor();
  await page.getByRole("button", { name: "Rate", exact: true }).click();
  await page.keyboard.type("20000");
  await picture(page).waitFor();
  const map = page.getByLabel("Column map, as a text");
  // The columns unfold by themselves if the problem was shown before the rate was typed.
  if (!(await map.isVisible())) await page.getByText("Columns", { exact: true }).last().click();
  await map.fill("lateral=friction*force,normal=force");
  await map.press("Tab");
  await page.getByText(/and 0\.\d\d N/).waitFor();
  assert.equal(await page.getByLabel("Role of force").inputValue(), "normal");
  // Another quantity: the column of the acceleration.
  await page.getByLabel("What was recorded").selectOption("acceleration");
  await page.getByLabel("Role of accel").selectOption("signal");
  await page.getByLabel("Unit of accel").selectOption("g");
  assert.equal(await page.getByLabel("Factor of accel to m/s²").inputValue(), "9.80665");
  await closed(page);
});

/** Writes a recording's lateral force as a WAV file of 16 bits, whose full scale is a number that nobody noted. */
async function toWav(name, volume = 20) {
  const lines = (await readFile(file("cloth.csv"), "utf8")).split("\n").filter((line) => line && !line.startsWith("#")).slice(1);
  const samples = Int16Array.from(lines, (line) => Math.max(-32767, Math.min(32767, Math.round(32768 * (Number(line.split(",")[1]) / volume)))));
  const head = Buffer.alloc(44);
  head.write("RIFF", 0), head.writeUInt32LE(36 + samples.byteLength, 4), head.write("WAVEfmt ", 8), head.writeUInt32LE(16, 16);
  head.writeUInt16LE(1, 20), head.writeUInt16LE(1, 22), head.writeUInt32LE(20_000, 24), head.writeUInt32LE(40_000, 28), head.writeUInt16LE(2, 32), head.writeUInt16LE(16, 34);
  head.write("data", 36), head.writeUInt32LE(samples.byteLength, 40);
  await writeFile(file(name), Buffer.concat([head, Buffer.from(samples.buffer)]));
}

test("nobody knows how loud full scale is: models are ranked by shape, and nothing is said of what is felt", async () => {
  const page = await openStudio(browser, FILE);
  await toWav("cloth.wav", 5);
  await record(page, "cloth.wav");
  await picture(page).waitFor();
  assert.ok(await page.getByLabel("I do not know").isChecked());
  await page.getByRole("button", { name: "Fit all models" }).click();
  await page.getByRole("heading", { name: "Models, by their shape" }).waitFor();
  const told = await page.locator(".ranked li p").allTextContents();
  const errors = told.map((text) => Number(/^Its shape is ([\d.]+) dB from the recording's\.$/.exec(text)?.[1]));
  assert.equal(errors.length, 6);
  assert.deepEqual(errors, [...errors].sort((a, b) => a - b));
  assert.ok(errors.every((db) => db > 0), String(told));
  assert.equal(await page.getByRole("main").getByText(/felt|feels/).count(), 1, "only the question says what is not said");
  await page.getByRole("button", { name: "To the pad" }).first().click();
  await onPad(page, "cloth");
  await page.getByText("recording", { exact: true }).waitFor();
  assert.equal(await page.locator(".legend-threshold").count(), 0);
  await goTo(page, "Compare");
  await page.getByText("It is not known how strong cloth was").waitFor();
  assert.equal(await page.getByText(/A difference is felt|A finger feels/).count(), 0);
  // The file says so, too.
  await goTo(page, "Save");
  const { bytes } = await saved(page, () => page.getByRole("button", { name: "Save .htex" }).click());
  await writeFile(file("unknown.htex"), bytes);
  assert.match(htex("info", file("unknown.htex"), "--json"), /level-unknown/);
  // Whoever knows it is told what is felt.
  await goTo(page, "Record");
  await page.getByLabel("I know:").check();
  await page.getByLabel("Full scale is, N").fill("5");
  await page.getByRole("button", { name: "Fit all models" }).click();
  await page.getByRole("heading", { name: "Models, by what is felt" }).waitFor();
  await page.getByText(/A difference is felt|A finger feels|Even a sensitive finger/).first().waitFor();
  await closed(page);
});

for (const viewport of [{ width: 1400, height: 900 }, { width: 390, height: 844 }].slice(isWhole ? 0 : 1)) {
  test(`recordings with their columns have no finding of axe and fit ${viewport.width} px`, async () => {
    const page = await openStudio(browser, FILE, { viewport, hasTouch: viewport.width < 500, reducedMotion: "reduce" });
    await toWav("axe.wav", 5);
    await record(page, "cloth.csv", "axe.wav");
    await picture(page).nth(1).waitFor();
    await page.getByLabel("I know:").check();
    for (const columns of await page.getByText("Columns", { exact: true }).all()) await columns.click();
    await page.getByLabel("Role of fx_n").waitFor();
    await assertAccessible(page);
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= viewport.width);
    const heights = await page.locator("main :is(button, select, summary, input:not([type=file]):not([type=radio]))").evaluateAll((all) => all.filter((one) => one.checkVisibility()).map((one) => [one.outerHTML.slice(0, 80), one.getBoundingClientRect().height]));
    assert.deepEqual(heights.filter(([, height]) => viewport.width < 500 && height < 43.5), []);
    await closed(page);
  });
}

thorough("long recordings are read beside the page: numbers that change do not stop it", async (t) => {
  const page = await openStudio(browser, FILE);
  htex("simulate", "--surface", "fine-fabric", "--seconds", "20", "-o", file("long 1.csv"));
  const names = [1, 2, 3, 4].map((i) => `long ${i}.csv`);
  for (const name of names.slice(1)) await writeFile(file(name), await readFile(file(names[0])));
  await record(page, ...names);
  await page.getByRole("progressbar", { name: "Progress of the reading" }).waitFor();
  await page.getByText(/Reading long \d\.csv, \d of 4/).waitFor();
  await picture(page).nth(3).waitFor();
  const speed = page.getByLabel("Speed, mm/s");
  const { longest } = await busy(page, async () => {
    await speed.first().pressSequentially("82.5", { delay: 120 });
    await page.getByText("at 82.5 mm/s").waitFor();
  });
  t.diagnostic(`the longest task ${longest.toFixed(0)} ms`);
  assert.ok(longest < 100, `${longest} ms`);
  // It can be stopped, and begun again.
  await page.getByLabel("Read to, s").fill("19");
  await page.getByRole("button", { name: "Stop reading" }).click();
  await page.getByRole("button", { name: "Read the recordings" }).click();
  await page.getByText(/^19\.0 s at 20000 Hz/).nth(3).waitFor();
  await closed(page);
});

test("Firefox: files that are chosen and dropped are opened", { skip: existsSync(HTEX_FIREFOX) ? false : `no ${HTEX_FIREFOX}` }, async () => {
  const firefox = await puppeteer.launch({ browser: "firefox", executablePath: HTEX_FIREFOX, headless: true });
  try {
    for (const [, address] of WAYS) {
      const page = await firefox.newPage();
      await page.goto(address());
      await page.waitForFunction(() => document.documentElement.dataset.ready === "yes", { timeout: 20_000 });
      const input = await page.$("input[type=file]");
      await input.uploadFile(file("torn.htex"), file("blanket.htex"));
      await page.waitForFunction(() => htexStudio.texture.value?.name === "Blanket", { timeout: 10_000 });
      // Firefox has no way to drop files of the disk from outside; these are files of the page.
      await page.evaluate((all) => {
        const dataTransfer = new DataTransfer();
        for (const [name, bytes] of all) dataTransfer.items.add(new File([new Uint8Array(bytes)], name));
        document.body.dispatchEvent(new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer }));
      }, await Promise.all(["torn.htex", "hum.htex", "purr.htex"].map(async (name) => [name, Array.from(await readFile(file(name)))])));
      await page.waitForFunction(() => htexStudio.texture.value?.name === "Hum", { timeout: 10_000 });
      await page.waitForFunction(() => document.querySelector(".notice")?.textContent.includes("2 textures are on the shelf. torn.htex cannot be opened."), { timeout: 10_000 });
      await page.close();
    }
  } finally {
    await firefox.close();
  }
});
