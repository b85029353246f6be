// The studio can be trusted: loudness, pictures and curves come from a condition that sounds, the
// blind test is blind, edits say which models they remove, handles stay on the chart, the autopilot
// raises no alarm, and a change of pitch leaves no gap.

import assert from "node:assert/strict";
import { copyFile, writeFile } from "node:fs/promises";
import path from "node:path";
import test from "node:test";

import { browser, bytesOf, closed, dropPaths, FILE, folder, frames, goTo, htex, isWhole, openStudio, prepare, saved, shaping, sounded, swipe, thorough } from "./studio.mjs";

prepare(async () => {
  await copyFile(new URL("./felt.xml", import.meta.url), path.join(folder, "felt.xml"));
});

/** A model file of the Haptic Texture Toolkit: at each speed and force a resonance. */
async function modelFile(name, nodes) {
  const values = (all) => all.map((x) => `<value>${x}</value>`).join("");
  const resonance = (hz) => [1, -1.9 * Math.cos((2 * Math.PI * hz) / 1000), 0.95 ** 2];
  const models = nodes.map(
    ({ speed, force, power, hz }, i) =>
      `<model><modNum>${i + 1}</modNum><ARcoeff>${values(resonance(hz))}</ARcoeff><MAcoeff>${values([1, 0.3])}</MAcoeff><var>${power}</var><gain>1</gain><speedMod>${speed}</speedMod><forceMod>${force}</forceMod></model>`,
  );
  const units = "<AccelUnits>m/s^2</AccelUnits><SpeedUnits>mm/s</SpeedUnits><ForceUnits>N</ForceUnits><SampleRate>1000</SampleRate>";
  const file = path.join(folder, `${name}.xml`);
  await writeFile(file, `<?xml version="1.0"?>\n<modelSet texture="1"><material>${name}</material>${units}<numMod>${nodes.length}</numMod>${models.join("\n")}</modelSet>`);
  return file;
}

/** Opens a file by the button of the shelf. */
async function open(page, file, name) {
  await goTo(page, "Shelf");
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Open files" }).click()]);
  await chooser.setFiles(file);
  await page.locator(".piece", { hasText: name }).waitFor();
}

async function take(page, name) {
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: new RegExp(`^${name}`) }).click();
  await page.waitForFunction((wanted) => htexStudio.texture.value.name === wanted, name);
}

/** Sets a slider of the pad with the mouse; its scale is logarithmic. */
async function slide(page, label, value, [min, max]) {
  const slider = page.locator(".dock").getByRole("slider", { name: label });
  const { x, y, width, height } = await slider.boundingBox();
  const thumb = height > 20 ? 16 : height;
  await page.mouse.click(x + thumb / 2 + ((width - thumb) * Math.log(value / min)) / Math.log(max / min), y + height / 2);
}
const SPEEDS = [5, 400];

/** Does something with the controls, which small windows show instead of the pad. */
async function withControls(page, act) {
  const button = (name) => page.getByRole("button", { name, exact: true });
  const isSmall = await button("Controls").isVisible();
  if (isSmall) await button("Controls").click();
  await act();
  if (isSmall) await button("Pad").click();
}

/** Mean level of what the autopilot plays, RMS of full scale. */
async function loudness(page) {
  await page.getByRole("button", { name: "Steady" }).click();
  await sounded(page, 0.4);
  let [power, count] = [0, 0];
  for (let i = 0; i < 50; i++) {
    await sounded(page, 0.025);
    power += await page.evaluate(() => htexStudio.heard(new Float32Array(1024)).reduce((sum, sample) => sum + sample ** 2, 0));
    count += 1024;
  }
  const level = Math.sqrt(power / count);
  await page.getByRole("button", { name: "Hand", exact: true }).click();
  return level;
}

/** The picture of the pad once it is another one. The finger has to rest. */
async function grainAfter(page, before) {
  await page.waitForFunction(() => htexStudio.finger.value.force === 0);
  await frames(page);
  const now = await page.waitForFunction((old) => {
    const picture = document.querySelector(".pad canvas").toDataURL();
    return picture !== old && picture;
  }, before);
  return now.jsonValue();
}

const SILENT_FIRST = [
  { speed: 0, force: 0, power: 0, hz: 50 },
  { speed: 20, force: 0.4, power: 0.0001, hz: 50 },
  { speed: 80, force: 0.4, power: 0.01, hz: 300 },
  { speed: 240, force: 3, power: 0.02, hz: 120 },
];

test("loudness, grain and card are of the condition nearest to the sliders, also if the first is silent", async () => {
  // The grain moves with the finger unless less motion is wanted.
  const page = await openStudio(browser, FILE, { reducedMotion: "reduce" });
  while ((await painted(page)) < 1) await frames(page);
  const first = await grainAfter(page, "");
  await open(page, await modelFile("Alone", [SILENT_FIRST[2]]), "Alone");
  const alone = await grainAfter(page, first);
  const usual = await loudness(page);
  await take(page, "Zip");
  await page.mouse.move(3, 3);
  await grainAfter(page, alone);
  await open(page, await modelFile("Several", SILENT_FIRST), "Several");
  await page.waitForFunction((wanted) => document.querySelector(".pad canvas").toDataURL() === wanted, alone);
  await goTo(page, "Shelf");
  const outline = (name) => page.getByRole("button", { name }).locator(".sparkline path").getAttribute("d");
  const drawn = await outline(/^Several/);
  assert.equal(drawn, await outline(/^Alone/));
  const heard = await loudness(page);
  assert.ok(Math.abs(20 * Math.log10(heard / usual)) < 1, `RMS ${heard} instead of ${usual}`);
  // The card and the pad follow the slider.
  await slide(page, "Speed", 20, SPEEDS);
  await grainAfter(page, alone);
  assert.notEqual(await outline(/^Several/), drawn);
  await closed(page);
});

test("on Compare, a side whose condition at the sliders is silent is as loud as at its strongest condition", async () => {
  const page = await openStudio(browser, FILE);
  const [slow, fast] = [{ speed: 20, force: 0.4, power: 0, hz: 50 }, { speed: 240, force: 3, power: 0.02, hz: 120 }];
  await open(page, await modelFile("Quiet", [slow, fast]), "Quiet");
  await slide(page, "Speed", slow.speed, SPEEDS);
  await goTo(page, "Compare");
  await page.locator(".side", { hasText: /^A/ }).click();
  await sounded(page, 0.3);
  const [gain, strongest] = await page.evaluate((at) => [htexStudio.playingNode().gain.value, htexStudio.texture.value.level({ at })], { speed: fast.speed, force: fast.force });
  assert.ok(Math.abs(20 * Math.log10((gain * strongest) / 0.1)) < 0.1, `gain ${gain}, level ${strongest}`);
  await closed(page);
});

test("on Shape, the recorded curve is of the recording nearest to the sliders", async () => {
  const page = await openStudio(browser, FILE);
  const speeds = [30, 200];
  for (const speed of speeds) htex("simulate", "--surface", "fine-fabric", "--seconds", "3", "--speed", String(speed), "--force", "0.4", "-o", path.join(folder, `at-${speed}.csv`));
  await goTo(page, "Record");
  await page.locator("input[type=file]").setInputFiles(speeds.map((speed) => path.join(folder, `at-${speed}.csv`)));
  await page.getByRole("button", { name: "Fit all models" }).click();
  await page.getByRole("button", { name: "To the pad" }).first().click();
  await page.getByText("recording", { exact: true }).waitFor();
  const curves = [];
  for (const speed of speeds) {
    await slide(page, "Speed", speed, SPEEDS);
    const { hz, db } = await page.evaluate(() => htexStudio.reference.value.recorded);
    curves.push(Object.values(hz).map((x, i) => [x, db[i]]));
  }
  // Faster motion is stronger, and its ridges are at higher frequencies.
  const mean = (curve, from, to) => curve.filter(([x]) => x >= from && x < to).reduce((sum, [, db], _, all) => sum + db / all.length, 0);
  assert.ok(mean(curves[1], 300, 1000) > mean(curves[0], 300, 1000) + 3, `${mean(curves[0], 300, 1000)} and ${mean(curves[1], 300, 1000)} dB`);
  await closed(page);
});

test("an imported model file is shown, drawn on and kept at the conditions that sound", async () => {
  const page = await openStudio(browser, FILE);
  await open(page, path.join(folder, "felt.xml"), "Felt");
  await goTo(page, "Shape");
  await page.getByText("displayed at 240 mm/s, 3.00 N").waitFor();
  await page.getByRole("button", { name: "Redraw as a free curve" }).click();
  await page.waitForFunction(() => htexStudio.handles.value.length > 0);
  const db = await page.evaluate(() => htexStudio.handles.value.map((handle) => handle.db));
  assert.ok(db.every((level) => level > -60), String(db));
  // The levels where a finger rests count between the conditions: an edit keeps them.
  const file = path.join(folder, "redrawn.htex");
  await writeFile(file, await bytesOf(page));
  htex("validate", file);
  const { manifest } = JSON.parse(htex("info", file, "--json"));
  const levels = manifest.representations[0].at.map(({ level_rms }) => level_rms);
  assert.ok(levels[0] === 0 && levels[2] > 0.4 && levels[3] > 0.5, String(levels));
  await closed(page);
});

/** X is B, A, B, A and so on: the page draws it from random numbers. */
const alternating = () => {
  let turn = 0;
  crypto.getRandomValues = (array) => array.fill((turn += 1) % 2);
};

/** The accessibility tree in words, without the count of answers. */
async function spoken(page, session) {
  const { nodes } = await session.send("Accessibility.getFullAXTree");
  const told = nodes.filter(({ ignored }) => !ignored).map(({ role, name, value, description, properties = [] }) => [role?.value, name?.value, value?.value, description?.value, ...properties.filter(({ name: own }) => own !== "focused").map((one) => `${one.name} ${one.value.value}`)].join("|"));
  return told.join("\n").replaceAll(/\d+ of 10 answered\./g, "");
}

/** The visible page without the count of answers and, while the finger slides, without the pad. */
function seen(page, isSliding) {
  const mask = [page.getByText(/of 10 answered/), ...(isSliding ? [page.locator(".pad canvas")] : [])];
  return page.screenshot({ mask, animations: "disabled" });
}

/** As `seen`, once the page stands still: a busy machine draws late. */
async function settled(page, isSliding) {
  for (let before = null; ; ) {
    const now = await seen(page, isSliding);
    if (before?.equals(now)) return now;
    before = now;
    await page.waitForTimeout(300);
  }
}

/** The largest difference of two pictures, of 255. The edges of what is drawn again may differ by 1. */
function difference(page, pictures) {
  return page.evaluate(async (texts) => {
    const [a, b] = await Promise.all(texts.map(async (text) => {
      const image = await createImageBitmap(new Blob([Uint8Array.from(atob(text), (one) => one.charCodeAt(0))], { type: "image/png" }));
      const pen = new OffscreenCanvas(image.width, image.height).getContext("2d");
      pen.drawImage(image, 0, 0);
      return pen.getImageData(0, 0, image.width, image.height).data;
    }));
    return a.reduce((most, value, i) => Math.max(most, Math.abs(value - b[i])), 0);
  }, pictures.map((picture) => picture.toString("base64")));
}

/** Part of the pad that is painted. */
const painted = (page) =>
  page.locator(".pad canvas").evaluate((canvas) => {
    const { data } = canvas.getContext("2d").getImageData(0, 0, canvas.width, canvas.height);
    return data.reduce((sum, x, i) => sum + (i % 4 === 3 && x > 0 ? 1 : 0), 0) / (data.length / 4);
  });

async function begin(page, other) {
  await goTo(page, "Compare");
  await page.getByRole("main").getByRole("combobox").nth(1).selectOption({ label: other });
  await page.getByRole("button", { name: "Begin ten trials" }).click();
  await page.getByRole("button", { name: "X is A" }).waitFor();
}

const rowsOf = (csv) => csv.bytes.toString().trim().split("\n").slice(1).map((row) => row.split(","));

const csvOf = (page) => saved(page, () => page.getByRole("button", { name: "Save as CSV" }).click());

for (const [way, options] of [["on a wide screen", {}], ["on a phone", { viewport: { width: 390, height: 844 } }]].slice(0, isWhole ? undefined : 1)) {
  test(`nothing on the page follows X, ${way}`, async () => {
    const page = await openStudio(browser, FILE, { init: alternating, ...options });
    const session = await page.context().newCDPSession(page);
    await take(page, "Sandpaper");
    // Sandpaper was recorded at this speed, and Zip was not. Without matched levels, meters differ.
    await withControls(page, () => slide(page, "Speed", 100, SPEEDS));
    await goTo(page, "Compare");
    await page.getByLabel("Match levels").uncheck();
    await begin(page, "Shelf: Zip");
    await page.locator(".notice-text").waitFor({ state: "detached" });
    const views = [];
    for (let i = 0; i < 10; i++) {
      const isSliding = i % 4 > 1;
      await withControls(page, () => page.getByRole("button", { name: isSliding ? "Steady" : "Hand", exact: true }).click());
      await page.mouse.move(3, 3);
      // Time for all that might follow X: a new grain, and sentences that come late.
      await page.waitForTimeout(900);
      views.push({ isSliding, looks: await settled(page, isSliding), words: await spoken(page, session), part: await painted(page) });
      await page.getByRole("button", { name: "X is A" }).click();
    }
    const x = rowsOf(await csvOf(page)).map((row) => row[1]);
    assert.deepEqual([...new Set(x)].sort(), ["a", "b"]);
    for (const isSliding of [false, true]) {
      const all = views.map((view, i) => ({ ...view, x: x[i] })).filter((view, i) => view.isSliding === isSliding && i > 0);
      assert.equal(new Set(all.map((view) => view.x)).size, 2);
      assert.equal(new Set(all.map((view) => view.words)).size, 1, `what is spoken differs while the finger ${isSliding ? "slides" : "rests"}`);
      for (const { looks } of all) assert.ok((await difference(page, [all[0].looks, looks])) <= 1, `what is seen differs while the finger ${isSliding ? "slides" : "rests"}`);
      for (const { part } of all) assert.ok(part < (isSliding ? 0.4 : 1e-9), `${part} of the pad is painted`);
    }
    await closed(page);
  });
}

test("pair and settings of a blind test stay, and its table names them", async () => {
  const page = await openStudio(browser, FILE, { init: alternating });
  await take(page, "Oak");
  await shaping(page);
  const macro = page.getByRole("slider", { name: "Rougher" });
  await macro.focus();
  for (let i = 0; i < 20; i++) await page.keyboard.press("ArrowRight");
  await page.getByRole("button", { name: "Steady" }).click();
  await begin(page, "As it was opened");
  for (const control of [page.getByLabel("Match levels"), page.getByRole("main").getByRole("combobox").nth(0), page.getByRole("main").getByRole("combobox").nth(1), page.getByRole("button", { name: "Audible" })]) {
    assert.ok(await control.isDisabled(), String(control));
  }
  const gain = async (side) => {
    await page.locator(".side", { hasText: new RegExp(`^${side}`) }).click();
    await sounded(page, 0.3);
    return page.evaluate(() => htexStudio.playingNode().gain.value);
  };
  const before = [await gain("A"), await gain("B")];
  assert.notEqual(before[0], before[1]);
  // Undo takes the edit back under the test, whose sides stay.
  await page.keyboard.press("Control+z");
  await page.getByText(/^Undone/).waitFor();
  await slide(page, "Speed", 30, SPEEDS);
  assert.deepEqual([await gain("A"), await gain("B")], before);
  for (let i = 0; i < 10; i++) await page.getByRole("button", { name: "X is A" }).click();
  const csv = await csvOf(page);
  assert.match(csv.bytes.toString(), /^trial,x,answer,correct,seconds,pitch,a,b,levels_matched\n/);
  for (const row of rowsOf(csv)) assert.deepEqual(row.slice(5), ["1", '"Oak"', '"Oak', ' as it was opened"', "1"]);
  await closed(page);
});

test("a file that is dropped during a blind test does not change the pair", async () => {
  const page = await openStudio(browser, FILE, { init: alternating });
  htex("make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.2", "--at", "speed=80,force=0.5", "--name", "Hum", "-o", path.join(folder, "hum.htex"));
  await begin(page, "Shelf: Zip");
  await page.getByRole("button", { name: "X is A" }).click();
  await dropPaths(page, [path.join(folder, "hum.htex")]);
  await page.locator(".notice", { hasText: "Hum is on the shelf" }).waitFor();
  assert.equal(await painted(page), 0);
  for (let i = 1; i < 10; i++) await page.getByRole("button", { name: "X is A" }).click();
  const names = rowsOf(await csvOf(page)).map((row) => row.slice(-3, -1).join());
  assert.deepEqual(names, Array(10).fill('"Coarse fabric","Zip"'));
  await closed(page);
});

test("a blind test is taken by keys alone", async () => {
  const page = await openStudio(browser, FILE, { init: alternating });
  await goTo(page, "Compare");
  await page.getByRole("main").getByRole("combobox").nth(1).focus();
  await page.keyboard.type("Shelf: Zip");
  const press = async (name) => {
    for (let i = 0; i < 60 && (await page.evaluate(() => document.activeElement.textContent)) !== name; i++) await page.keyboard.press("Tab");
    await page.keyboard.press("Enter");
  };
  await press("Begin ten trials");
  for (let i = 1; i <= 10; i++) {
    await press("X is A");
    await page.getByRole("main").getByText(i < 10 ? `${i} of 10 answered.` : "5 of 10 right").waitFor();
  }
  const [csv] = await Promise.all([page.waitForEvent("download"), press("Save as CSV")]);
  assert.equal(csv.suggestedFilename(), "abx.csv");
  await closed(page);
});

test("a blind test is taken by touch", async () => {
  const page = await openStudio(browser, FILE, { init: alternating, hasTouch: true, isMobile: true, viewport: { width: 390, height: 844 } });
  await page.getByRole("navigation").getByRole("button", { name: "Compare" }).tap();
  await page.getByRole("main").getByRole("combobox").nth(1).selectOption({ label: "Shelf: Zip" });
  const tap = (name) => page.getByRole("button", { name }).tap();
  await tap("Begin ten trials");
  for (let i = 0; i < 10; i++) {
    await tap(/^X the unknown one/);
    const pad = await page.locator(".pad canvas").boundingBox();
    await swipe(page, [pad.x + 20, pad.y + 40], [pad.x + pad.width - 20, pad.y + 40], 6);
    assert.equal(await painted(page), 0);
    await tap("X is A");
  }
  await page.getByRole("main").getByText("5 of 10 right").waitFor();
  await closed(page);
});

test("results stand only under their pair, and the table names the pair that was tested", async () => {
  const page = await openStudio(browser, FILE, { init: alternating });
  await begin(page, "Shelf: Zip");
  for (let i = 0; i < 3; i++) await page.getByRole("button", { name: "X is A" }).click();
  await page.getByRole("main").getByText("3 of 10 answered.").waitFor();
  await page.getByRole("button", { name: "Stop the test" }).click();
  await page.getByRole("main").getByText(/of 10 answered/).waitFor({ state: "detached" });
  await begin(page, "Shelf: Zip");
  for (let i = 0; i < 10; i++) await page.getByRole("button", { name: "X is A" }).click();
  const told = page.getByRole("main").getByText("5 of 10 right");
  await told.waitFor();
  const other = page.getByRole("main").getByRole("combobox").nth(1);
  await other.selectOption({ label: "Shelf: Silk" });
  await told.waitFor({ state: "detached" });
  const names = rowsOf(await csvOf(page)).map((row) => row.slice(-3, -1).join());
  assert.deepEqual([...new Set(names)], ['"Coarse fabric","Zip"']);
  await other.selectOption({ label: "Shelf: Zip" });
  await told.waitFor();
  await page.getByLabel("Match levels").uncheck();
  await told.waitFor({ state: "detached" });
  await closed(page);
});

test("ten wrong answers tell the sides apart, and five right ones do not", async () => {
  const page = await openStudio(browser, FILE, { init: alternating });
  await begin(page, "Shelf: Zip");
  for (let i = 0; i < 10; i++) await page.getByRole("button", { name: i % 2 === 0 ? "X is A" : "X is B" }).click();
  const told = page.getByRole("main");
  await told.getByText("0 of 10 right, p = 0.002").waitFor();
  await told.getByText(/You can tell them apart, but you take A for B/).waitFor();
  await told.getByText(/two-sided binomial test/).waitFor();
  await begin(page, "Shelf: Zip");
  for (let i = 0; i < 10; i++) await page.getByRole("button", { name: "X is A" }).click();
  await told.getByText("5 of 10 right, p = 1.000").waitFor();
  await told.getByText(/Nothing shows that you can tell them apart/).waitFor();
  await closed(page);
});

test("an edit says that it drops the other models, before and after", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Vinyl");
  await shaping(page);
  const count = await page.evaluate(() => htexStudio.texture.value.models.length);
  const warning = page.getByText(`This texture has ${count} models.`);
  await warning.waitFor();
  const chart = await page.locator(".spectrum canvas").boundingBox();
  await page.mouse.move(chart.x + chart.width / 2, chart.y + chart.height / 2);
  await page.mouse.down();
  await page.mouse.move(chart.x + chart.width / 2, chart.y + chart.height / 3, { steps: 4 });
  await page.mouse.up();
  await page.getByRole("status").getByText(/now has one model/).waitFor();
  await warning.waitFor({ state: "detached" });
  await page.keyboard.press("Control+z");
  await warning.waitFor();
  await goTo(page, "Vary");
  await warning.waitFor();
  await closed(page);
});

/** Where a filled disc of the accent's colour is in the spectrum, in CSS pixels. */
const disc = (page, radius) =>
  page.locator(".spectrum canvas").evaluate((canvas, size) => {
    const { width, height } = canvas;
    const { data } = canvas.getContext("2d").getImageData(0, 0, width, height);
    const [r, g, b] = /^#(..)(..)(..)$/.exec(getComputedStyle(canvas).getPropertyValue("--accent").trim()).slice(1).map((hex) => parseInt(hex, 16));
    const isAccent = (x, y) => {
      const at = 4 * (y * width + x);
      return Math.abs(data[at] - r) + Math.abs(data[at + 1] - g) + Math.abs(data[at + 2] - b) < 12 && data[at + 3] > 200;
    };
    for (let y = size; y < height - size; y++) {
      for (let x = size; x < width - size; x++) {
        let all = isAccent(x, y);
        for (let turn = 0; all && turn < 16; turn++) all = isAccent(Math.round(x + (size - 2) * Math.cos((turn * Math.PI) / 8)), Math.round(y + (size - 2) * Math.sin((turn * Math.PI) / 8)));
        if (all) return { x, y };
      }
    }
    return null;
  }, radius);

for (const [name, radius] of [["Cork", 9], ["Comb", 9], ["Oak", 6]].slice(isWhole ? 0 : -1)) {
  test(`a handle of ${name} that is dragged beyond the axes stays on the chart`, async () => {
    const page = await openStudio(browser, FILE);
    await take(page, name);
    await shaping(page);
    const chart = await page.locator(".spectrum canvas").boundingBox();
    for (const way of [-1, 1, 1, -1]) {
      await frames(page);
      const from = await disc(page, radius);
      assert.ok(from, "no handle is on the chart");
      await page.mouse.move(chart.x + from.x, chart.y + from.y);
      await page.mouse.down();
      await page.mouse.move(chart.x + from.x, chart.y + from.y + 600 * way, { steps: 6 });
      await frames(page);
      assert.ok(await disc(page, radius), `dragged ${way < 0 ? "up" : "down"}, the handle has left the chart`);
      await page.mouse.up();
    }
    await closed(page);
  });
}

test("a short press on a bar moves only this bar", async () => {
  const page = await openStudio(browser, FILE);
  await take(page, "Oak");
  await shaping(page);
  const levels = () => page.evaluate(() => htexStudio.handles.value.map(({ db }) => db));
  const chart = await page.locator(".spectrum canvas").boundingBox();
  // The press ends before the next frame.
  const before = await levels();
  await page.mouse.click(chart.x + 0.6 * chart.width, chart.y + 0.3 * chart.height);
  await page.waitForFunction(() => htexStudio.depth.value === 2);
  const moved = (await levels()).filter((db, i) => Math.abs(db - before[i]) > 0.05);
  assert.equal(moved.length, 1, String(moved));
  await page.getByRole("slider", { name: /^Spectrum of Oak/ }).waitFor();
  await closed(page);
});

thorough("the autopilot raises no alarm on textures with one condition", async () => {
  const page = await openStudio(browser, FILE);
  for (const name of ["Zip", "Silk", "Oak"]) {
    await take(page, name);
    for (const pilot of ["Back and forth", "Circle", "Steady"]) {
      await page.getByRole("button", { name: pilot }).click();
      const alarms = await page.evaluate(async () => {
        const told = new Set();
        for (let i = 0; i < 90; i++) {
          await new Promise((resolve) => setTimeout(resolve, 25));
          if (document.querySelector(".pad.outside, .coverage.outside")) told.add(document.querySelector(".coverage").textContent);
        }
        return [...told];
      });
      assert.deepEqual(alarms, [], `${name}, ${pilot}`);
    }
  }
  // A speed that was not recorded still raises it.
  await slide(page, "Speed", 200, SPEEDS);
  await page.locator(".pad.outside").waitFor();
  await closed(page);
});

test("a change of pitch leaves no gap", async () => {
  const listen = () => {
    const { connect } = AudioNode.prototype;
    AudioNode.prototype.connect = function (to, ...rest) {
      if (to instanceof AudioDestinationNode) connect.call(this, (window.tape = new AnalyserNode(this.context, { fftSize: 32768 })));
      return connect.call(this, to, ...rest);
    };
  };
  const page = await openStudio(browser, FILE, { init: listen });
  await take(page, "Frosted glass");
  await page.getByRole("button", { name: "Steady" }).click();
  await page.mouse.move(3, 3);
  await sounded(page, 1);
  for (const wanted of ["true", "false"]) {
    const button = page.getByRole("button", { name: "Audible" });
    await button.click();
    // The tape, of 0.7 s, has the change in its middle.
    await sounded(page, 0.35);
    assert.equal(await button.getAttribute("aria-pressed"), wanted);
    /** The longest stretch in which no 4 ms are louder than a tenth of the median, ms. */
    const gap = await page.evaluate(() => {
      const samples = new Float32Array(32768);
      window.tape.getFloatTimeDomainData(samples);
      const perMs = window.tape.context.sampleRate / 1e3;
      const levels = Array.from({ length: Math.floor(samples.length / perMs) - 4 }, (_, i) => Math.hypot(...samples.subarray(i * perMs, (i + 4) * perMs)));
      const median = levels.toSorted((a, b) => a - b)[levels.length >> 1];
      let [longest, now] = [0, 0];
      for (const level of levels) longest = Math.max(longest, (now = level < 0.1 * median ? now + 1 : 0));
      return longest;
    });
    assert.ok(gap <= 4, `${gap} ms of silence`);
  }
  await closed(page);
});
