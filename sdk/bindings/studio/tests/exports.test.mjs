// Exports to other haptic formats in the studio, in Chromium: the files are those of the command.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import test from "node:test";

import { assertAccessible, browser, bytesOf, closed, FILE, file, goTo, htex, isWhole, openStudio, prepare, saved, server } from "./studio.mjs";

const MODULE = /htex-import[^/]*\.wasm/;
const { formats: FORMATS } = JSON.parse(htex("formats", "--json"));

/** Labels of fields with their values, labels of lists with the choices, the same as flags, and the extension, for each format. */
const CHOICES = {
  haptic: { fields: { "Speed, mm/s": "120", "Force, N": "0.6", Seconds: "1.5" }, flags: ["--speed", "120", "--force", "0.6", "--seconds", "1.5"], extension: "haptic" },
  ahap: { lists: { Actuator: "lra-175" }, flags: ["--profile", "lra-175"], extension: "ahap" },
  android: { lists: { File: "kt" }, flags: [], extension: "kt" },
  hjif: { lists: { "Coded as": "wavelet" }, flags: ["--coding", "wavelet"], extension: "hjif" },
  wav: { fields: { "Rate, Hz": "4000" }, flags: ["--rate", "4000"], extension: "wav" },
  png: { fields: { "Force, N": "0.7" }, flags: ["--force", "0.7"], extension: "png" },
  gltf: { flags: [], extension: "glb" },
};

prepare(async () => {
  htex("make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02", "--at", "speed=80,force=0.5", "--license", "CC-BY-4.0", "-o", file("hum.htex"));
});

const form = (page) => page.getByRole("form", { name: "Export" });
const save = (page) => form(page).getByRole("button", { name: /^Save \./ });

/** Opens the page with the texture of the tests on the pad, and the section of exports. */
async function openExports(address, options) {
  const page = await openStudio(browser, address, options);
  const bytes = Array.from(await readFile(file("hum.htex")));
  await page.evaluate((numbers) => htexStudio.begin(new Uint8Array(numbers), "open"), bytes);
  await goTo(page, "Save");
  assert.deepEqual(page.requests.filter((url) => MODULE.test(url)), []);
  await page.locator("summary", { hasText: "Other haptic formats" }).click();
  await form(page).waitFor();
  return page;
}

const choose = (page, title) => form(page).getByRole("group", { name: "Format" }).getByRole("button", { name: title }).click();

/** What the command writes and prints about the texture on the pad. */
async function exported(page, to, extension, flags) {
  await writeFile(file("now.htex"), await bytesOf(page));
  const model = await page.evaluate(() => htexStudio.present.value.model);
  const played = to === "gltf" ? [] : ["--model", model];
  const report = JSON.parse(htex("export", file("now.htex"), "--to", to, ...played, ...flags, "-o", file(`now.${extension}`), "--json"));
  return { bytes: await readFile(file(`now.${extension}`)), report };
}

for (const [way, address] of [["the file", () => FILE], ["the folder", () => server.address]].slice(0, isWhole ? 2 : 1)) {
  test(`${way}: every format is saved as the command exports it, and says what is lost`, async () => {
    const page = await openExports(address());
    const written = FORMATS.filter((format) => format.export);
    assert.deepEqual(written.map(({ name }) => name).sort(), Object.keys(CHOICES).sort());
    for (const { name: to, title } of written) {
      const { fields = {}, lists = {}, flags, extension } = CHOICES[to];
      await choose(page, title);
      for (const label of ["Speed, mm/s", "Force, N", "Seconds", "Rate, Hz"]) {
        const field = form(page).getByLabel(label);
        if ((await field.count()) > 0) await field.fill(fields[label] ?? "");
      }
      for (const [label, value] of Object.entries(lists)) await form(page).getByLabel(label).selectOption(value);
      const { name, bytes } = await saved(page, () => save(page).click());
      const own = await exported(page, to, extension, flags);
      assert.equal(name, `hum.${extension}`);
      assert.ok(bytes.equals(own.bytes), `${to}: other bytes`);
      const told = form(page).locator(".exported");
      await told.getByText(`hum.${extension} is saved: ${bytes.length} bytes`).waitFor();
      const text = await told.innerText();
      for (const part of [own.report.loses, own.report.rights, ...own.report.notes]) assert.ok(text.includes(part), `${to}: ${part} is not in ${text}`);
      assert.match(own.report.rights, /^It states the licence CC-BY-4\.0 \(/);
      assert.equal(/A difference is felt|feels no difference/.test(text), own.report.lost !== undefined, `${to}: ${text}`);
    }
    const loaded = page.requests.filter((url) => MODULE.test(url));
    assert.equal(loaded.length, way === "the file" ? 0 : 1);
    assert.deepEqual(page.requests.filter((url) => !url.startsWith(server.address)), []);
    await closed(page);
  });
}

test("the label is written first, and a file without a licence says so", async () => {
  const page = await openExports(FILE);
  await page.getByLabel("Name", { exact: true }).fill("Loud hum");
  await page.getByLabel("Licence").fill("");
  await choose(page, "Apple .ahap");
  const { name, bytes } = await saved(page, () => save(page).click());
  assert.equal(name, "loud-hum.ahap");
  assert.ok(bytes.equals((await exported(page, "ahap", "ahap", [])).bytes));
  await form(page).getByText("It states no licence, and without one nobody may pass it on").waitFor();
  await closed(page);
});

test("what cannot be exported says why, and the next export works", async () => {
  const page = await openExports(FILE);
  await choose(page, "WAV that drives an actuator");
  await form(page).getByLabel("Speed, mm/s").fill("0");
  await save(page).click();
  const notice = page.locator(".notice.bad");
  await notice.getByText("wav: the texture is silent at this motion; give a speed and a force at which it plays").waitFor();
  await form(page).getByLabel("Speed, mm/s").fill("");
  await form(page).getByLabel("Actuator").selectOption("erm");
  await save(page).click();
  await notice.getByText("choose haptic, ahap or android").waitFor();
  // Another format begins with its own actuator.
  await choose(page, "Meta .haptic");
  assert.equal((await saved(page, () => save(page).click())).name, "hum.haptic");
  await closed(page);
});

for (const viewport of [{ width: 1400, height: 900 }, { width: 390, height: 844 }].slice(isWhole ? 0 : 1)) {
  test(`the section works by keys, has no finding of axe and fits ${viewport.width} px`, async () => {
    const page = await openExports(FILE, { viewport, hasTouch: viewport.width < 500, reducedMotion: "reduce" });
    await form(page).getByRole("button", { name: "Apple .ahap" }).focus();
    await page.keyboard.press("Enter");
    await save(page).focus();
    assert.equal((await saved(page, () => page.keyboard.press("Enter"))).name, "hum.ahap");
    await form(page).locator(".exported").waitFor();
    await assertAccessible(page);
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= viewport.width);
    const heights = await form(page).locator(":is(input, select, button)").evaluateAll((all) => all.map((one) => one.getBoundingClientRect().height));
    assert.ok(viewport.width > 500 || heights.every((height) => height >= 43.5), String(heights));
    await closed(page);
  });
}
