// The first minute, the knobs, locks and range of the curve, typing at a handle, marks of sliders, and the page of a player; by mouse, by
// keys alone and by touch.

import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { FILE, SCREENS, assertAccessible, browser, bytesOf, closed, folder, frames, goTo, htex, isWhole, openStudio, prepare, ready, saved, server, shaping, swipe, thorough } from "./studio.mjs";

const PHONE = { hasTouch: true, isMobile: true, userAgent: "Mozilla/5.0 (Linux; Android 16; Pixel 9) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/156.0.0.0 Mobile Safari/537.36" };
const UPRIGHT = { viewport: { width: 390, height: 844 }, ...PHONE };
const LYING = { viewport: { width: 844, height: 390 }, ...PHONE };
const ALL_WINDOWS = [{ viewport: { width: 640, height: 400 } }, UPRIGHT, LYING, { viewport: { width: 720, height: 450 } }, { viewport: { width: 1024, height: 700 } }, { viewport: { width: 1400, height: 900 } }];
const WINDOWS = ALL_WINDOWS.slice(0, isWhole ? undefined : 2);
const NAMES = ["Rougher", "Brighter", "Peak", "Level"];

prepare();

const knob = (page, name) => page.getByRole("slider", { name, exact: true });

const valueOf = (page, name) => knob(page, name).evaluate((one) => Number(one.ariaValueNow));

/** Drags from the middle of an element. */
async function drag(page, element, [dx, dy], { shift = false, steps = 8 } = {}) {
  const { x, y, width, height } = await element.boundingBox();
  const [left, top] = [x + width / 2, y + height / 2];
  await page.mouse.move(left, top);
  if (shift) await page.keyboard.down("Shift");
  await page.mouse.down();
  await page.mouse.move(left + dx, top + dy, { steps });
  await page.mouse.up();
  if (shift) await page.keyboard.up("Shift");
  await frames(page);
}

async function take(page, name) {
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: new RegExp(`^${name}`) }).click();
  await page.waitForFunction((wanted) => htexStudio.texture.value.name === wanted, name);
  await page.mouse.move(2, 2);
}

/** Decibels of a texture's file at frequencies, in the page's own words of its spectrum. */
const decibels = (page, hz) => page.evaluate((all) => Array.from(htexStudio.texture.value.spectrum(all, { model: htexStudio.present.value.model }), (x) => 20 * Math.log10(x)), hz);

const levels = (page) => page.evaluate(() => htexStudio.handles.value.map(({ hz, db }) => ({ hz, db })));

const depth = (page) => page.evaluate(() => htexStudio.depth.value);

/** That a saved file is valid, has its name, and is rougher than the texture was: it has more below 100 Hz against 400 Hz. */
async function assertRougher(page, { name, bytes }, [low, high]) {
  assert.equal(name, "my-rough-one.htex");
  const file = path.join(folder, name);
  await writeFile(file, bytes);
  htex("validate", file);
  assert.match(htex("info", file), /My rough one/);
  assert.ok((await bytesOf(page)).equals(bytes));
  const [lower, higher] = await decibels(page, [45, 400]);
  assert.ok(lower - higher > low - high + 4, `${lower - higher} dB, ${low - high} dB before`);
}

/** Waits until something is heard. */
const isHeard = (page) => page.waitForFunction(() => Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.01);

thorough("make this rougher and keep it: by mouse", async () => {
  const page = await openStudio(browser, FILE);
  const first = await decibels(page, [45, 400]);
  await page.getByText("Drag a knob up or down").waitFor();
  const { x, y, width, height } = await knob(page, "Rougher").boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2, y + height / 2 - 90, { steps: 12 });
  // The change is heard while the knob is turned.
  await isHeard(page);
  await page.mouse.up();
  await page.getByRole("slider", { name: "Rougher", exact: true }).and(page.locator("[aria-valuetext='much rougher']")).waitFor();
  assert.equal(await depth(page), 1);
  await page.getByRole("button", { name: "Save it" }).click();
  await page.getByLabel("Name").fill("My rough one");
  await assertRougher(page, await saved(page, () => page.getByRole("button", { name: "Save .htex" }).click()), first);
  // Nobody slides any more.
  await page.waitForFunction(() => htexStudio.finger.value.force === 0);
  await closed(page);
});

/** Presses Tab until what has a name has the focus; returns how often. */
async function tabTo(page, name, { key = "Tab" } = {}) {
  for (let i = 0; i < 80; i++) {
    await page.keyboard.press(key);
    const focused = await page.evaluate(() => document.activeElement.getAttribute("aria-label") ?? document.activeElement.labels?.[0]?.textContent ?? document.activeElement.textContent);
    if (focused.trim() === name) return i + 1;
  }
  return assert.fail(`${name} is not reached by Tab`);
}

test("make this rougher and keep it: by keys alone", async () => {
  const page = await openStudio(browser, FILE);
  const first = await decibels(page, [45, 400]);
  await page.keyboard.press("Tab");
  await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  // Only the hint is between the pad and the knobs.
  assert.ok((await tabTo(page, "Rougher")) <= 3);
  for (let i = 0; i < 14; i++) await page.keyboard.press("ArrowUp");
  await isHeard(page);
  assert.ok(Math.abs((await valueOf(page, "Rougher")) - 0.7) < 1e-6);
  assert.ok((await tabTo(page, "Save it…", { key: "Shift+Tab" })) <= 2);
  await page.keyboard.press("Enter");
  await page.getByRole("heading", { name: "Save" }).waitFor();
  await page.waitForFunction(() => document.activeElement.textContent.trim() === "Save .htex");
  await tabTo(page, "Name", { key: "Shift+Tab" });
  await page.keyboard.press("ControlOrMeta+a");
  await page.keyboard.type("My rough one");
  await tabTo(page, "Save .htex");
  await page.locator(".piece", { hasText: "edited" }).waitFor();
  await assertRougher(page, await saved(page, () => page.keyboard.press("Enter")), first);
  await page.locator(".piece", { hasText: "edited" }).waitFor({ state: "detached" });
  await closed(page);
});

test("make this rougher and keep it: by touch", async () => {
  const page = await openStudio(browser, FILE, UPRIGHT);
  const first = await decibels(page, [45, 400]);
  await page.getByText("Drag a knob up or down").waitFor();
  const { x, y, width, height } = await knob(page, "Rougher").boundingBox();
  await swipe(page, [x + width / 2, y + height / 2], [x + width / 2, y + height / 2 - 90]);
  await isHeard(page);
  await page.waitForFunction(() => htexStudio.depth.value === 1);
  await page.getByRole("button", { name: "Save it" }).tap();
  await page.getByLabel("Name").fill("My rough one");
  // It is seen without scrolling.
  const save = page.getByRole("button", { name: "Save .htex" });
  const main = await page.locator("main").boundingBox();
  const box = await save.boundingBox();
  assert.ok(box.y >= main.y && box.y + box.height <= main.y + main.height, JSON.stringify([box, main]));
  await assertRougher(page, await saved(page, () => save.tap()), first);
  await closed(page);
});

const picture = (page) => page.locator(".pad canvas").evaluate((canvas) => canvas.toDataURL());

/** Whether the picture on the pad moves. */
async function isAlive(page) {
  const before = await picture(page);
  await frames(page, 30);
  return (await picture(page)) !== before;
}

/** Waits until the grain is painted. */
const painted = (page) => page.waitForFunction(() => {
  const canvas = document.querySelector(".pad canvas");
  return canvas.getContext("2d").getImageData(5, 5, 1, 1).data[3] > 0;
});

test("a ghost slides silently on a first visit, until the first press; it changes nothing", async () => {
  const page = await openStudio(browser, server.address);
  await painted(page);
  assert.equal(await isAlive(page), true);
  const state = await page.evaluate(() => ({ sound: htexStudio.audioContext().state, force: htexStudio.finger.value.force, loud: Math.max(...htexStudio.heard(new Float32Array(1024)).map(Math.abs)), depth: htexStudio.depth.value }));
  assert.deepEqual(state, { sound: "suspended", force: 0, loud: 0, depth: 0 });
  const words = page.locator(".first-words");
  assert.equal((await words.innerText()).replaceAll(/\s+/g, " ").trim(), "Touch. Change. Keep.");
  // A press brings sound, and the ghost goes.
  const pad = await page.locator(".pad canvas").boundingBox();
  await page.mouse.move(pad.x + 60, pad.y + 60);
  await page.mouse.down();
  await page.mouse.move(pad.x + 160, pad.y + 100, { steps: 20 });
  await isHeard(page);
  await page.mouse.up();
  await words.locator(".done", { hasText: "Touch." }).waitFor();
  await page.waitForFunction(() => htexStudio.finger.value.force === 0);
  await frames(page);
  assert.equal(await isAlive(page), false);
  // Not on the second visit.
  await page.reload();
  await ready(page);
  await painted(page);
  assert.equal(await isAlive(page), false);
  await closed(page);
});

thorough("there is no ghost if less motion is wanted, and it stops by itself", async () => {
  const calm = await openStudio(browser, FILE, { reducedMotion: "reduce" });
  await painted(calm);
  assert.equal(await isAlive(calm), false);
  await calm.locator(".first-words").waitFor();
  await closed(calm);
  const page = await openStudio(browser, FILE);
  await painted(page);
  await page.waitForTimeout(15_000);
  assert.equal(await isAlive(page), false);
  await closed(page);
});

thorough("each hint is closed when it was done or dismissed, and does not come again", async () => {
  const page = await openStudio(browser, server.address);
  const [onKnobs, onSave] = [page.getByText("Drag a knob up or down"), page.getByText("Do you like it?")];
  await onKnobs.waitFor();
  assert.equal(await onSave.count(), 0);
  await page.reload();
  await ready(page);
  await onKnobs.waitFor();
  await page.getByRole("button", { name: "Close this hint" }).click();
  await onKnobs.waitFor({ state: "detached" });
  await page.reload();
  await ready(page);
  await page.locator(".first-words .done", { hasText: "Change." }).waitFor();
  assert.equal(await onKnobs.count(), 0);
  await drag(page, knob(page, "Brighter"), [30, 0]);
  await onSave.waitFor();
  await goTo(page, "Save");
  assert.equal(await onSave.count(), 0);
  await page.getByRole("button", { name: "Keep on the shelf" }).click();
  await page.getByText(/is on the shelf, on this device/).waitFor();
  await goTo(page, "Shelf");
  assert.equal(await onSave.count(), 0);
  // Who turns a knob hears it, so all three words are done, and gone.
  assert.equal(await page.locator(".first-words").count(), 0);
  await page.reload();
  await ready(page);
  await drag(page, knob(page, "Brighter"), [30, 0]);
  await page.waitForFunction(() => htexStudio.depth.value === 2);
  assert.equal(await onSave.count(), 0);
  // In another profile, turning closes the hint.
  const other = await openStudio(browser, FILE);
  await other.getByText("Drag a knob up or down").waitFor();
  await drag(other, knob(other, "Peak"), [0, -30]);
  await other.getByText("Drag a knob up or down").waitFor({ state: "detached" });
  await closed(other);
  await closed(page);
});

thorough("in a small window, a message comes before a hint", async () => {
  const page = await openStudio(browser, FILE, { viewport: { width: 720, height: 450 } });
  await page.getByRole("button", { name: /^Corduroy/ }).click();
  await page.getByText("Corduroy is on the pad").waitFor();
  await page.getByText("Drag a knob up or down").waitFor({ state: "hidden" });
  await page.getByText("Drag a knob up or down").waitFor();
  await closed(page);
});

test("a knob is turned by mouse, wheel and keys; Shift makes fine steps, and each gesture is one step", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  const opened = await bytesOf(page);
  const begun = await depth(page);
  const rougher = knob(page, "Rougher");
  const value = () => valueOf(page, "Rougher");
  await drag(page, rougher, [0, -60]);
  await page.waitForFunction((steps) => htexStudio.depth.value === steps, begun + 1);
  assert.ok(Math.abs((await value()) - 0.5) < 0.02, `${await value()}`);
  await drag(page, rougher, [30, 30]);
  assert.ok(Math.abs((await value()) - 0.5) < 0.02, "across and back is nothing");
  await drag(page, rougher, [0, 60], { shift: true });
  assert.ok(Math.abs((await value()) - 0.4) < 0.02, `${await value()} after a fine drag`);
  // Double-click resets.
  await rougher.dblclick();
  assert.equal(await value(), 0);
  const before = await depth(page);
  for (let i = 0; i < 3; i++) await page.mouse.wheel(0, -120);
  await page.waitForFunction(() => Math.abs(Number(document.querySelector(".knob").ariaValueNow) - 0.15) < 1e-6);
  await page.keyboard.down("Shift");
  await page.mouse.wheel(0, -120);
  await page.keyboard.up("Shift");
  await page.waitForFunction(() => Math.abs(Number(document.querySelector(".knob").ariaValueNow) - 0.16) < 1e-6);
  assert.equal(await depth(page), before + 1);
  assert.equal(await page.evaluate(() => scrollY), 0);
  await page.waitForTimeout(600);
  await rougher.focus();
  for (const [keys, wanted] of [
    [["Home"], -1],
    [["End"], 1],
    [["PageDown"], 0.75],
    [["ArrowDown", "ArrowLeft"], 0.65],
    [["Shift+ArrowUp", "Shift+ArrowRight"], 0.67],
    [["PageUp"], 0.92],
    [["Delete"], 0],
    [["ArrowUp"], 0.05],
    [["Backspace"], 0],
  ]) {
    for (const key of keys) await page.keyboard.press(key);
    assert.ok(Math.abs((await value()) - wanted) < 1e-6, `${keys}: ${await value()}`);
  }
  // A key that is held is one step.
  const steps = await depth(page);
  await page.keyboard.down("ArrowUp");
  for (let i = 0; i < 5; i++) await page.keyboard.down("ArrowUp");
  await page.keyboard.up("ArrowUp");
  assert.equal(await depth(page), steps + 1);
  assert.equal(await rougher.getAttribute("aria-valuetext"), "a little rougher");
  // Undo leads back to the first bytes.
  while ((await depth(page)) > begun) {
    const now = await depth(page);
    await page.keyboard.press("Control+z");
    await page.waitForFunction((old) => htexStudio.depth.value < old, now);
  }
  assert.ok((await bytesOf(page)).equals(opened));
  assert.equal(await value(), 0);
  await closed(page);
});

thorough("each knob changes what its words say, on every screen", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  const at = [45, 160, 640];
  for (const [i, screen] of SCREENS.entries()) {
    await goTo(page, screen);
    const [name, changes] = [
      ["Rougher", ([low, , high]) => low - high > 2],
      ["Brighter", ([low, , high]) => high - low > 2],
      ["Peak", ([, , high]) => high > 0.5],
      ["Level", (all) => all.every((db) => db > 2)],
    ][i % 4];
    const before = await decibels(page, at);
    await drag(page, knob(page, name), [0, -50]);
    await page.waitForFunction((wanted) => Number(document.querySelector(`.knob[aria-label=${wanted}]`).ariaValueNow) > 0.3, name);
    const after = await decibels(page, at);
    const gains = after.map((db, k) => db - before[k]);
    assert.ok(changes(gains), `${screen}, ${name}: ${gains}`);
  }
  await closed(page);
});

test("a measured curve keeps its model for Level, and is redrawn for the other knobs", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Vinyl");
  await shaping(page);
  await page.getByRole("button", { name: "measured AR" }).click();
  const summary = page.locator(".drawer summary");
  const first = await decibels(page, [45, 400]);
  await drag(page, knob(page, "Level"), [0, -50]);
  await summary.getByText("measured (AR)").waitFor();
  const louder = await decibels(page, [45, 400]);
  assert.ok(louder.every((db, i) => db > first[i] + 3), `${first} and ${louder}`);
  await drag(page, knob(page, "Rougher"), [0, -50]);
  await summary.getByText("free curve (Bands)").waitFor();
  const rougher = await decibels(page, [45, 400]);
  assert.ok(rougher[0] - rougher[1] > louder[0] - louder[1] + 2, `${louder} and ${rougher}`);
  assert.ok(rougher[0] > first[0] + 3, "the level has stayed");
  await closed(page);
});

test("the knobs are there before the module that makes textures", async () => {
  const page = await openStudio(browser, server.address);
  assert.equal(await page.evaluate(() => htexStudio.author.value), null);
  await drag(page, knob(page, "Level"), [0, -60]);
  await page.waitForFunction(() => htexStudio.depth.value === 1);
  assert.ok(Math.abs((await valueOf(page, "Level")) - 0.5) < 0.02);
  await closed(page);
});

test("Compare plays the side that a knob changes, and a blind test cannot be changed by knobs", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  await goTo(page, "Compare");
  await page.getByRole("button", { name: /^A / }).click();
  await drag(page, knob(page, "Level"), [0, 60]);
  await page.getByRole("button", { name: /^A .*, plays$/ }).waitFor();
  await page.getByText(/A difference is felt/).waitFor();
  await page.getByRole("button", { name: "Begin ten trials" }).click();
  await page.getByRole("button", { name: "X is A" }).waitFor();
  assert.equal(await knob(page, "Level").getAttribute("aria-disabled"), "true");
  const bytes = await bytesOf(page);
  await drag(page, knob(page, "Level"), [0, -60]);
  assert.ok((await bytesOf(page)).equals(bytes));
  assert.equal(await page.locator(".slider-mark").count(), 0);
  await closed(page);
});

thorough("Vary makes nine others once a turn is over, not during it", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  await goTo(page, "Vary");
  const first = page.locator(".nine .sparkline path").first();
  await first.waitFor();
  const before = await first.getAttribute("d");
  const { x, y, width, height } = await knob(page, "Brighter").boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  await page.mouse.move(x + width / 2, y + height / 2 - 60, { steps: 10 });
  await page.waitForFunction(() => Number(document.querySelector(".knob[aria-label=Brighter]").ariaValueNow) > 0.4);
  await frames(page);
  assert.equal(await first.getAttribute("d"), before);
  await page.mouse.up();
  await page.waitForFunction((old) => document.querySelector(".nine .sparkline path").getAttribute("d") !== old, before);
  await closed(page);
});

for (const window of WINDOWS) {
  const { width, height } = window.viewport;
  test(`${width}x${height}: the knobs are seen on every screen, 44 px wide and high, and half of the height stays the screen's`, async () => {
    const page = await openStudio(browser, FILE, { reducedMotion: "reduce", ...window });
    for (const screen of SCREENS) {
      await goTo(page, screen);
      const main = await page.locator("main").boundingBox();
      assert.ok(main.height >= height / 2, `${screen}: ${main.height} px`);
      for (const name of NAMES) {
        const box = await knob(page, name).boundingBox();
        assert.ok(box.width >= 43.5 && box.height >= 43.5, `${screen}, ${name}: ${JSON.stringify(box)}`);
        assert.ok(box.x >= 0 && box.y >= 0 && box.x + box.width <= width + 0.5 && box.y + box.height <= height + 0.5, `${screen}, ${name}: ${JSON.stringify(box)}`);
        const isOnTop = await knob(page, name).evaluate((one) => {
          const { x, y, width: w, height: h } = one.getBoundingClientRect();
          return one.contains(document.elementFromPoint(x + w / 2, y + h / 2));
        });
        assert.ok(isOnTop, `${screen}: something covers ${name}`);
      }
      const pad = await page.locator(".pad canvas").boundingBox();
      assert.ok(pad.height >= 90 && pad.y + pad.height <= height, `${screen}: ${JSON.stringify(pad)}`);
    }
    await closed(page);
  });
}

/** Goes to a handle of the curve by keys. */
async function chooseHandle(page, index) {
  await page.getByRole("slider", { name: /^Spectrum of/ }).focus();
  for (let i = 0; i < 40; i++) await page.keyboard.press("ArrowLeft");
  for (let i = 0; i < index; i++) await page.keyboard.press("ArrowRight");
}

for (const [name, index, turned] of [["Oak", 6, "Rougher"], ["Cork", 1, "Brighter"], ["Corduroy", 0, "Brighter"], ["Cork", 0, "Brighter"], ["Felt", 1, "Rougher"]].slice(0, isWhole ? undefined : 2)) {
  test(`a locked handle of ${name} stays where it is: ${index}`, async () => {
    const page = await openStudio(browser, FILE);
    await take(page, name);
    await shaping(page);
    await chooseHandle(page, index);
    const before = await levels(page);
    await page.keyboard.press("l");
    assert.equal(await page.getByRole("button", { name: /^Lock / }).getAttribute("aria-pressed"), "true");
    const isAtRest = async (what) => {
      const now = (await levels(page))[index];
      assert.ok(Math.abs(now.db - before[index].db) < 0.15 && Math.abs(now.hz / before[index].hz - 1) < 0.003, `${what}: ${JSON.stringify([before[index], now])}`);
    };
    for (const way of [-60, -25]) {
      await drag(page, knob(page, turned), [0, way]);
      await isAtRest(`${turned} by ${way}`);
    }
    const after = await levels(page);
    assert.ok(after.some(({ db }, i) => Math.abs(db - before[i].db) > 0.4), "nothing else has moved");
    // Nor do keys and the hand move it.
    const bytes = await bytesOf(page);
    await chooseHandle(page, index);
    await page.keyboard.press("ArrowUp");
    await page.getByRole("status").getByText(/is locked/).waitFor();
    assert.ok((await bytesOf(page)).equals(bytes));
    // Nor does the level.
    const level = knob(page, "Level");
    if ((await level.getAttribute("aria-disabled")) !== "true") await drag(page, level, [0, 40]);
    await isAtRest("Level");
    await page.getByRole("button", { name: /^Lock / }).click();
    await drag(page, knob(page, "Level"), [0, -40]);
    const free = (await levels(page))[index];
    assert.ok(free.db - before[index].db > 2, `${free.db} dB once it is free`);
    await closed(page);
  });
}

thorough("locks of peaks stay with their peaks when others are added and removed", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Corduroy");
  await shaping(page);
  await chooseHandle(page, 3);
  await page.keyboard.press("l");
  const { hz } = (await levels(page))[3];
  await page.getByRole("button", { name: "Add a peak" }).click();
  await chooseHandle(page, 1);
  await page.keyboard.press("Delete");
  await page.waitForFunction(() => htexStudio.handles.value.length === 8);
  await chooseHandle(page, 2);
  assert.ok(Math.abs((await levels(page))[2].hz - hz) < 0.5);
  assert.equal(await page.getByRole("button", { name: "Lock peak 3" }).getAttribute("aria-pressed"), "true");
  // Another texture begins without locks.
  await take(page, "Zip");
  await shaping(page);
  assert.equal(await page.getByRole("button", { name: /^Lock / }).getAttribute("aria-pressed"), "false");
  await closed(page);
});

/** Where frequencies are in the window. */
async function axis(page) {
  const box = await page.locator(".spectrum canvas").boundingBox();
  return { at: (hz) => box.x + 44 + ((box.width - 58) * Math.log(hz / 20)) / Math.log(50), y: box.y + box.height - 12, box };
}

async function dragAxis(page, from, to) {
  const { at, y } = await axis(page);
  await page.mouse.move(at(from), y);
  await page.mouse.down();
  await page.mouse.move(at(to), y, { steps: 8 });
  await page.mouse.up();
  await frames(page);
}

/** Which handles have moved since. */
const moved = async (page, before) => (await levels(page)).filter(({ db }, i) => Math.abs(db - before[i].db) > 0.05).map(({ hz }) => hz);

test("a range is dragged along the axis, and limits knobs and drawing to it", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  await shaping(page);
  const before = await levels(page);
  await dragAxis(page, 100, 300);
  const [from, to] = [page.getByRole("spinbutton", { name: "From, Hz" }), page.getByRole("spinbutton", { name: "To, Hz" })];
  assert.ok(Math.abs(Number(await from.inputValue()) - 100) < 6 && Math.abs(Number(await to.inputValue()) - 300) < 12, `${await from.inputValue()} to ${await to.inputValue()}`);
  assert.equal(await depth(page), 1, "to choose a range is no edit");
  for (const name of NAMES) {
    await drag(page, knob(page, name), [0, -50]);
    const all = await moved(page, before);
    assert.ok(all.length > 2 && all.every((hz) => hz > 90 && hz < 320), `${name}: ${all}`);
  }
  // A stroke across the whole chart draws only within the range.
  const { at, box } = await axis(page);
  await page.mouse.move(at(30), box.y + 40);
  await page.mouse.down();
  await page.mouse.move(at(900), box.y + 60, { steps: 30 });
  await page.mouse.up();
  await frames(page);
  const drawn = await moved(page, before);
  assert.ok(drawn.length > 2 && drawn.every((hz) => hz > 90 && hz < 320), `drawn: ${drawn}`);
  // The dock says so on every screen, and ends it.
  await goTo(page, "Shelf");
  const chip = page.getByRole("button", { name: /^Change everything again; now only \d+ to \d+ Hz$/ });
  await chip.click();
  await chip.waitFor({ state: "detached" });
  await drag(page, knob(page, "Level"), [0, 50]);
  assert.equal((await moved(page, before)).length, before.length);
  await closed(page);
});

thorough("a range is typed, moved at its ends, and removed by a double click", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Corduroy");
  await shaping(page);
  const [from, to] = [page.getByRole("spinbutton", { name: "From, Hz" }), page.getByRole("spinbutton", { name: "To, Hz" })];
  await from.fill("80");
  await from.press("Tab");
  await to.fill("200");
  await to.press("Enter");
  const before = await levels(page);
  await drag(page, knob(page, "Peak"), [0, -40]);
  const now = await levels(page);
  now.forEach(({ hz, db }, i) => {
    const isInside = before[i].hz >= 80 && before[i].hz <= 200;
    assert.equal(Math.abs(hz - before[i].hz) > 1, isInside && before[i].hz < 199, `${before[i].hz} to ${hz} Hz`);
    if (!isInside) assert.ok(Math.abs(db - before[i].db) < 0.3, `${before[i].hz} Hz by ${db - before[i].db} dB`);
    else assert.ok(hz <= 200.5, `${hz} Hz`);
  });
  await dragAxis(page, 200, 400);
  assert.ok(Math.abs(Number(await to.inputValue()) - 400) < 20 && (await from.inputValue()) === "80", await to.inputValue());
  const { at, y } = await axis(page);
  await page.mouse.dblclick(at(150), y);
  assert.deepEqual([await from.inputValue(), await to.inputValue()], ["20", "1000"]);
  await closed(page);
});

thorough("a curve that changes only as a whole is redrawn by the first turn within a range", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Cork");
  await shaping(page);
  const at = [40, 60, 400, 700];
  const before = await decibels(page, at);
  await dragAxis(page, 150, 260);
  await page.getByText("This curve changes only as a whole").waitFor();
  await chooseHandle(page, 0);
  await page.keyboard.press("ArrowUp");
  await page.getByRole("status").getByText(/cannot change only a range/).waitFor();
  await drag(page, knob(page, "Level"), [0, -60]);
  await page.locator(".drawer summary", { hasText: "free curve (Bands)" }).waitFor();
  const after = await decibels(page, at);
  after.forEach((db, i) => assert.ok(Math.abs(db - before[i]) < 1.6, `${at[i]} Hz by ${db - before[i]} dB`));
  assert.ok((await decibels(page, [200]))[0] > before[2] + 2);
  await closed(page);
});

thorough("by touch, the ends of the range are dragged, and a swipe on the axis scrolls", async () => {
  const page = await openStudio(browser, FILE, UPRIGHT);
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: /^Oak/ }).tap();
  await shaping(page);
  await frames(page);
  const { at, y } = await axis(page);
  await swipe(page, [at(20) + 4, y], [at(120), y]);
  const from = page.getByRole("spinbutton", { name: "From, Hz" });
  assert.ok(Math.abs(Number(await from.inputValue()) - 120) < 20, await from.inputValue());
  await swipe(page, [at(300), y], [at(300), y - 120]);
  assert.ok((await page.evaluate(() => document.querySelector("main").scrollTop)) > 20);
  await closed(page);
});

test("a value is typed at the handle", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Guitar string");
  await shaping(page);
  await chooseHandle(page, 1);
  const steps = await depth(page);
  await page.keyboard.press("Enter");
  const entry = page.getByRole("form", { name: "Value of Peak 2" });
  await entry.waitFor();
  // The field of decibels has the focus, and what it contains is selected.
  await page.keyboard.type("-31.5");
  await page.keyboard.press("Tab");
  await page.keyboard.press("ControlOrMeta+a");
  await page.keyboard.type("520");
  await page.keyboard.press("Enter");
  await entry.waitFor({ state: "detached" });
  const typed = (await levels(page)).find(({ hz }) => Math.abs(hz - 520) < 1);
  assert.ok(typed && Math.abs(typed.db + 31.5) < 0.2, JSON.stringify(typed));
  assert.equal(await depth(page), steps + 1);
  assert.ok(await page.evaluate(() => document.activeElement.matches(".spectrum canvas")), "the curve has the focus again");
  // Escape leaves it as it was, and does not silence the pad.
  await page.getByRole("button", { name: "Steady" }).click();
  await page.waitForFunction(() => htexStudio.finger.value.force > 0);
  const bytes = await bytesOf(page);
  await page.locator(".spectrum canvas").focus();
  await page.keyboard.press("Enter");
  await page.keyboard.type("-3");
  await page.keyboard.press("Escape");
  await entry.waitFor({ state: "detached" });
  assert.ok((await bytesOf(page)).equals(bytes));
  assert.ok(await page.evaluate(() => htexStudio.finger.value.force > 0));
  // By mouse: the button under the curve.
  await page.getByRole("button", { name: /^Peak \d, \d+ Hz, -?[\d.]+ dB$/ }).click();
  await page.getByRole("form", { name: /^Value of/ }).getByLabel("dB").fill("-20");
  await page.getByRole("button", { name: "Set", exact: true }).click();
  await page.getByRole("button", { name: /^Peak \d, \d+ Hz, -(20|19\.9|20\.1)(\.\d)? dB$/ }).waitFor();
  await closed(page);
});

thorough("Shift makes fine steps on the curve", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Guitar string");
  await shaping(page);
  await chooseHandle(page, 0);
  const db = async () => (await levels(page))[0].db;
  const start = await db();
  await page.keyboard.press("Shift+ArrowDown");
  assert.ok(Math.abs(start - (await db()) - 0.1) < 0.03, `${start - (await db())} dB`);
  await page.keyboard.press("ArrowDown");
  assert.ok(Math.abs(start - (await db()) - 1.1) < 0.06, `${start - (await db())} dB`);
  // Of the chart's decibels, a fine drag goes a fifth of the way.
  const { at, box } = await axis(page);
  const [floor, ceiling] = await page.locator(".spectrum canvas").evaluate((one) => [Number(one.ariaValueMin), Number(one.ariaValueMax)]);
  const perPixel = (ceiling - floor) / (box.height - 40);
  const one = (await levels(page))[0];
  const [x, y] = [at(one.hz), box.y + 10 + (ceiling - one.db) / perPixel];
  await page.mouse.move(x, y);
  await page.keyboard.down("Shift");
  await page.mouse.down();
  await page.mouse.move(x, y + 50, { steps: 10 });
  await page.mouse.up();
  await page.keyboard.up("Shift");
  await frames(page);
  const way = one.db - (await db());
  assert.ok(Math.abs(way - 10 * perPixel) < 1, `${way} dB instead of ${10 * perPixel} dB`);
  await closed(page);
});

test("models are named by what they do, with their names beside, in a drawer", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Vinyl");
  await shaping(page);
  const names = await page.getByRole("group", { name: "Model" }).getByRole("button").allTextContents();
  for (const name of ["free curve Bands", "one hump sSlope", "rise and fall sBeta", "measured AR"]) assert.ok(names.includes(name), `${name}: ${names}`);
  await page.getByRole("button", { name: "one hump" }).click();
  await page.locator(".drawer summary", { hasText: "one hump (sSlope)" }).waitFor();
  await page.locator(".drawer summary").click();
  await page.locator(".spectrum canvas").waitFor({ state: "detached" });
  // The knobs work without it.
  const bytes = await bytesOf(page);
  await drag(page, knob(page, "Rougher"), [0, -40]);
  assert.ok(!(await bytesOf(page)).equals(bytes));
  await page.locator(".drawer summary").click();
  await page.locator(".spectrum canvas").waitFor();
  await take(page, "Corduroy");
  await shaping(page);
  await page.locator(".drawer summary", { hasText: "ridges (sPeak)" }).waitFor();
  await closed(page);
});

test("marks show the recorded range on the sliders of speed and force", async () => {
  const parts = [[40, 0.3], [160, 0.9]].map(([speed, force], i) => {
    const file = path.join(folder, `part-${i}.csv`);
    htex("simulate", "--surface", "vinyl", "--seconds", "4", "--speed", String(speed), "--force", String(force), "-o", file);
    return file;
  });
  const texture = path.join(folder, "several.htex");
  htex("fit", ...parts, "-o", texture, "--name", "Several", "--license", "CC0-1.0", "--model", "bands");
  const page = await openStudio(browser, FILE);
  await page.locator("main input[type=file]").setInputFiles(texture);
  await page.waitForFunction(() => htexStudio.texture.value.name === "Several");
  const at = await page.evaluate(() => htexStudio.texture.value.conditions);
  for (const [name, key, min, max] of [["Speed", "speed", 5, 400], ["Force", "force", 0.05, 3]]) {
    const slider = page.locator(".dock").getByRole("slider", { name, exact: true });
    const [low, high] = [Math.min(...at.map((one) => one[key])), Math.max(...at.map((one) => one[key]))];
    const box = await slider.boundingBox();
    const place = (value) => box.x + 8 + ((box.width - 16) * Math.log(value / min)) / Math.log(max / min);
    const mark = await page.locator(".dock .slider", { hasText: name }).locator(".slider-mark").boundingBox();
    assert.ok(Math.abs(mark.x - place(low)) < 4 && Math.abs(mark.x + mark.width - place(high)) < 4, `${name}: ${JSON.stringify(mark)} for ${place(low)} to ${place(high)}`);
    // The middle of the slider's own knob, at the lower end of the mark.
    await page.mouse.click(mark.x + 2, box.y + box.height / 2);
    assert.match(await slider.getAttribute("aria-valuetext"), /, recorded$/);
    await slider.press("End");
    assert.match(await slider.getAttribute("aria-valuetext"), /above the recorded range$/);
  }
  // A texture of one condition has a mark as wide as a line.
  await take(page, "Zip");
  const { width } = await page.locator(".dock .slider-mark").first().boundingBox();
  assert.ok(width >= 3 && width <= 6, `${width} px`);
  await closed(page);
});

test("Save: the label first, then one large button, the shelf, and ways to share", async () => {
  const page = await openStudio(browser, server.address, { permissions: ["clipboard-read", "clipboard-write"] });
  await goTo(page, "Save");
  const order = await page.evaluate(() => [...document.querySelectorAll("main input, main textarea, main button")].map((one) => one.labels?.[0]?.textContent.trim() ?? one.textContent.trim()));
  const wanted = ["Name", "Licence", "Tags, with commas", "Description", "Author", "Save .htex", "Keep on the shelf", "Copy the link", "Save a player page", "Save as WAV", "Save a microcontroller block"];
  assert.deepEqual(order.filter((name) => wanted.includes(name)), wanted);
  const heights = await Promise.all(["Save .htex", "Keep on the shelf"].map((name) => page.getByRole("button", { name }).boundingBox()));
  assert.ok(heights[0].height >= 1.5 * heights[1].height, JSON.stringify(heights));
  // A page plays it by some lines of HTML. Other languages are in the documentation.
  await page.getByText("In your own web page").click();
  await page.getByRole("button", { name: "Copy", exact: true }).click();
  assert.match(await page.evaluate(() => navigator.clipboard.readText()), /await open\("coarse-fabric\.htex"\)/);
  assert.doesNotMatch(await page.locator("main").innerText(), /htex_voice|numpy|voice\.Render|&htex::/);
  await closed(page);
});

const label = async (page) => {
  await goTo(page, "Save");
  for (const [name, text] of [["Name", "Grandmother's <b>curtain</b>"], ["Licence", "CC-BY-4.0"], ["Author", "A. & B."], ["Description", "Heavy, </script> with a hem."]]) await page.getByLabel(name).fill(text);
  await page.getByLabel("Description").press("Tab");
};

/** Listens to what goes to the loudspeaker, from the beginning on. */
const listen = () => {
  const { connect } = AudioNode.prototype;
  AudioNode.prototype.connect = function (to, ...rest) {
    if (to instanceof AudioDestinationNode) connect.call(this, (window.meter = new AnalyserNode(this.context)));
    return connect.call(this, to, ...rest);
  };
  window.loudest = () => {
    const samples = new Float32Array(2048);
    window.meter.getFloatTimeDomainData(samples);
    return Math.max(...samples.map(Math.abs));
  };
};

/** Saves a player page; returns its address and the texture's bytes. */
async function playerOf(page, name) {
  const { bytes } = await saved(page, () => page.getByRole("button", { name: "Save a player page" }).click());
  const file = path.join(folder, `${name}.html`);
  await writeFile(file, bytes);
  return { address: pathToFileURL(file).href, texture: await bytesOf(page) };
}

test("a player page says what it plays, plays nothing before a press, and is used by keys", async () => {
  const page = await openStudio(browser, server.address);
  await page.getByRole("button", { name: /^Sandpaper/ }).click();
  await page.waitForFunction(() => htexStudio.texture.value.name === "Sandpaper");
  await label(page);
  const { address, texture } = await playerOf(page, "player");
  const player = await openStudio(browser, address, { init: listen });
  assert.equal(await player.title(), "Grandmother's <b>curtain</b>");
  await player.getByRole("heading", { name: "Grandmother's <b>curtain</b>" }).waitFor();
  await player.getByText("By A. & B.. Licence: CC-BY-4.0.").waitFor();
  await player.getByText("Heavy, </script> with a hem.").waitFor();
  // The ghost slides in silence.
  assert.equal(await isAlive(player), true);
  assert.equal(await player.evaluate(() => window.loudest()), 0);
  await player.keyboard.press("Tab");
  assert.ok(await player.evaluate(() => document.activeElement.id === "pad"));
  await player.keyboard.press("Space");
  await player.waitForFunction(() => window.loudest() > 0.02);
  await player.keyboard.press("Escape");
  await player.waitForFunction(() => window.loudest() < 1e-4);
  await player.keyboard.press("5");
  const force = player.getByRole("slider", { name: "Force" });
  assert.match(await force.getAttribute("aria-valuetext"), /^1\.60 N, above the recorded range$/);
  await player.getByText(/harder than recorded/i).waitFor();
  await player.keyboard.press("3");
  await player.keyboard.down("ArrowRight");
  await player.waitForFunction(() => window.loudest() > 0.02);
  await player.keyboard.up("ArrowRight");
  // Back and forth, and the volume.
  await player.getByRole("button", { name: "Back and forth" }).click();
  await player.waitForFunction(() => window.loudest() > 0.02);
  await player.getByRole("slider", { name: "Volume" }).focus();
  await player.keyboard.press("Home");
  await player.waitForFunction(() => window.loudest() < 1e-4);
  await player.keyboard.press("End");
  await player.waitForFunction(() => window.loudest() > 0.02);
  await player.getByRole("button", { name: "Back and forth" }).click();
  // Speeds that were not recorded are told, and the marks show those that were.
  assert.equal(await player.locator(".slider-mark").count(), 2);
  await player.getByRole("slider", { name: "Speed" }).focus();
  await player.keyboard.press("End");
  await player.getByText(/^Faster than recorded/).waitFor();
  // The texture, as a file and in the studio that made the page.
  const file = await saved(player, () => player.getByRole("link", { name: "Save the texture" }).click());
  assert.equal(file.name, "grandmothers-bcurtainb.htex");
  assert.ok(file.bytes.equals(texture));
  const link = await player.getByRole("link", { name: "Open in the studio" }).getAttribute("href");
  assert.ok(link.startsWith(`${server.address}#t=`));
  assert.deepEqual(player.requests, []);
  const other = await openStudio(browser, link);
  assert.ok((await bytesOf(other)).equals(texture));
  await closed(other);
  await closed(player);
  await closed(page);
});

thorough("a player page by mouse, with the model that was chosen; a page from disk names no studio", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Vinyl");
  await shaping(page);
  await page.getByRole("button", { name: "one hump" }).click();
  await goTo(page, "Save");
  const { address } = await playerOf(page, "mouse");
  const player = await openStudio(browser, address, { init: listen });
  assert.equal(await player.getByRole("link", { name: "Open in the studio" }).count(), 0);
  const pad = await player.locator("#pad").boundingBox();
  await player.mouse.move(pad.x + 60, pad.y + 80);
  await player.mouse.down();
  for (let i = 0; i < 60; i++) {
    await player.mouse.move(pad.x + 60 + 4 * i, pad.y + 80);
    await player.waitForTimeout(16);
    if (await player.evaluate(() => window.loudest() > 0.02)) break;
  }
  assert.ok(await player.evaluate(() => window.loudest() > 0.02));
  await player.mouse.up();
  assert.equal(await player.evaluate(() => JSON.parse(document.getElementById("options").textContent).model), "org.htex.sslope");
  await closed(player);
  await closed(page);
});

for (const [name, options] of [["upright, dark", { ...UPRIGHT, colorScheme: "dark" }], ["lying", LYING], ["wide", {}], ["forced colours", { forcedColors: "active" }]].slice(0, isWhole ? undefined : 1)) {
  test(`a player page: ${name}`, async () => {
    const page = await openStudio(browser, FILE);
    await label(page);
    const { address } = await playerOf(page, `player-${name.replaceAll(/\W+/g, "-")}`);
    const player = await openStudio(browser, address, { init: listen, ...options });
    if (options.hasTouch) {
      const small = await player.evaluate(() => [...document.querySelectorAll("button, a.button, input")].map((one) => one.getBoundingClientRect()).filter(({ width, height }) => width < 43.5 || height < 43.5).length);
      assert.equal(small, 0);
      const { width, height } = options.viewport;
      assert.equal(await player.evaluate(() => document.documentElement.scrollWidth), width);
      const pad = await player.locator("#pad").boundingBox();
      assert.ok(pad.y >= 0 && pad.y + pad.height <= height && pad.height >= 200, JSON.stringify(pad));
      assert.doesNotMatch(await player.locator("body").innerText(), /\bkeys?\b|arrow|Esc|hover|click/i);
      await swipe(player, [pad.x + 40, pad.y + 80], [pad.x + 200, pad.y + 100], 30);
      await player.waitForFunction(() => window.meter.context.state === "running");
      await player.getByRole("button", { name: "Back and forth" }).tap();
      await player.waitForFunction(() => window.loudest() > 0.02);
    }
    if (options.colorScheme === "dark") {
      const ground = await player.evaluate(() => getComputedStyle(document.body).backgroundColor);
      assert.ok(ground.match(/\d+/g).every((part) => Number(part) < 60), ground);
    }
    await assertAccessible(player);
    await closed(player);
    await closed(page);
  });
}
