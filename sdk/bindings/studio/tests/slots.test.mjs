// The versions A and B, the strip of the last steps, and the QR code: by mouse, by keys and by touch.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import { createRequire } from "node:module";
import test, { after, before } from "node:test";

import { FILE, bytesOf, closed, frames, goTo, isWhole, launch, openStudio, ready, saved, serve, shaping, sounded, thorough } from "./studio.mjs";

const PHONE = { hasTouch: true, isMobile: true, reducedMotion: "reduce", userAgent: "Mozilla/5.0 (Linux; Android 16; Pixel 9) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/156.0.0.0 Mobile Safari/537.36" };
const UPRIGHT = { viewport: { width: 390, height: 844 }, ...PHONE };
const LYING = { viewport: { width: 844, height: 390 }, ...PHONE };

let browser, server, remote;

before(async () => {
  server = await serve();
  const { port } = new URL(server.address);
  // A name that is not of this device. Browsers play sound only at addresses that they trust.
  remote = `http://studio.test:${port}/`;
  const args = ["--no-sandbox", "--disable-gpu", "--disable-background-networking", "--host-resolver-rules=MAP studio.test 127.0.0.1", `--unsafely-treat-insecure-origin-as-secure=http://studio.test:${port}`];
  browser = await launch({ args });
});

after(async () => {
  await browser?.close();
  await server?.close();
});

/** Another tab of the same browser. */
async function openTab(page, address) {
  const context = page.context();
  return openStudio({ newContext: () => context }, address);
}

/** Puts a texture of the shelf on the pad. */
async function load(page, name) {
  await goTo(page, "Shelf");
  const card = page.locator(".card", { has: page.getByText(name, { exact: true }) });
  if (page.viewportSize().width < 900) await card.tap();
  else await card.click();
  await page.waitForFunction((wanted) => htexStudio.present.value.name === wanted, name);
}

const shows = (page, bytes) => page.waitForFunction((wanted) => htexStudio.present.value?.bytes.join() === wanted, [...bytes].join());

/** Draws a bar upwards: one step. */
async function draw(page, across = 0.3, rise = 0.25) {
  await shaping(page);
  const steps = await page.evaluate(() => htexStudio.depth.value);
  const { x, y, width, height } = await page.locator(".spectrum canvas").boundingBox();
  await page.mouse.move(x + across * width, y + 0.5 * height);
  await page.mouse.down();
  for (let i = 1; i < 6; i++) await page.mouse.move(x + across * width, y + (0.5 - (rise * i) / 5) * height);
  await page.mouse.up();
  await page.waitForFunction((count) => htexStudio.depth.value === count, steps + 1);
  await frames(page);
}

const version = (page, name) => page.getByRole("button", { name: `Version ${name}` });
const isOn = async (page, name) => (await version(page, name).getAttribute("aria-pressed")) === "true";
const onPad = (page, name) => page.locator(".slots [aria-pressed=true]", { hasText: name }).waitFor();

/** Waits until an edit, or a step of the history, has changed the texture. */
async function changed(page, act) {
  const before = [...(await bytesOf(page))].join();
  await act();
  await page.waitForFunction((old) => old !== htexStudio.present.value.bytes.join(), before);
  return bytesOf(page);
}

const undo = (page) => changed(page, () => page.getByRole("button", { name: "Undo", exact: true }).first().click());
const redo = (page) => changed(page, () => page.getByRole("button", { name: "Redo", exact: true }).click());

test("B begins as a copy of A, and each version keeps its edits, its undo and its redo", async () => {
  const page = await openStudio(browser, FILE);
  await load(page, "Oak");
  const oak = await bytesOf(page);
  await draw(page, 0.2);
  const a1 = await bytesOf(page);
  await draw(page, 0.4);
  const a2 = await bytesOf(page);
  await undo(page);
  await version(page, "B").click();
  await page.getByText("B is now a copy of A.").waitFor();
  assert.ok(await isOn(page, "B"));
  assert.deepEqual(await bytesOf(page), a1);
  await draw(page, 0.6);
  const b2 = await bytesOf(page);
  assert.notDeepEqual(b2, a1);
  // A has neither the edit of B nor lost its redo.
  await changed(page, () => version(page, "A").click());
  assert.deepEqual(await bytesOf(page), a1);
  assert.deepEqual(await redo(page), a2);
  await page.keyboard.press("x");
  await shows(page, b2);
  assert.ok(await isOn(page, "B"));
  assert.deepEqual(await undo(page), a1);
  assert.deepEqual(await undo(page), oak);
  await page.keyboard.press("x");
  await shows(page, a2);
  await page.keyboard.press("x");
  await shows(page, oak);
  // What was undone in B is still there.
  assert.deepEqual(await redo(page), a1);
  assert.deepEqual(await redo(page), b2);
  // Another texture of the shelf goes to B alone.
  await load(page, "Silk");
  const silk = await bytesOf(page);
  await page.keyboard.press("x");
  await shows(page, a2);
  assert.match(await page.locator(".piece").textContent(), /Oak/);
  await page.keyboard.press("x");
  await shows(page, silk);
  await closed(page);
});

test("the key swaps on each screen, and not in a field", async () => {
  const page = await openStudio(browser, FILE);
  await load(page, "Oak");
  await version(page, "B").click();
  await draw(page);
  let expected = "B";
  for (const name of ["Shelf", "Shape", "Mix", "Vary", "Compare", "Record", "Save"]) {
    await goTo(page, name);
    await page.keyboard.press(name === "Mix" ? "Shift+X" : "x");
    expected = expected === "B" ? "A" : "B";
    await onPad(page, expected);
  }
  await page.getByLabel("Name").click();
  await page.keyboard.type("xx");
  await goTo(page, "Shelf");
  await page.getByLabel("Search textures").click();
  await page.keyboard.type("x");
  await goTo(page, "Mix");
  await page.getByRole("main").getByRole("combobox").first().focus();
  await page.keyboard.press("x");
  await page.locator(".pad canvas").focus();
  await page.keyboard.press("Control+x");
  await frames(page);
  await onPad(page, expected);
  // On the pad, and twice at once.
  await page.keyboard.press("x");
  await onPad(page, expected === "B" ? "A" : "B");
  await page.keyboard.press("x");
  await page.keyboard.press("x");
  await frames(page, 20);
  await onPad(page, expected === "B" ? "A" : "B");
  assert.match(await version(page, expected).getAttribute("title"), /\(X\)$/);
  await closed(page);
});

test("a copy is a step of the other version, whose undo leads back", async () => {
  const page = await openStudio(browser, FILE);
  await load(page, "Oak");
  const copy = (to) => page.getByRole("button", { name: `Copy to ${to}` });
  assert.ok(await copy("B").isDisabled());
  await version(page, "B").click();
  await draw(page, 0.3);
  const b = await bytesOf(page);
  await page.keyboard.press("x");
  await draw(page, 0.6);
  const a = await bytesOf(page);
  await copy("B").click();
  await page.getByText("B is now a copy of A.").waitFor();
  assert.deepEqual(await bytesOf(page), a);
  await version(page, "B").click();
  await onPad(page, "B");
  assert.deepEqual(await bytesOf(page), a);
  assert.deepEqual(await undo(page), b);
  await closed(page);
});

/** The page's sound goes through `window.tape`. */
const listen = () => {
  const { connect } = AudioNode.prototype;
  AudioNode.prototype.connect = function (to, ...rest) {
    if (to instanceof AudioDestinationNode) connect.call(this, (window.tape = new AnalyserNode(this.context, { fftSize: 32768 })));
    return connect.call(this, to, ...rest);
  };
};

/** The last 0.7 s: the level of each half in dB, the longest silence in ms, and the largest third difference of samples. Textures have nothing above 1 kHz, so a click stands out. */
const heard = (page) =>
  page.evaluate(() => {
    const samples = new Float32Array(32768);
    window.tape.getFloatTimeDomainData(samples);
    const db = (part) => 10 * Math.log10(part.reduce((sum, x) => sum + x * x, 0) / part.length);
    let [longest, now, jump] = [0, 0, 0];
    for (let i = 3; i < samples.length; i++) {
      longest = Math.max(longest, (now = Math.abs(samples[i]) < 1e-4 ? now + 1 : 0));
      jump = Math.max(jump, Math.abs(samples[i] - 3 * samples[i - 1] + 3 * samples[i - 2] - samples[i - 3]));
    }
    return { before: db(samples.subarray(0, 12000)), after: db(samples.subarray(-12000)), silence: (1e3 * longest) / window.tape.context.sampleRate, jump };
  });

test("swapping leaves no click and no gap, and a change of the level is heard", async () => {
  const page = await openStudio(browser, FILE, { init: listen });
  await load(page, "Oak");
  await version(page, "B").click();
  await shaping(page);
  const level = page.getByRole("slider", { name: "Level" });
  await level.focus();
  await page.keyboard.press("Home");
  const db = await page.evaluate(() => 20 * Math.log10(htexStudio.texture.value.manifest.representations[0].at[0].level_rms));
  await page.getByRole("button", { name: "Steady" }).click();
  await page.mouse.move(3, 3);
  await sounded(page, 1.5);
  const quiet = await heard(page);
  await page.keyboard.press("x");
  await sounded(page, 1.5);
  const loud = await heard(page);
  const louder = (await page.evaluate(() => 20 * Math.log10(htexStudio.texture.value.manifest.representations[0].at[0].level_rms))) - db;
  assert.ok(louder > 10 && Math.abs(loud.after - quiet.after - louder) < 1.5, `${loud.after - quiet.after} dB louder, by ${louder} dB in the files`);
  const most = [];
  for (let i = 0; i < 8; i++) {
    await page.keyboard.press("x");
    await sounded(page, 0.35);
    most.push(await heard(page));
  }
  // The swap is in the middle of what was heard, unless the machine was busy.
  assert.ok(most.filter(({ before, after }) => Math.abs(Math.abs(before - after) - louder) < 3).length >= 4, JSON.stringify(most));
  // Where a sound that is as loud is cut off, the jump is about 0.1. The corners of a fade of 20 ms are a thousandth of that.
  for (const { silence, jump } of most) assert.ok(silence < 4 && jump < 0.002, `${silence} ms of silence, a jump of ${jump}`);
  await closed(page);
});

test("swapping ends what is tried, such as a side on Compare", async () => {
  const page = await openStudio(browser, FILE);
  await load(page, "Oak");
  await version(page, "B").click();
  await draw(page);
  await page.getByRole("button", { name: "Steady" }).click();
  await goTo(page, "Compare");
  await page.locator(".side").nth(1).click();
  await page.locator(".side[aria-pressed=true]").waitFor();
  await page.keyboard.press("x");
  await onPad(page, "A");
  await page.locator(".side[aria-pressed=true]").waitFor({ state: "detached" });
  assert.equal(await page.evaluate(() => htexStudio.finger.value.force > 0), true);
  await closed(page);
});

test("during a blind test, versions and steps are disabled", async () => {
  const page = await openStudio(browser, FILE);
  await load(page, "Oak");
  await version(page, "B").click();
  await draw(page);
  await goTo(page, "Compare");
  await page.getByRole("button", { name: "Begin ten trials" }).click();
  await page.getByRole("button", { name: "X is A" }).waitFor();
  for (const button of [version(page, "A"), version(page, "B"), page.getByRole("button", { name: /^Copy to/ }), page.locator(".step").first()]) assert.ok(await button.isDisabled());
  await page.keyboard.press("x");
  await page.locator(".step").first().hover();
  await page.waitForTimeout(400);
  await page.mouse.move(3, 3);
  await frames(page, 20);
  assert.ok(await isOn(page, "B"));
  // X still plays.
  await page.locator(".side[aria-pressed=true]", { hasText: /^X/ }).waitFor();
  await page.getByRole("button", { name: "Stop the test" }).click();
  await page.keyboard.press("x");
  await onPad(page, "A");
  await closed(page);
});

thorough("both versions are there after a reload, and in each tab", async () => {
  const page = await openStudio(browser, server.address);
  await load(page, "Oak");
  await draw(page, 0.2);
  const a = await bytesOf(page);
  await version(page, "B").click();
  await draw(page, 0.5);
  const b1 = await bytesOf(page);
  await draw(page, 0.7);
  const b2 = await bytesOf(page);
  await undo(page);
  // At once.
  await page.keyboard.press("x");
  await shows(page, a);
  await page.reload();
  await ready(page);
  assert.deepEqual(await bytesOf(page), a);
  assert.ok(await isOn(page, "A"));
  await page.keyboard.press("x");
  await shows(page, b1);
  assert.deepEqual(await redo(page), b2);
  // Another tab shows the same version, and follows.
  const tab = await openTab(page, server.address);
  assert.deepEqual(await bytesOf(tab), b2);
  assert.ok(await isOn(tab, "B"));
  await tab.keyboard.press("x");
  await shows(tab, a);
  await shows(page, a);
  assert.ok(await isOn(page, "A"));
  await draw(tab, 0.8);
  const a2 = await bytesOf(tab);
  await shows(page, a2);
  // One changes A while the other has put B on the pad: nothing is lost.
  await page.bringToFront();
  await page.keyboard.press("x");
  await draw(page, 0.3);
  const b3 = await bytesOf(page);
  await shows(tab, b3);
  await tab.bringToFront();
  await tab.keyboard.press("x");
  await shows(tab, a2);
  await shows(page, a2);
  await page.reload();
  await ready(page);
  assert.deepEqual(await bytesOf(page), a2);
  await page.keyboard.press("x");
  await shows(page, b3);
  assert.deepEqual(await undo(page), b2);
  assert.deepEqual(tab.errors, []);
  await closed(page);
});

thorough("both versions of the texture that the page begins with are stored once one is changed", async () => {
  const page = await openStudio(browser, server.address);
  const a = await bytesOf(page);
  await version(page, "B").click();
  await draw(page);
  const b = await bytesOf(page);
  await page.reload();
  await ready(page);
  assert.deepEqual(await bytesOf(page), b);
  assert.ok(await isOn(page, "B"));
  await page.keyboard.press("x");
  await shows(page, a);
  await closed(page);
});

test("a version that was put on the pad just before the page is closed is there again", async () => {
  let page = await openStudio(browser, server.address);
  const context = page.context();
  await load(page, "Oak");
  const a = await bytesOf(page);
  await version(page, "B").click();
  await draw(page);
  const b = await bytesOf(page);
  await page.waitForTimeout(500);
  await changed(page, () => page.keyboard.press("x"));
  await Promise.all([page.waitForEvent("close"), page.close({ runBeforeUnload: true })]);
  page = await openStudio({ newContext: () => context }, server.address);
  assert.deepEqual(await bytesOf(page), a);
  await page.keyboard.press("x");
  await shows(page, b);
  await closed(page);
});

const steps = (page) => page.locator(".step");
const told = (page) => steps(page).evaluateAll((all) => all.map((one) => one.getAttribute("aria-label")));
const pictures = (page) => page.waitForFunction(() => [...document.querySelectorAll(".step path")].every((path) => path.getAttribute("d")?.length > 100));

test("a step plays while the pointer is on it, and a press goes back there without losing the others", async () => {
  const page = await openStudio(browser, FILE);
  await load(page, "Oak");
  const states = [await bytesOf(page)];
  for (const across of [0.2, 0.4, 0.6]) {
    await draw(page, across);
    states.push(await bytesOf(page));
  }
  await page.waitForFunction(() => document.querySelectorAll(".step").length === 5);
  await pictures(page);
  assert.deepEqual(await told(page), ["Step 1: open Coarse fabric", "Step 2: open Oak", "Step 3: draw bars", "Step 4: draw bars", "Step 5, now: draw bars"]);
  const silent = () => page.waitForFunction(() => htexStudio.finger.value.force === 0);
  // By the mouse. Passing over steps plays nothing.
  const boxes = await Promise.all([0, 1, 2, 3].map((i) => steps(page).nth(i).boundingBox()));
  for (const { x, y } of boxes) await page.mouse.move(x + 20, y + 20);
  await page.mouse.move(3, 3);
  await page.waitForTimeout(400);
  assert.equal(await page.evaluate(() => htexStudio.finger.value.force), 0);
  assert.match(await page.locator(".pad canvas").getAttribute("aria-label"), /Pad of Oak/);
  await steps(page).nth(0).hover();
  await page.waitForFunction(() => Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.02);
  await page.locator(".pad canvas[aria-label^='Pad of Coarse fabric']").waitFor();
  assert.deepEqual(await bytesOf(page), states[3]);
  await page.mouse.move(3, 3);
  await silent();
  await page.locator(".pad canvas[aria-label^='Pad of Oak']").waitFor();
  await steps(page).nth(1).click();
  await shows(page, states[0]);
  await page.getByText("3 steps undone.").waitFor();
  await page.waitForFunction(() => document.querySelector(".step[aria-current]")?.textContent.includes("Oak"));
  assert.deepEqual(await told(page), ["Step 1: open Coarse fabric", "Step 2, now: open Oak", "Step 3, undone: draw bars", "Step 4, undone: draw bars", "Step 5, undone: draw bars"]);
  // What is on the pad sounds, not the step under the pointer.
  await changed(page, () => page.keyboard.press("Control+Shift+z"));
  await page.mouse.move(3, 3);
  await silent();
  assert.deepEqual(await bytesOf(page), states[1]);
  // By keys: Tab leads to the present step, arrows go on.
  await page.getByRole("button", { name: "Last steps" }).focus();
  while (!(await page.evaluate(() => document.activeElement.matches(".step")))) await page.keyboard.press("Tab");
  assert.match(await page.evaluate(() => document.activeElement.getAttribute("aria-label")), /^Step 3, now/);
  await page.keyboard.press("End");
  await page.waitForFunction(() => Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.02);
  await page.keyboard.press("Enter");
  await shows(page, states[3]);
  await page.getByText("2 steps redone.").waitFor();
  await page.keyboard.press("Home");
  await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Enter");
  await shows(page, states[0]);
  await page.keyboard.press("Escape");
  for (const state of states.slice(1)) assert.deepEqual(await redo(page), state);
  await closed(page);
});

/** Counts the textures that are open in the page. */
const counting = () => {
  const { instantiate } = WebAssembly;
  window.textures = { opened: 0, freed: 0 };
  WebAssembly.instantiate = async (...given) => {
    const made = await instantiate.call(WebAssembly, ...given);
    const instance = made.instance ?? made;
    const { htex_asset_from_bytes: opens, htex_asset_free: frees } = instance.exports;
    const exports = { ...instance.exports, htex_asset_from_bytes: (...words) => ((window.textures.opened += 1), opens(...words)), htex_asset_free: (...words) => ((window.textures.freed += 1), frees(...words)) };
    Object.defineProperty(instance, "exports", { value: exports });
    return made;
  };
};

thorough("the strip opens only the steps that it shows, in slices, and frees them", async () => {
  const page = await openStudio(browser, server.address, { init: counting });
  await load(page, "Oak");
  await shaping(page);
  await page.evaluate(() => {
    for (let i = 0; i < 300; i++) htexStudio.moveHandle(i % 30, 0, htexStudio.handles.value[i % 30].db + (i % 7) - 3, `edit ${i}`);
  });
  await page.waitForFunction(() => htexStudio.depth.value === 301);
  await frames(page, 30);
  await page.reload();
  await ready(page);
  // Nothing else that opens textures: the shelf is not shown.
  await goTo(page, "Record");
  await pictures(page);
  await page.waitForTimeout(300);
  const counts = () => page.evaluate(() => ({ ...window.textures, live: window.textures.opened - window.textures.freed }));
  const rest = await counts();
  assert.equal(await steps(page).count(), 12);
  const all = await told(page);
  assert.match(all[0], /^Step 291: /);
  assert.match(all[11], /^Step 302, now: /);
  for (let i = 0; i < 12; i++) {
    await steps(page).nth(i).hover();
    await page.locator(".pad canvas[aria-label^='Pad of Oak']").waitFor();
    await page.waitForTimeout(200);
  }
  const while_ = await counts();
  await page.mouse.move(3, 3);
  await page.waitForTimeout(300);
  const end = await counts();
  assert.ok(while_.live <= rest.live + 1 && end.live === rest.live && end.opened - rest.opened <= 12, JSON.stringify({ rest, while_, end }));
  // A drag opens no texture for the strip until it ends.
  await shaping(page);
  await page.waitForTimeout(500);
  const { x, y, width, height } = await page.locator(".spectrum canvas").boundingBox();
  const made = await page.evaluate(() => {
    window.longest = 0;
    new PerformanceObserver((list) => list.getEntries().forEach(({ duration }) => (window.longest = Math.max(window.longest, duration)))).observe({ type: "longtask" });
    return document.querySelectorAll(".step")[11].getAttribute("aria-label");
  });
  await page.mouse.move(x + 0.3 * width, y + 0.5 * height);
  await page.mouse.down();
  for (let i = 0; i < 20; i++) {
    await page.mouse.move(x + (0.3 + 0.01 * i) * width, y + (0.5 - 0.01 * i) * height);
    await page.waitForTimeout(16);
    assert.equal((await told(page))[11], made);
  }
  await page.mouse.up();
  await page.waitForFunction(() => document.querySelectorAll(".step")[11].getAttribute("aria-label").startsWith("Step 303, now"));
  // Going far back: each press leads further.
  for (const back of [10, 9, 8]) {
    const present = await page.evaluate(() => htexStudio.depth.value);
    await steps(page).nth(0).click();
    await page.waitForFunction((count) => htexStudio.depth.value < count, present);
    await frames(page, 10);
    assert.ok(back && (await steps(page).count()) === 12);
  }
  assert.equal(await page.evaluate(() => htexStudio.depth.value), 303 - 12 + 0 - 2 - 2);
  await closed(page);
});

thorough("in small windows the strip is folded, and a button unfolds it", async () => {
  for (const options of [UPRIGHT, LYING, { viewport: { width: 720, height: 450 } }, { viewport: { width: 1024, height: 700 } }]) {
    const page = await openStudio(browser, FILE, options);
    const { width, height } = options.viewport;
    const press = (locator) => (options.hasTouch ? locator.tap() : locator.click());
    const name = `${width}x${height}`;
    assert.equal(await page.locator(".strip").count(), 0, name);
    const small = async () => page.evaluate(() => [...document.querySelectorAll(".top button")].filter((one) => one.checkVisibility()).map((one) => [one.getAttribute("aria-label"), one.getBoundingClientRect()]).filter(([, box]) => box.right > innerWidth || box.width < 37 || box.height < 37));
    assert.deepEqual(await small(), [], name);
    const button = page.getByRole("button", { name: "Last steps" });
    await press(button);
    await page.locator(".step").first().waitFor();
    assert.equal(await button.getAttribute("aria-expanded"), "true");
    const part = await page.evaluate(() => document.querySelector("main").getBoundingClientRect().height / innerHeight);
    assert.ok(part >= 0.5, `${name}: the screen is ${part} of the height`);
    await press(button);
    await page.locator(".strip").waitFor({ state: "detached" });
    await closed(page);
  }
  const page = await openStudio(browser, FILE);
  await page.locator(".strip").waitFor();
  // A window that is made smaller folds it.
  await page.setViewportSize({ width: 900, height: 700 });
  await page.locator(".strip").waitFor({ state: "detached" });
  await closed(page);
});

for (const [name, options] of [["upright", UPRIGHT], ["lying", LYING]].slice(0, isWhole ? undefined : 1)) {
  test(`by touch, on a phone that is ${name}: versions and steps`, async () => {
    const page = await openStudio(browser, FILE, options);
    await load(page, "Oak");
    const a = await bytesOf(page);
    await version(page, "B").tap();
    await page.getByText("Tap A to switch back.").waitFor();
    await load(page, "Silk");
    const b = await bytesOf(page);
    await changed(page, () => version(page, "A").tap());
    assert.deepEqual(await bytesOf(page), a);
    await changed(page, () => version(page, "B").tap());
    assert.deepEqual(await bytesOf(page), b);
    // The texture that was tapped on the shelf sounds no more.
    await page.waitForFunction(() => htexStudio.finger.value.force === 0, null, { timeout: 6000 });
    await page.getByRole("button", { name: "Last steps" }).tap();
    await page.locator(".step", { hasText: "Oak" }).tap();
    await shows(page, a);
    await page.waitForFunction(() => htexStudio.finger.value.speed > 0 && Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.01);
    await page.waitForFunction(() => htexStudio.finger.value.force === 0, null, { timeout: 6000 });
    assert.doesNotMatch(await page.locator(".top").evaluate((top) => [...top.querySelectorAll("[title]")].map((one) => one.title).join()), /\(X\)|Ctrl|hover/i);
    await closed(page);
  });
}

/** A page that decodes QR codes. */
async function decoder() {
  const page = await (await browser.newContext()).newPage();
  await page.evaluate(await readFile(createRequire(import.meta.url).resolve("jsqr"), "utf8"));
  return page;
}

/** The text of the QR code in a picture, and what part of a frame of so many pixels is white. */
function decoded(page, png, frame = 0) {
  return page.evaluate(async ([text, wide]) => {
    const image = await createImageBitmap(await (await fetch(`data:image/png;base64,${text}`)).blob());
    const { width, height } = image;
    const pen = new OffscreenCanvas(width, height).getContext("2d");
    pen.drawImage(image, 0, 0);
    const { data } = pen.getImageData(0, 0, width, height);
    let [white, all] = [0, 0];
    for (let y = 0; y < height; y++) {
      for (let x = 0; x < width; x++) {
        // Half a pixel at the edge may belong to what is around.
        const depth = Math.min(x, y, width - 1 - x, height - 1 - y);
        if (depth < 1 || depth >= wide) continue;
        all += 1;
        if ([0, 1, 2].every((i) => data[4 * (y * width + x) + i] === 255)) white += 1;
      }
    }
    return { text: jsQR(data, width, height)?.data ?? null, width, white: white / all };
  }, [png.toString("base64"), frame]);
}

const code = (page) => page.getByRole("img", { name: /^QR code of the link to / });

async function showCode(page) {
  await goTo(page, "Save");
  await page.getByRole("button", { name: "Show the code" }).click();
}

for (const colorScheme of isWhole ? ["light", "dark"] : ["dark"]) {
  test(`a QR code leads another browser to the same texture, byte for byte: ${colorScheme}`, async () => {
    const page = await openStudio(browser, remote, { colorScheme });
    await load(page, "Oak");
    await draw(page);
    await showCode(page);
    await code(page).waitFor();
    const bytes = await bytesOf(page);
    const empty = await decoder();
    await code(page).scrollIntoViewIfNeeded();
    const whole = await decoded(empty, await page.screenshot());
    assert.ok(whole.text?.startsWith(`${remote}#t=`), String(whole.text));
    // Around the code, four modules are white, in dark mode as well.
    const [, size] = /viewBox%3D%220%200%20(\d+)/.exec(await code(page).getAttribute("src"));
    const own = await decoded(empty, await code(page).screenshot(), Math.floor((4 * (await code(page).boundingBox()).width) / size));
    assert.deepEqual([own.text, own.white], [whole.text, 1]);
    const asked = server.asked.length;
    const phone = await openStudio(browser, whole.text, UPRIGHT);
    assert.deepEqual(await bytesOf(phone), bytes);
    await phone.getByText("Oak came with the link.").waitFor();
    assert.deepEqual(server.asked.slice(asked).filter((address) => address.includes("t=")), []);
    await closed(phone);
    // The images that are saved have the same code.
    for (const type of ["PNG", "SVG"]) {
      const file = await saved(page, () => page.getByRole("button", { name: `Save as ${type}` }).click());
      assert.equal(file.name, `oak-code.${type.toLowerCase()}`);
      if (type === "SVG") {
        const show = ([text, width]) => document.body.replaceChildren(Object.assign(new Image(width), { src: `data:image/svg+xml,${encodeURIComponent(text)}` }));
        await empty.evaluate(show, [file.bytes.toString(), 6 * size]);
        file.bytes = await empty.locator("img").screenshot();
      }
      assert.equal((await decoded(empty, file.bytes)).text, whole.text, type);
    }
    await empty.context().close();
    await closed(page);
  });
}

thorough("the code follows the texture", async () => {
  const page = await openStudio(browser, remote);
  await load(page, "Oak");
  await showCode(page);
  await code(page).waitFor();
  const first = await code(page).getAttribute("src");
  await page.getByLabel("Name").click();
  await page.keyboard.press("ControlOrMeta+a");
  await page.keyboard.type("Floor");
  await page.getByRole("img", { name: "QR code of the link to Floor" }).waitFor();
  await page.waitForFunction((old) => document.querySelector("img.qr:not(.stale)")?.src !== old, first);
  const empty = await decoder();
  const { text } = await decoded(empty, await code(page).screenshot());
  const bytes = await bytesOf(page);
  assert.deepEqual(Buffer.from(text.split("#t=")[1], "base64url"), bytes);
  await empty.context().close();
  await closed(page);
});

thorough("a page that a phone cannot open asks for another address, which stays", async () => {
  for (const [address, why] of [[FILE, /file on this device/], [server.address, /at 127\.0\.0\.1:\d+, an address that exists only on this device/], [server.address.replace("127.0.0.1", "localhost"), /at localhost:\d+, an address/], [server.address.replace("127.0.0.1", "abc123.localhost"), /at abc123\.localhost:\d+, an address/]]) {
    const page = await openStudio(browser, address);
    await load(page, "Oak");
    await goTo(page, "Save");
    await page.getByText(why).waitFor();
    const show = page.getByRole("button", { name: "Show the code" });
    assert.ok(await show.isDisabled());
    const field = page.getByLabel("The studio's address for the phone");
    for (const wrong of ["file:///home/me/studio.html", "studio.test", "javascript:alert(1)", "http://", "http://localhost:8420/", "https://abc.localhost/", "http://127.0.0.1/"]) {
      await field.fill(wrong);
      await page.keyboard.press("Tab");
      await page.locator(".problem").waitFor();
      assert.ok(await show.isDisabled(), wrong);
    }
    await field.fill(remote);
    await page.keyboard.press("Tab");
    // An address without https is taken, with a warning.
    await page.locator(".problem", { hasText: "Over http, the phone shows an error." }).waitFor();
    await field.fill("https://studio.test/");
    await page.keyboard.press("Tab");
    await page.locator(".problem").waitFor({ state: "detached" });
    await field.fill(remote);
    await page.keyboard.press("Tab");
    await show.click();
    await code(page).waitFor();
    const empty = await decoder();
    const { text } = await decoded(empty, await code(page).screenshot());
    assert.ok(text.startsWith(`${remote}#t=`), text);
    const phone = await openStudio(browser, text);
    assert.deepEqual(await bytesOf(phone), await bytesOf(page));
    await closed(phone);
    await empty.context().close();
    await page.reload();
    await ready(page);
    await goTo(page, "Save");
    assert.equal(await page.getByLabel("The studio's address for the phone").inputValue(), remote);
    await closed(page);
  }
  // An address that a phone can open needs no other.
  const page = await openStudio(browser, remote);
  await goTo(page, "Save");
  assert.equal(await page.getByLabel("The studio's address for the phone").count(), 0);
  await closed(page);
});

test("a texture that is too large for a code says so, and offers the link and the file", async () => {
  const page = await openStudio(browser, remote, { permissions: ["clipboard-read", "clipboard-write"] });
  await load(page, "Corrugated paper");
  await showCode(page);
  const bytes = await bytesOf(page);
  await page.getByRole("main").getByText(`It has ${bytes.length.toLocaleString("en")} bytes`).waitFor();
  assert.equal(await code(page).count(), 0);
  await page.getByRole("button", { name: "Copy the phone's link" }).click();
  await page.getByText("The link for the phone is copied.").waitFor();
  const link = await page.evaluate(() => navigator.clipboard.readText());
  assert.ok(link.startsWith(`${remote}#t=`) && link.length > 2953);
  const { name, bytes: file } = await saved(page, () => page.getByRole("button", { name: "Save the file" }).click());
  assert.equal(name, "corrugated-paper.htex");
  assert.deepEqual(file, bytes);
  await closed(page);
});
