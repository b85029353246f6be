// Files of other haptic formats in the studio, in Chromium.

import assert from "node:assert/strict";
import { copyFile, readFile, writeFile } from "node:fs/promises";
import test from "node:test";

import { assertAccessible, browser, bytesOf, closed, FILE, file, goTo, htex, isWhole, openStudio, prepare, server } from "./studio.mjs";

const GIVEN = ["--full-scale", "0.2", "--speed", "80", "--force", "0.4"];

/** Files that the command writes of a texture, and the model file of the exchange's tests. */
prepare(async () => {
  const hum = file("hum.htex");
  htex("make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02", "--at", "speed=80,force=0.5", "--license", "CC-BY-4.0", "-o", hum);
  for (const name of ["taps.ahap", "row.png", "chair.glb"]) htex("export", hum, "--to", { ahap: "ahap", png: "png", glb: "gltf" }[name.split(".")[1]], "-o", file(name));
  await copyFile(new URL("./felt.xml", import.meta.url), file("felt.xml"));
  const taps = await readFile(file("taps.ahap"));
  await writeFile(file("torn.ahap"), taps.subarray(0, taps.length / 2));
});

/** Drops a file on the page. */
async function drop(page, name) {
  const bytes = Array.from(await readFile(file(name)));
  await page.evaluate(([title, numbers]) => {
    const dataTransfer = new DataTransfer();
    dataTransfer.items.add(new File([new Uint8Array(numbers)], title));
    document.body.dispatchEvent(new DragEvent("drop", { bubbles: true, cancelable: true, dataTransfer }));
  }, [name, bytes]);
}

const onPad = (page, name) => page.waitForFunction((wanted) => htexStudio.texture.value?.name === wanted && htexStudio.present.value.change.startsWith("import"), name);

/** The bytes that the command imports a file to. */
async function imported(name, ...settings) {
  const out = file(`${name.split(".")[0]}.htex`);
  htex("import", file(name), ...settings, "-o", out);
  return readFile(out);
}

for (const [way, address] of [["the file", () => FILE], ["the folder", () => server.address]].slice(0, isWhole ? 2 : 1)) {
  test(`${way}: a dropped .ahap asks for what it does not say, and opens as the command imports it`, async () => {
    const page = await openStudio(browser, address());
    await drop(page, "taps.ahap");
    const form = page.getByRole("form", { name: "Import taps.ahap" });
    await form.getByText("Apple .ahap, version 1. Kept: level and one sharpness over time. Lost: the spectrum, speed and force, the unit; how sharp a sharpness is.").waitFor();
    await form.getByText("The file does not say how strong 1 is, at which speed it is felt and at which force.").waitFor();
    // Nothing is imported before all is said.
    await form.getByRole("button", { name: "Import" }).click();
    assert.equal(await form.getByLabel("How strong 1 is").evaluate((input) => input.validity.valueMissing), true);
    await form.getByLabel("How strong 1 is").fill("0.2");
    await form.getByLabel("Its unit").selectOption("acceleration");
    await form.getByLabel("Speed, mm/s").fill("80");
    await form.getByLabel("Force, N").fill("0.4");
    await form.getByLabel("range of").selectOption("quest");
    await form.getByLabel("Licence").fill("CC0-1.0");
    await form.getByRole("button", { name: "Import" }).click();
    await onPad(page, "taps");
    assert.ok((await bytesOf(page)).equals(await imported("taps.ahap", ...GIVEN, "--quantity", "acceleration", "--profile", "quest", "--license", "CC0-1.0")));
    await page.getByText(/Warning: Its [\d.]+ s are repeated 2 times\./).waitFor();
    assert.equal(await page.locator(".ranked li").count(), 6);
    assert.equal(await form.count(), 0);
    // A model that is chosen plays.
    await page.locator(".ranked li").nth(3).getByRole("button", { name: "To the pad" }).click();
    await page.waitForFunction(() => htexStudio.depth.value === 2);
    const others = page.requests.filter((url) => !url.startsWith(server.address));
    assert.deepEqual(others, []);
    await closed(page);
  });
}

test("a model file of HaTT and a glTF file open at once", async () => {
  const page = await openStudio(browser, FILE);
  await page.locator("input[type=file]").setInputFiles(file("felt.xml"));
  await onPad(page, "Felt");
  assert.ok((await bytesOf(page)).equals(await imported("felt.xml")));
  await page.getByText("Felt is on the shelf and on the pad.").waitFor();
  await drop(page, "chair.glb");
  await onPad(page, "hum");
  assert.ok((await bytesOf(page)).equals(await readFile(file("hum.htex"))));
  await goTo(page, "Save");
  assert.equal(await page.getByLabel("Licence").inputValue(), "CC-BY-4.0");
  await closed(page);
});

test("a map states the distance of its pixels or is asked for it, by keys alone", async () => {
  const page = await openStudio(browser, FILE);
  await drop(page, "row.png");
  const form = page.getByRole("form", { name: "Import row.png" });
  await form.waitFor();
  assert.equal(await form.getByLabel("mm per pixel").evaluate((input) => input.required), false);
  await form.getByLabel("How strong white is").focus();
  for (const text of ["0.2", null, "80", "0.4", "0.5"]) {
    if (text !== null) await page.keyboard.type(text);
    await page.keyboard.press("Tab");
  }
  await page.keyboard.press("Enter");
  await onPad(page, "row");
  assert.ok((await bytesOf(page)).equals(await imported("row.png", ...GIVEN, "--pitch", "0.5")));
  await goTo(page, "Save");
  assert.equal(await page.getByLabel("Licence").inputValue(), "CC-BY-4.0");
  await closed(page);
});

test("a damaged file says why, and numbers out of range do", async () => {
  const page = await openStudio(browser, FILE);
  await drop(page, "torn.ahap");
  const told = page.getByRole("status");
  await told.getByText("torn.ahap cannot be opened. It is damaged, or it is not what its name says.").waitFor();
  await told.getByText("Details").click();
  await told.getByText(/torn\.ahap: line \d+ column \d+: it is not JSON/).waitFor();
  assert.equal(await page.getByRole("form").count(), 0);
  await drop(page, "taps.ahap");
  const form = page.getByRole("form", { name: "Import taps.ahap" });
  for (const [label, value] of [["How strong 1 is", "0"], ["Speed, mm/s", "80"], ["Force, N", "0.4"]]) await form.getByLabel(label).fill(value);
  await form.getByRole("button", { name: "Import" }).click();
  await told.getByText("A value is missing or too large or too small.").waitFor();
  await told.getByText("Details").click();
  await told.getByText("full_scale 0: more than 0, at most 1e6").waitFor();
  await form.getByRole("button", { name: "Leave it out" }).click();
  await form.waitFor({ state: "detached" });
  await closed(page);
});

test("what is opened is what the command imports", async () => {
  const page = await openStudio(browser, FILE);
  const accepted = (await page.locator("input[type=file]").getAttribute("accept")).split(",");
  const { formats } = JSON.parse(htex("formats", "--json"));
  const extensions = formats.filter((format) => format.import).flatMap((format) => format.extensions);
  assert.ok(extensions.length > 5);
  for (const extension of extensions) assert.ok(accepted.includes(`.${extension}`), extension);
  await closed(page);
});

for (const viewport of [{ width: 1400, height: 900 }, { width: 390, height: 844 }].slice(isWhole ? 0 : 1)) {
  test(`the form has no finding of axe and fits ${viewport.width} px`, async () => {
    const page = await openStudio(browser, FILE, { viewport, hasTouch: viewport.width < 500, reducedMotion: "reduce" });
    for (const name of ["taps.ahap", "row.png"]) await drop(page, name);
    await page.getByRole("form", { name: "Import 2 files" }).waitFor();
    await assertAccessible(page);
    assert.ok((await page.evaluate(() => document.documentElement.scrollWidth)) <= viewport.width);
    const heights = await page.locator(".fields :is(input, select), .imports button, .files .check").evaluateAll((all) => all.map((one) => one.getBoundingClientRect().height));
    assert.ok(viewport.width > 500 || heights.every((height) => height >= 43.5), String(heights));
    const fields = await page.locator(".fields :is(input, select)").evaluateAll((all) => all.map((one) => one.getBoundingClientRect().right));
    assert.ok(fields.every((right) => right <= viewport.width), String(fields));
    await closed(page);
  });
}
