// What the user made stays: the history, the label, the shelf, over reloads and in several tabs, and when the browser stores nothing.

import assert from "node:assert/strict";
import { mkdir, writeFile } from "node:fs/promises";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { chromium } from "playwright-core";

import { browser, bytesOf, closed, FILE, folder, goTo, htex, HTEX_CHROMIUM, isWhole, openStudio, prepare, ready, saved, SCREENS, server, shaping, thorough } from "./studio.mjs";

prepare();

/** Another tab of the same browser. */
async function openTab(page, address) {
  const context = page.context();
  return openStudio({ newContext: () => context }, address);
}

/** Puts a texture of the shelf on the pad. */
async function take(page, name) {
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: new RegExp(`^${name}`) }).click();
  await page.waitForFunction((wanted) => htexStudio.present.value.name === wanted, name);
}

/** Presses on the spectrum and draws upwards. */
async function pressAndDraw(page, across = 0.3) {
  const { x, y, width, height } = await page.locator(".spectrum canvas").boundingBox();
  const before = await page.evaluateHandle(() => htexStudio.present.value);
  await page.mouse.move(x + across * width, y + 0.5 * height);
  await page.mouse.down();
  for (let i = 1; i < 6; i++) await page.mouse.move(x + across * width, y + (0.5 - 0.05 * i) * height);
  await page.waitForFunction((old) => htexStudio.present.value !== old, before);
}

/** Draws a bar: one step. */
async function draw(page, across) {
  const steps = await page.evaluate(() => htexStudio.depth.value);
  await pressAndDraw(page, across);
  await page.mouse.up();
  await page.waitForFunction((count) => htexStudio.depth.value === count, steps + 1);
  // The hand lets go in the next frame.
  await page.evaluate(() => new Promise((resolve) => requestAnimationFrame(() => requestAnimationFrame(resolve))));
}

/** Presses a button of the history, and waits for its message. */
async function press(page, name) {
  const before = await page.evaluateHandle(() => htexStudio.present.value);
  await page.getByRole("button", { name, exact: true }).first().click();
  await page.waitForFunction((old) => htexStudio.present.value !== old, before);
}

const pressUndo = (page) => press(page, "Undo");
const pressRedo = (page) => press(page, "Redo");

/** Waits until a page shows a texture. */
const shows = (page, bytes) => page.waitForFunction((wanted) => htexStudio.present.value?.bytes.join() === wanted, [...bytes].join());

/** RMS of what is heard while the autopilot slides steadily, in decibels. */
async function loudness(page) {
  await page.getByRole("button", { name: "Steady" }).click();
  await page.waitForFunction(() => Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.005);
  const db = await page.evaluate(async () => {
    let [power, count] = [0, 0];
    for (let i = 0; i < 80; i++) {
      await new Promise((resolve) => setTimeout(resolve, 25));
      for (const x of htexStudio.heard(new Float32Array(1024))) [power, count] = [power + x * x, count + 1];
    }
    return 10 * Math.log10(power / count);
  });
  await page.keyboard.press("Escape");
  return db;
}

test("undo across an opened texture brings back its loudness and what it was when it was opened", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  const opened = await bytesOf(page);
  await shaping(page);
  await draw(page);
  const loud = await loudness(page);
  // Silk is 12 dB weaker, so that it plays with more gain.
  await take(page, "Silk");
  await pressUndo(page);
  const again = await loudness(page);
  assert.ok(Math.abs(again - loud) < 2, `${again} dB after undo, ${loud} dB before`);
  await page.locator(".piece", { hasText: "Oak · edited" }).waitFor();
  await goTo(page, "Compare");
  await page.getByText(/A difference is felt|feels no difference/).waitFor();
  await pressUndo(page);
  assert.deepEqual(await bytesOf(page), opened);
  await page.getByText("Even a sensitive finger feels no difference.").waitFor({ timeout: 5000 });
  assert.doesNotMatch(await page.locator(".piece").textContent(), /edited/);
  // And forward again, to Silk as it was opened.
  await pressRedo(page);
  await pressRedo(page);
  assert.match(await page.locator(".piece").textContent(), /^Silk$/);
  await closed(page);
});

test("a name and a description are there on other screens and after a reload, without a press on Save", async () => {
  const page = await openStudio(browser, server.address);
  await goTo(page, "Save");
  await page.getByLabel("Name").click();
  await page.keyboard.press("ControlOrMeta+a");
  await page.keyboard.type("Grandmother's curtain");
  await page.getByLabel("Description").click();
  await page.keyboard.press("ControlOrMeta+a");
  await page.keyboard.type("Heavy, with a hem.");
  await goTo(page, "Shape");
  await page.locator(".piece", { hasText: "Grandmother's curtain" }).waitFor();
  await goTo(page, "Save");
  const isThere = async () => {
    await page.waitForFunction(() => document.querySelector("main input")?.value === "Grandmother's curtain");
    assert.equal(await page.getByLabel("Description").inputValue(), "Heavy, with a hem.");
  };
  await isThere();
  await page.reload();
  await ready(page);
  await goTo(page, "Save");
  await isThere();
  // Two fields are two steps.
  await pressUndo(page);
  await page.waitForFunction(() => document.querySelector("main textarea")?.value.includes("simulated"));
  await pressUndo(page);
  await page.waitForFunction(() => document.querySelector("main input")?.value === "Coarse fabric");
  // A name that is emptied is the last one again.
  await page.getByLabel("Name").fill("");
  await page.getByLabel("Author").click();
  assert.equal(await page.getByLabel("Name").inputValue(), "Coarse fabric");
  await closed(page);
});

/** Puts the present texture on the shelf under a name. */
async function keepAs(page, name) {
  await goTo(page, "Save");
  await page.getByLabel("Name").fill(name);
  await page.getByRole("button", { name: "Keep on the shelf" }).click();
  await page.getByText(`${name} is on the shelf`).waitFor();
}

const cards = (page) => page.locator(".card-name").allTextContents();
const card = (page, name) => page.locator(".card", { hasText: name });

test("a texture that was forgotten comes back by Undo in the message", async () => {
  const page = await openStudio(browser, server.address);
  for (const name of ["First", "Second", "Third"]) await keepAs(page, name);
  await goTo(page, "Shelf");
  const whole = await cards(page);
  assert.deepEqual(whole.slice(0, 3), ["Third", "Second", "First"]);
  const undo = page.getByRole("status").getByRole("button", { name: "Undo" });
  // By mouse: two are forgotten, and one press brings back both.
  await page.getByRole("button", { name: "Forget Second" }).click();
  await page.getByRole("button", { name: "Forget Third" }).click();
  await card(page, "Third").waitFor({ state: "detached" });
  await undo.click();
  await card(page, "Second").waitFor();
  assert.deepEqual(await cards(page), whole);
  // By keys: the button is gone, and the keyboard goes on at Undo.
  await page.getByRole("button", { name: "Forget First" }).focus();
  await page.keyboard.press("Enter");
  await card(page, "First").waitFor({ state: "detached" });
  await page.waitForFunction(() => document.activeElement?.textContent.trim() === "Undo");
  await page.keyboard.press("Enter");
  await card(page, "First").waitFor();
  await page.getByRole("button", { name: "Forget First" }).click();
  await card(page, "First").waitFor({ state: "detached" });
  await page.keyboard.press("ControlOrMeta+z");
  await card(page, "First").waitFor();
  await page.reload();
  await ready(page);
  await card(page, "First").waitFor();
  assert.deepEqual(await cards(page), whole);
  // Without Undo it stays forgotten.
  await page.getByRole("button", { name: "Forget Second" }).click();
  await undo.waitFor();
  await page.reload();
  await ready(page);
  await card(page, "First").waitFor();
  assert.deepEqual((await cards(page)).slice(0, 2), ["Third", "First"]);
  await closed(page);
});

for (const [way, address] of [["the file", () => FILE], ["the folder", () => server.address]].slice(0, isWhole ? 2 : 1)) {
  test(`${way}: what was drawn just before the page is closed is there again`, async () => {
    let page = await openStudio(browser, address());
    const context = page.context();
    await take(page, "Oak");
    await shaping(page);
    // The hand lets go, and the page is loaded anew at once.
    await draw(page);
    const first = await bytesOf(page);
    await page.reload();
    await ready(page);
    assert.deepEqual(await bytesOf(page), first);
    // The page is closed while the hand still draws.
    await shaping(page);
    await pressAndDraw(page, 0.5);
    const second = await bytesOf(page);
    assert.notDeepEqual(second, first);
    await Promise.all([page.waitForEvent("close"), page.close({ runBeforeUnload: true })]);
    page = await openStudio({ newContext: () => context }, address());
    assert.deepEqual(await bytesOf(page), second);
    await pressUndo(page);
    assert.deepEqual(await bytesOf(page), first);
    // A key is still down.
    await shaping(page);
    await page.locator(".spectrum canvas").focus();
    await page.keyboard.down("ArrowUp");
    const third = await bytesOf(page);
    assert.notDeepEqual(third, first);
    await page.reload();
    await ready(page);
    assert.deepEqual(await bytesOf(page), third);
    await closed(page);
  });
}

test("the history survives a reload", async () => {
  const page = await openStudio(browser, server.address);
  const states = [await bytesOf(page)];
  await take(page, "Oak");
  states.push(await bytesOf(page));
  await shaping(page);
  for (const across of [0.2, 0.4, 0.6]) {
    await draw(page, across);
    states.push(await bytesOf(page));
  }
  await pressUndo(page);
  await page.reload();
  await ready(page);
  assert.deepEqual(await bytesOf(page), states[3]);
  await page.locator(".piece", { hasText: "Oak · edited" }).waitFor();
  await pressRedo(page);
  assert.deepEqual(await bytesOf(page), states[4]);
  for (const state of states.slice(0, -1).reverse()) {
    await pressUndo(page);
    assert.deepEqual(await bytesOf(page), state);
  }
  assert.ok(await page.getByRole("button", { name: "Undo", exact: true }).isDisabled());
  // What was undone is not lost by another reload either.
  await page.reload();
  await ready(page);
  for (const state of states.slice(1)) {
    await pressRedo(page);
    assert.deepEqual(await bytesOf(page), state);
  }
  await closed(page);
});

test("a link does not replace the last work, and a reload brings back what was made of the link", async () => {
  const page = await openStudio(browser, server.address);
  await shaping(page);
  await draw(page, 0.4);
  const work = await bytesOf(page);
  await take(page, "Oak");
  const link = await page.evaluate(() => `${location.href}#t=${btoa(String.fromCharCode(...htexStudio.present.value.bytes)).replaceAll("+", "-").replaceAll("/", "_").replaceAll("=", "")}`);
  await pressUndo(page);
  const tab = await openTab(page, link);
  await tab.getByText("Oak came with the link.").waitFor();
  await shaping(tab);
  await draw(tab, 0.4);
  const made = await bytesOf(tab);
  await tab.reload();
  await ready(tab);
  assert.deepEqual(await bytesOf(tab), made);
  await pressUndo(tab);
  await pressUndo(tab);
  assert.deepEqual(await bytesOf(tab), work);
  assert.deepEqual(tab.errors, []);
  await closed(page);
});

/** The bytes of all that the browser stores of the history. */
function storedBytes(page) {
  return page.evaluate(async () => {
    const asked = (request) => new Promise((resolve, reject) => Object.assign(request, { onsuccess: () => resolve(request.result), onerror: () => reject(request.error) }));
    const database = await asked(indexedDB.open("htex-studio"));
    const all = await asked(database.transaction("session").objectStore("session").getAll());
    database.close();
    return { records: all.length, bytes: all.reduce((sum, one) => sum + (one.bytes?.length ?? 0), 0) };
  });
}

thorough("the history is bounded in bytes", async () => {
  const page = await openStudio(browser, server.address);
  await shaping(page);
  // Files of two megabytes each: the description cannot be compressed.
  const files = await page.evaluate(() => {
    const { author, texture } = htexStudio;
    return Array.from({ length: 12 }, () => {
      const text = () => btoa(String.fromCharCode(...crypto.getRandomValues(new Uint8Array(48_000))));
      const large = author.value.edit(texture.value, { description: Array.from({ length: 40 }, text).join("") });
      const bytes = large.toBytes();
      large.free();
      let binary = "";
      for (let at = 0; at < bytes.length; at += 0x8000) binary += String.fromCharCode(...bytes.subarray(at, at + 0x8000));
      return btoa(binary);
    });
  });
  const all = files.map((text) => Buffer.from(text, "base64"));
  await goTo(page, "Shelf");
  for (const buffer of all) {
    const before = await page.evaluateHandle(() => htexStudio.present.value);
    await page.locator("main input[type=file]").setInputFiles({ name: "large.htex", mimeType: "application/octet-stream", buffer });
    await page.waitForFunction((old) => htexStudio.present.value !== old, before);
  }
  // Two megabytes take a moment to be written.
  await page.waitForTimeout(1000);
  await page.reload();
  await ready(page);
  const present = await bytesOf(page);
  assert.equal(all.findIndex((one) => one.equals(present)), all.length - 1);
  const steps = await page.evaluate(() => htexStudio.depth.value);
  const { bytes, records } = await storedBytes(page);
  const total = all.reduce((sum, one) => sum + one.length, 0);
  const told = `${total} bytes were opened, ${bytes} are stored in ${records} records, ${steps} steps`;
  assert.ok(total > 20 * 2 ** 20 && bytes <= 16 * 2 ** 20 && bytes > 12 * 2 ** 20 && steps < 9, told);
  // What is left leads back.
  for (let i = 1; i <= steps; i++) {
    await pressUndo(page);
    const before = await bytesOf(page);
    assert.equal(all.findIndex((one) => one.equals(before)), all.length - 1 - i);
  }
  await closed(page);
});

test("two tabs show the same work, and neither overwrites the other's", async () => {
  const page = await openStudio(browser, server.address);
  await take(page, "Oak");
  const opened = await bytesOf(page);
  await shaping(page);
  await draw(page, 0.2);
  const first = await bytesOf(page);
  const tab = await openTab(page, server.address);
  assert.deepEqual(await bytesOf(tab), first);
  await shaping(tab);
  // One draws, the other follows, in both directions.
  await draw(tab, 0.4);
  const second = await bytesOf(tab);
  await shows(page, second);
  await page.bringToFront();
  await draw(page, 0.6);
  const third = await bytesOf(page);
  await shows(tab, third);
  await pressUndo(page);
  await shows(tab, second);
  await pressRedo(tab);
  await shows(page, third);
  // Both draw at the same time: both then show the later step, and the other one is a step before.
  await tab.bringToFront();
  await pressAndDraw(tab, 0.8);
  await page.bringToFront();
  await draw(page, 0.3);
  const fourth = await bytesOf(page);
  await tab.mouse.up();
  const fifth = await bytesOf(tab);
  assert.notDeepEqual(fourth, fifth);
  await shows(page, fifth);
  await pressUndo(tab);
  assert.deepEqual(await bytesOf(tab), fourth);
  await shows(page, fourth);
  // Nothing of either is lost after a reload.
  await page.reload();
  await ready(page);
  for (const state of [third, second, first, opened]) {
    await pressUndo(page);
    assert.deepEqual(await bytesOf(page), state);
  }
  await shows(tab, opened);
  assert.deepEqual(tab.errors, []);
  await closed(page);
});

thorough("two tabs have the same shelf", async () => {
  const page = await openStudio(browser, server.address);
  const tab = await openTab(page, server.address);
  await keepAs(tab, "Of the other tab");
  await goTo(page, "Shelf");
  await card(page, "Of the other tab").waitFor();
  await page.getByRole("button", { name: "Forget Of the other tab" }).click();
  await goTo(tab, "Shelf");
  await card(tab, "Of the other tab").waitFor({ state: "detached" });
  await page.getByRole("status").getByRole("button", { name: "Undo" }).click();
  await card(tab, "Of the other tab").waitFor();
  assert.deepEqual(tab.errors, []);
  await closed(page);
});

test("a texture that the browser did not store is not shown as stored", async () => {
  const page = await openStudio(browser, server.address);
  const session = await page.context().newCDPSession(page);
  const origin = new URL(server.address).origin;
  await session.send("Storage.overrideQuotaForOrigin", { origin, quotaSize: 1 });
  await goTo(page, "Save");
  await page.getByLabel("Name").fill("Too much");
  await page.getByRole("button", { name: "Keep on the shelf" }).click();
  await page.locator(".notice.bad", { hasText: "did not store" }).waitFor();
  await page.locator(".piece", { hasText: "not stored" }).waitFor();
  await goTo(page, "Shelf");
  assert.match(await card(page, "Too much").textContent(), /Not stored/);
  // It can be used all the same.
  await card(page, "Too much").click();
  await page.getByText("Too much is on the pad.").waitFor();
  // There is room again.
  await session.send("Storage.overrideQuotaForOrigin", { origin });
  await keepAs(page, "Enough room");
  await page.locator(".piece", { hasText: "not stored" }).waitFor({ state: "detached" });
  await goTo(page, "Shelf");
  assert.doesNotMatch(await card(page, "Enough room").textContent(), /Not stored/);
  await page.reload();
  await ready(page);
  await card(page, "Enough room").waitFor();
  assert.equal(await card(page, "Too much").count(), 0);
  await closed(page);
});

/** That a page without storage plays, shapes, takes a file on its shelf and saves, and says that it stores nothing. */
async function assertWorksWithoutStorage(page, told) {
  await page.locator(".notice.bad", { hasText: told }).waitFor({ timeout: 5000 });
  await page.locator(".piece", { hasText: "not stored" }).waitFor();
  assert.ok((await cards(page)).length >= 20);
  await take(page, "Oak");
  await loudness(page);
  await shaping(page);
  const before = await bytesOf(page);
  await draw(page);
  await pressUndo(page);
  assert.deepEqual(await bytesOf(page), before);
  await goTo(page, "Save");
  await page.getByLabel("Name").fill("Without storage");
  const { name, bytes } = await saved(page, () => page.getByRole("button", { name: "Save .htex" }).click());
  assert.equal(name, "without-storage.htex");
  const file = path.join(folder, name);
  await writeFile(file, bytes);
  htex("validate", file);
  await goTo(page, "Shelf");
  await page.locator("main input[type=file]").setInputFiles(file);
  await card(page, "Without storage").waitFor();
  assert.match(await card(page, "Without storage").textContent(), /Not stored/);
}

thorough("a database that never answers leaves a page that works, and what was made is stored once it answers", async () => {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 }, acceptDownloads: true });
  // Another page of this address holds the database while it is to be deleted: nobody else gets an answer.
  const other = await context.newPage();
  await other.goto(`${server.address}icon.svg`);
  await other.evaluate(async () => {
    const request = indexedDB.open("htex-studio", 1);
    request.onupgradeneeded = () => {
      request.result.createObjectStore("own", { keyPath: "id" });
      request.result.createObjectStore("session");
    };
    await new Promise((resolve) => (request.onsuccess = resolve));
    globalThis.held = request.result;
    indexedDB.deleteDatabase("htex-studio");
  });
  const page = await openStudio({ newContext: () => context }, server.address);
  await assertWorksWithoutStorage(page, "does not answer");
  const work = await bytesOf(page);
  await other.evaluate(() => globalThis.held.close());
  await page.locator(".piece", { hasText: "not stored" }).waitFor({ state: "detached" });
  await card(page, "Without storage").filter({ hasNotText: "Not stored" }).waitFor();
  await page.reload();
  await ready(page);
  assert.deepEqual(await bytesOf(page), work);
  await card(page, "Without storage").waitFor();
  await closed(page);
});

test("a database that is refused leaves a page that works", async () => {
  const profile = path.join(folder, "profile");
  await mkdir(path.join(profile, "Default"), { recursive: true });
  await writeFile(path.join(profile, "Default/Preferences"), JSON.stringify({ profile: { default_content_setting_values: { cookies: 2 } } }));
  const context = await chromium.launchPersistentContext(profile, { executablePath: HTEX_CHROMIUM, args: ["--no-sandbox", "--disable-gpu", "--disable-background-networking"], viewport: { width: 1400, height: 900 }, acceptDownloads: true });
  const page = await openStudio({ newContext: () => context }, server.address);
  await assertWorksWithoutStorage(page, "does not let this page store anything");
  await closed(page);
});

/** What is wider than its place. */
function tooWide(page) {
  return page.evaluate(() => {
    const wide = [document.documentElement, ...document.querySelectorAll("main, main *, .top, .piece, .notice, .notice *")].filter((element) => {
      if (!element.checkVisibility() || element.closest("canvas, svg, pre, .scroll-x, .chips, .segments, select, input, .slider, .hidden")) return false;
      return element.scrollWidth > element.clientWidth + 1 && element.clientWidth > 0 && getComputedStyle(element).display !== "inline";
    });
    return wide.map((element) => `${element.tagName}.${element.className}: ${element.scrollWidth} in ${element.clientWidth} px`);
  });
}

for (const viewport of [{ width: 1400, height: 900 }, { width: 390, height: 844 }].slice(isWhole ? 0 : 1)) {
  test(`long names wrap: ${viewport.width} px`, async () => {
    const page = await openStudio(browser, FILE, { viewport });
    const name = "Oberflächenbeschaffenheit".repeat(4);
    await keepAs(page, name);
    assert.deepEqual(await tooWide(page), [], "message");
    for (const screen of SCREENS) {
      await goTo(page, screen);
      await page.waitForTimeout(300);
      if (screen === "Mix") await page.getByRole("main").getByRole("combobox").nth(0).selectOption({ label: `${name} (on the pad)` });
      assert.deepEqual(await tooWide(page), [], screen);
    }
    // The whole name is legible on its card.
    await goTo(page, "Shelf");
    const shown = await card(page, name).first().evaluate((element) => {
      const [outer, inner] = [element.getBoundingClientRect(), element.querySelector(".name").getBoundingClientRect()];
      return inner.height > 20 && inner.right <= outer.right + 1 && inner.bottom <= outer.bottom + 1;
    });
    assert.ok(shown);
    await closed(page);
  });
}

test("a name that changes the direction of text turns nothing around it", async () => {
  const page = await openStudio(browser, FILE);
  const name = "abc \u202edef\u2067 ghi";
  await goTo(page, "Save");
  await page.getByLabel("Name").click();
  await page.keyboard.press("ControlOrMeta+a");
  await page.keyboard.insertText(name);
  await page.getByRole("button", { name: "Keep on the shelf" }).click();
  await page.getByText(/is on the shelf/).waitFor();
  /** Whether the last letters of an element stand from left to right. */
  const runsRight = (locator) =>
    locator.evaluate((element) => {
      const texts = document.createTreeWalker(element, NodeFilter.SHOW_TEXT);
      let last = null;
      while (texts.nextNode()) if (texts.currentNode.data.trim().length > 3) last = texts.currentNode;
      const left = (at) => {
        const range = document.createRange();
        range.setStart(last, at);
        range.setEnd(last, at + 1);
        return range.getBoundingClientRect().left;
      };
      const from = last.data.trimEnd().length - 4;
      return [1, 2, 3].every((i) => left(from + i) > left(from + i - 1));
    });
  assert.ok(await runsRight(page.locator(".notice-text")), "message");
  assert.ok(await runsRight(page.locator(".piece")), "top");
  await goTo(page, "Vary");
  assert.ok(await runsRight(page.locator(".screen-head p")), "sentence");
  await goTo(page, "Compare");
  await page.locator(".side").first().click();
  await page.locator(".side", { hasText: ", plays" }).waitFor();
  assert.ok(await runsRight(page.locator(".side").first()), "side");
  for (const screen of ["Mix", "Compare"]) {
    await goTo(page, screen);
    const options = await page.locator("main option").allTextContents();
    assert.ok(options.some((text) => text.includes("abc def ghi")) && options.every((text) => !/[\u202a-\u202e\u2066-\u2069]/.test(text)), options.join());
  }
  // The player page shows the name without these characters. The file keeps the name as it was typed.
  await goTo(page, "Save");
  const { bytes } = await saved(page, () => page.getByRole("button", { name: "Save a player page" }).click());
  assert.equal(await page.evaluate(() => htexStudio.present.value.name), name);
  const file = path.join(folder, "player.html");
  await writeFile(file, bytes);
  const player = await openStudio(browser, pathToFileURL(file).href);
  assert.equal(await player.locator("h1 bdi").textContent(), "abc def ghi");
  assert.ok(await runsRight(player.locator("h1")), "player");
  await closed(player);
  await closed(page);
});
