// Textures are shown lit: wood and metal differ and stay the same, the light is moved by hand and by keys, and the appearance is edited,
// kept and guessed.

import assert from "node:assert/strict";
import { createHash } from "node:crypto";
import { writeFile } from "node:fs/promises";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { FILE, browser, bytesOf, closed, dropPaths, file, frames, goTo, htex, openStudio, prepare, ready, saved, server, shaping, thorough } from "./studio.mjs";

const APPEARANCE = "org.htex.appearance/1";
const WOOD = { hue_deg: 28, saturation: 0.5, lightness: 0.4, gloss: 0.2, relief: 0.5, pattern: "fibres" };

prepare();

const card = (page, name) => page.locator(".card", { hasText: new RegExp(`^${name}`) });
const digest = (data) => createHash("sha256").update(data).digest("hex");

/** Makes a texture by hand, with an appearance if one is given. */
async function make(name, { tags = [], look } = {}) {
  const out = file(`${name}.htex`);
  htex("make", "--model", "sslope", "--set", "peak_hz=120", "order_high_pass=0.8", "order_low_pass=0.8", "--level", "0.05", "--at", "speed=80,force=0.4", "--name", name, "--license", "CC0-1.0", "--tag", tags.join(","), "-o", out);
  if (look !== undefined) {
    await writeFile(file(`${name}.json`), JSON.stringify(look));
    htex("edit", out, "--extension", `${APPEARANCE}=${file(`${name}.json`)}`);
  }
  return out;
}

/** The mean colour of a picture once it is painted, and a digest of its pixels. */
async function painted(canvas) {
  await canvas.evaluate(async (one) => {
    while (one.width === 0 || one.getContext("2d").getImageData(0, 0, 1, 1).data[3] === 0) await new Promise(requestAnimationFrame);
  });
  const { mean, contrast, pixels } = await canvas.evaluate((one) => {
    const { data } = one.getContext("2d").getImageData(0, 0, one.width, one.height);
    const mean = [0, 1, 2].map((c) => data.reduce((sum, x, i) => sum + (i % 4 === c ? x : 0), 0) / (data.length / 4));
    const square = data.reduce((sum, x, i) => sum + (i % 4 === 3 ? 0 : (x - mean[i % 4]) ** 2), 0);
    return { mean, contrast: Math.sqrt(square / (0.75 * data.length)), pixels: String.fromCharCode(...data.subarray(0, 60_000)) };
  });
  return { mean, contrast, digest: digest(pixels) };
}

/** The picture of a card, which is painted only where it is seen. */
async function cardPicture(page, name) {
  await card(page, name).scrollIntoViewIfNeeded();
  return painted(card(page, name).locator("canvas"));
}

async function cardPictures(page, names) {
  const all = [];
  for (const name of names) all.push(await cardPicture(page, name));
  return all;
}

const padPicture = (page) => painted(page.locator(".pad canvas"));

async function take(page, name) {
  await goTo(page, "Shelf");
  await card(page, name).click();
  await page.waitForFunction((wanted) => htexStudio.texture.value.name === wanted, name);
}

const stated = (page) => page.evaluate((key) => htexStudio.texture.value.manifest.extensions?.[key], APPEARANCE);

/** The extension in a file, as the command reads it. */
async function inFile(bytes) {
  await writeFile(file("saved.htex"), bytes);
  htex("validate", file("saved.htex"));
  return JSON.parse(htex("info", file("saved.htex"), "--json")).manifest.extensions?.[APPEARANCE];
}

thorough("a wood is warm, a metal is cool, and both look the same after a reload and in the folder", async () => {
  const page = await openStudio(browser, FILE);
  const looks = (of) => cardPictures(of, ["Oak", "Brushed steel", "Silk"]);
  const [oak, steel, silk] = await looks(page);
  assert.ok(oak.mean[0] > oak.mean[2] + 25, `Oak is not warm: ${oak.mean}`);
  assert.ok(steel.mean[2] >= steel.mean[0], `steel is not cool: ${steel.mean}`);
  assert.ok(oak.contrast > silk.contrast, `${oak.contrast} ${silk.contrast}`);
  assert.equal(new Set([oak, steel, silk].map((one) => one.digest)).size, 3);
  await page.reload();
  await ready(page);
  assert.deepEqual(await looks(page), [oak, steel, silk]);
  const other = await openStudio(browser, server.address);
  assert.deepEqual(await looks(other), [oak, steel, silk]);
  await closed(other);
  await closed(page);
});

test("what tags, name and spectrum say is guessed", async () => {
  const page = await openStudio(browser, FILE, { reducedMotion: "reduce" });
  const names = ["First", "Second", "Third", "Blue thing", "Walnut box"];
  const tags = { First: ["oak"], Second: ["steel", "hard"], Third: ["linen"], "Blue thing": ["blue"] };
  await dropPaths(page, await Promise.all(names.map((name) => make(name, { tags: tags[name] }))));
  await page.locator(".notice", { hasText: "5 textures" }).waitFor();
  await goTo(page, "Shelf");
  const [oak, steel, linen, blue, walnut] = await cardPictures(page, names);
  assert.ok(oak.mean[0] > oak.mean[2] + 25 && walnut.mean[0] > walnut.mean[2] + 25, `${oak.mean} ${walnut.mean}`);
  assert.ok(steel.mean[2] >= steel.mean[0] && blue.mean[2] > blue.mean[0] + 25, `${steel.mean} ${blue.mean}`);
  assert.equal(new Set([oak, steel, linen, blue].map((one) => one.digest)).size, 4);
  // Nothing is written before it is set.
  await take(page, "First");
  assert.equal(await stated(page), undefined);
  await closed(page);
});

test("the light is dragged, and moved by keys", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  const lamp = page.getByRole("slider", { name: "Light on the pad" });
  const centre = async () => {
    const { x, y, width, height } = await lamp.boundingBox();
    return { x: x + width / 2, y: y + height / 2 };
  };
  const pad = await page.locator(".pad canvas").boundingBox();
  const first = await padPicture(page);
  const from = await centre();
  await page.mouse.move(from.x, from.y);
  await page.mouse.down();
  for (let i = 1; i <= 10; i++) await page.mouse.move(from.x + (i / 10) * (pad.x + 0.8 * pad.width - from.x), from.y + (i / 10) * (pad.y + 0.7 * pad.height - from.y));
  await page.mouse.up();
  await frames(page);
  // Nothing was touched.
  assert.equal(await page.evaluate(() => htexStudio.finger.value.force), 0);
  assert.match(await lamp.getAttribute("aria-valuetext"), /^80 % across, 70 % down$/);
  const dragged = await padPicture(page);
  assert.notEqual(dragged.digest, first.digest);
  for (const [key, text] of [["ArrowLeft", "75 % across, 70 % down"], ["ArrowUp", "75 % across, 65 % down"], ["PageUp", "75 % across, 40 % down"], ["Home", "0 % across, 40 % down"], ["End", "100 % across, 40 % down"]]) {
    await page.keyboard.press(key);
    assert.equal(await lamp.getAttribute("aria-valuetext"), text, key);
  }
  await frames(page);
  assert.notEqual((await padPicture(page)).digest, dragged.digest);
  // The handle stays inside the pad.
  const at = await lamp.boundingBox();
  assert.ok(at.x >= pad.x - 1 && at.x + at.width <= pad.x + pad.width + 1, JSON.stringify(at));
  await closed(page);
});

thorough("keys alone set the appearance; it is in the file, on the pad and on the card, and each key is a step", async () => {
  const page = await openStudio(browser, FILE, { reducedMotion: "reduce" });
  await take(page, "Slate");
  const before = await padPicture(page);
  const first = await bytesOf(page);
  await goTo(page, "Save");
  const group = page.getByRole("group", { name: "Appearance" });
  await group.getByRole("slider", { name: "Hue" }).waitFor();
  const reach = async (label) => {
    for (let i = 0; i < 120; i++) {
      if (await page.evaluate((wanted) => document.activeElement?.getAttribute("aria-label") === wanted || document.activeElement?.textContent === wanted, label)) return;
      await page.keyboard.press("Tab");
    }
    assert.fail(`${label} is not reached`);
  };
  const own = await stated(page);
  await reach("Hue");
  for (let i = 0; i < 3; i++) await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => htexStudio.depth.value === 4);
  await reach("Gloss");
  await page.keyboard.press("End");
  await reach("Relief");
  await page.keyboard.press("Home");
  await reach("Ridges");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => htexStudio.depth.value === 7);
  const wanted = { ...own, hue_deg: own.hue_deg + 3, gloss: 1, relief: 0, pattern: "ridges" };
  assert.deepEqual(await stated(page), wanted);
  await page.waitForFunction(() => document.querySelector("[aria-labelledby=appearance-title] button[aria-pressed=true]")?.textContent === "Ridges");
  await page.waitForTimeout(300);
  assert.notEqual((await padPicture(page)).digest, before.digest);
  const { bytes } = await saved(page, () => page.getByRole("button", { name: "Save .htex" }).click());
  assert.deepEqual(await inFile(bytes), wanted);
  for (let i = 0; i < 6; i++) await page.keyboard.press("ControlOrMeta+z");
  await page.waitForFunction(() => htexStudio.depth.value === 1);
  assert.deepEqual(await bytesOf(page), first);
  await closed(page);
});

test("a drag of a slider is one step, and the guess comes back", async () => {
  const page = await openStudio(browser, FILE);
  await dropPaths(page, [await make("Plain", { tags: ["oak"] })]);
  await page.waitForFunction(() => htexStudio.texture.value?.name === "Plain");
  await goTo(page, "Save");
  const group = page.getByRole("group", { name: "Appearance" });
  const hue = group.getByRole("slider", { name: "Hue" });
  await hue.scrollIntoViewIfNeeded();
  const guessed = Number(await hue.inputValue());
  const depth = await page.evaluate(() => htexStudio.depth.value);
  const { x, y, width, height } = await hue.boundingBox();
  for (const [from, to] of [[0.1, 0.5], [0.5, 0.7]]) {
    await page.mouse.move(x + from * width, y + height / 2);
    await page.mouse.down();
    for (let i = 1; i <= 12; i++) await page.mouse.move(x + (from + ((to - from) * i) / 12) * width, y + height / 2);
    await page.mouse.up();
  }
  await page.waitForFunction((wanted) => htexStudio.depth.value === wanted, depth + 2);
  assert.ok(Math.abs((await stated(page)).hue_deg - 252) < 20, JSON.stringify(await stated(page)));
  await group.getByRole("button", { name: "Guess it again" }).click();
  await page.waitForFunction((key) => !htexStudio.texture.value.manifest.extensions?.[key], APPEARANCE);
  assert.equal(Number(await hue.inputValue()), guessed);
  await closed(page);
});

test("shaping, varying and mixing carry the appearance along", async () => {
  const page = await openStudio(browser, FILE);
  const violet = { ...WOOD, hue_deg: 280 };
  await dropPaths(page, [await make("Violet", { look: violet })]);
  await page.waitForFunction(() => htexStudio.texture.value?.name === "Violet");
  await shaping(page);
  await page.getByRole("slider", { name: "Rougher" }).focus();
  await page.keyboard.press("ArrowRight");
  await page.waitForFunction(() => htexStudio.present.value.change === "change rougher");
  assert.deepEqual(await stated(page), violet);
  await goTo(page, "Vary");
  const varied = page.getByRole("button", { name: /^Variation 3/ });
  await painted(varied.locator("canvas"));
  await varied.click();
  await page.waitForFunction(() => htexStudio.present.value.change.startsWith("vary"));
  assert.deepEqual(await stated(page), violet);
  await goTo(page, "Mix");
  await painted(page.locator(".mix-square canvas"));
  await page.getByRole("button", { name: "Take this mixture" }).click();
  await page.waitForFunction(() => htexStudio.present.value.change === "mix");
  const mixed = await inFile(await bytesOf(page));
  assert.ok(mixed.gloss > 0 && mixed.gloss < 1 && mixed.hue_deg !== 280, JSON.stringify(mixed));
  await closed(page);
});

thorough("an appearance that breaks the schema is guessed instead, and nothing fails", async () => {
  const page = await openStudio(browser, FILE, { reducedMotion: "reduce" });
  const guess = await make("Guess", { tags: ["oak"] });
  const wrong = [null, [], "red", 7, {}, { ...WOOD, hue_deg: 400 }, { ...WOOD, gloss: "high" }, { ...WOOD, pattern: "stars" }, { ...WOOD, more: 1 }, { ...WOOD, relief: undefined }];
  await dropPaths(page, [guess, ...(await Promise.all(wrong.slice(1).map((look, i) => make(`Wrong ${i}`, { tags: ["oak"], look }).then((one) => one))))]);
  await page.locator(".notice", { hasText: "10 textures" }).waitFor();
  await goTo(page, "Shelf");
  const right = await cardPicture(page, "Guess");
  for (let i = 0; i < wrong.length - 1; i++) assert.equal((await cardPicture(page, `Wrong ${i}`)).digest, right.digest, `Wrong ${i}`);
  // It is replaced once it is set.
  await take(page, "Wrong 3");
  await goTo(page, "Save");
  await page.getByRole("group", { name: "Appearance" }).getByRole("button", { name: "Weave" }).click();
  await page.waitForFunction((key) => htexStudio.texture.value.manifest.extensions?.[key]?.pattern === "weave", APPEARANCE);
  await closed(page);
});

thorough("the player page shows the texture lit, and its light moves", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  await goTo(page, "Save");
  const { name, bytes } = await saved(page, () => page.getByRole("button", { name: "Save a player page" }).click());
  await writeFile(file(name), bytes);
  const player = await openStudio(browser, pathToFileURL(file(name)).href);
  const pad = player.locator("#pad");
  const first = await painted(pad);
  assert.ok(first.mean[0] > first.mean[2] + 25, `Oak is not warm: ${first.mean}`);
  const lamp = player.getByRole("slider", { name: "Light on the pad" });
  await lamp.focus();
  await player.keyboard.press("End");
  await frames(player);
  assert.notEqual((await painted(pad)).digest, first.digest);
  assert.match(await lamp.getAttribute("aria-valuetext"), /^100 % across/);
  await closed(player);
  await closed(page);
});

/** Makes a library of 2,000 textures in a page. */
async function makeLibrary() {
  const page = await openStudio(browser, FILE);
  await goTo(page, "Save");
  await page.waitForFunction(() => htexStudio.author.value);
  const source = Array.from(await bytesOf(page));
  const { bytes } = await saved(page, () =>
    page.evaluate((source) => {
      const author = htexStudio.author.value;
      const words = ["oak", "steel", "linen", "gravel", "leather", "paper", "cloth", "thing"];
      const textures = {};
      for (let i = 0; i < 2000; i++) {
        const number = String(i).padStart(4, "0");
        const made = author.edit(new Uint8Array(source), { name: `Cloth ${number}`, tags: [words[i % words.length]], license: "CC0-1.0", extensions: { "org.htex.appearance/1": null } });
        textures[`cloth/${number}`] = made.toBytes();
        made.free();
      }
      const href = URL.createObjectURL(new Blob([author.library(textures)]));
      Object.assign(document.createElement("a"), { href, download: "big.htexlib" }).click();
    }, source),
  );
  await page.context().close();
  await writeFile(file("big.htexlib"), bytes);
  return file("big.htexlib");
}

/** Lists the tasks that took longer than 50 ms. */
const listen = () => {
  window.tasks = [];
  new PerformanceObserver((list) => list.getEntries().forEach(({ duration }) => window.tasks.push(Math.round(duration)))).observe({ type: "longtask" });
};

thorough("2,000 cards are painted as they come, and give their memory back", async (t) => {
  const library = await makeLibrary();
  const page = await openStudio(browser, FILE, { init: listen });
  await page.waitForTimeout(500);
  await dropPaths(page, [library]);
  await page.locator(".notice", { hasText: "2,000 textures" }).waitFor();
  await goTo(page, "Shelf");
  await page.mouse.move(500, 500);
  await page.evaluate(() => (window.tasks.length = 0));
  // The shelf's own forty come first.
  for (let i = 0; i < 2000 && (await page.locator(".card").count()) < 2040; i++) {
    await page.mouse.wheel(0, 1500);
    await page.waitForTimeout(20);
  }
  assert.equal(await page.locator(".card").count(), 2040);
  await page.locator(".card").last().scrollIntoViewIfNeeded();
  const last = await painted(page.locator(".card canvas").last());
  assert.ok(last.contrast > 1);
  await page.waitForTimeout(500);
  const { tasks, pixels } = await page.evaluate(() => ({
    tasks: window.tasks,
    pixels: [...document.querySelectorAll(".card canvas")].reduce((sum, { width, height }) => sum + width * height, 0),
  }));
  t.diagnostic(`tasks above 50 ms: ${tasks.join(", ") || "none"}; ${(4 * pixels / 1e6).toFixed(1)} MB of pictures`);
  assert.ok(4 * pixels < 20e6, `${pixels} pixels`);
  await closed(page);
});
