// The studio in Chromium.

import assert from "node:assert/strict";
import { readFile, writeFile } from "node:fs/promises";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { assertAccessible, browser, bytesOf, closed, FILE, folder, goTo, htex, isWhole, openStudio, prepare, ready, samplesOf, saved, SCREENS, serve, server, shaping, thorough, until } from "./studio.mjs";

prepare();

/** Samples of the present texture in the page. */
function rendered(page, frames, options) {
  return page.evaluate(([count, given]) => Array.from(htexStudio.texture.value.voice({ ...given, model: htexStudio.present.value.model }).render(count)), [frames, options]);
}

/** That the command plays a file as the page does. */
async function assertPlaysAlike(page, file) {
  const out = path.join(folder, "samples.wav");
  const { model } = await page.evaluate(() => ({ model: htexStudio.present.value.model }));
  htex("synth", file, "--model", model, "--seconds", "1", "--rate", "48000", "--seed", "7", "--speed", "80", "--force", "0.5", "-o", out);
  const here = await rendered(page, 48_000, { rate: 48_000, seed: 7, motion: { speed: 80, force: 0.5 } });
  assert.deepEqual(Float32Array.from(here), samplesOf(await readFile(out)));
}

for (const [way, address] of [["the file", () => FILE], ["the folder", () => server.address]].slice(0, isWhole ? 2 : 1)) {
  test(`${way}: a press plays a texture, and nothing is asked of another address`, async () => {
    const page = await openStudio(browser, address());
    await goTo(page, "Shelf");
    await page.getByRole("button", { name: /^Corduroy/ }).click();
    const pad = await page.locator(".pad canvas").boundingBox();
    await page.mouse.move(pad.x + 50, pad.y + 100);
    await page.mouse.down();
    let loudest = 0;
    // Until it is heard, which takes longer on a busy machine.
    for (let i = 0; i < 400 && loudest < 0.02; i++) {
      await page.mouse.move(pad.x + 50 + 4 * (i % 60), pad.y + 100);
      await page.waitForTimeout(20);
      loudest = await page.evaluate(() => Math.max(...htexStudio.heard(new Float32Array(1024))));
    }
    await page.mouse.up();
    assert.ok(loudest >= 0.02, `the loudest sample is ${loudest}`);
    await page.waitForFunction(() => htexStudio.finger.value.force === 0);
    await page.getByRole("button", { name: "Circle" }).click();
    const places = await page.evaluate(async () => {
      const { x } = htexStudio.finger.value;
      await new Promise((resolve) => setTimeout(resolve, 300));
      return [x, htexStudio.finger.value.x];
    });
    assert.notEqual(places[0], places[1]);
    const others = page.requests.filter((url) => !url.startsWith(server.address));
    assert.deepEqual(others, []);
    await closed(page);
  });

  test(`${way}: a texture that is shaped and saved passes validation, and the command plays it alike`, async () => {
    const page = await openStudio(browser, address());
    await shaping(page);
    await page.evaluate(() => {
      htexStudio.moveHandle(7, 0, htexStudio.handles.value[7].db + 9, "one");
      htexStudio.setMacro("brighter", 0.4);
    });
    await goTo(page, "Save");
    await page.getByLabel("Name").fill("Shaped in the page");
    const { name, bytes } = await saved(page, () => page.getByRole("button", { name: "Save .htex" }).click());
    assert.equal(name, "shaped-in-the-page.htex");
    const file = path.join(folder, name);
    await writeFile(file, bytes);
    htex("validate", file);
    assert.match(htex("info", file), /Shaped in the page.*CC0-1\.0/s);
    await assertPlaysAlike(page, file);
    await closed(page);
  });
}

test("the page plays a texture of the shelf as the command does", async () => {
  const page = await openStudio(browser, FILE);
  for (const name of ["Vinyl", "Zip", "Cork", "Silk"]) {
    await goTo(page, "Shelf");
    await page.getByRole("button", { name: new RegExp(`^${name}`) }).click();
    await page.waitForFunction((wanted) => htexStudio.texture.value.name === wanted, name);
    const file = path.join(folder, `${name}.htex`);
    await writeFile(file, await bytesOf(page));
    await assertPlaysAlike(page, file);
  }
  await closed(page);
});

test("Audible plays four times as high, and says so", async () => {
  const page = await openStudio(browser, FILE);
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: /^Guitar string/ }).click();
  await page.getByRole("button", { name: "Steady" }).click();
  const pitch = () =>
    page.evaluate(async () => {
      const turns = [];
      for (let i = 0; i < 12; i++) {
        await new Promise((resolve) => setTimeout(resolve, 60));
        const samples = htexStudio.heard(new Float32Array(1024));
        turns.push(samples.reduce((sum, x, k) => sum + (k > 0 && x > 0 !== samples[k - 1] > 0 ? 1 : 0), 0));
      }
      return turns.sort((a, b) => a - b)[6];
    });
  const felt = await pitch();
  await page.getByRole("button", { name: "Audible" }).click();
  await page.getByText("which is not what a finger feels").waitFor();
  const high = await pitch();
  assert.ok(felt > 4 && high > 3 * felt && high < 5 * felt, `${felt} and ${high} changes of sign`);
  await closed(page);
});

test("a link brings the texture back bit for bit", async () => {
  const page = await openStudio(browser, server.address, { permissions: ["clipboard-read", "clipboard-write"] });
  await shaping(page);
  await page.evaluate(() => htexStudio.setMacro("rougher", 0.5));
  await goTo(page, "Save");
  await page.getByRole("button", { name: "Copy the link" }).click();
  await page.getByText("The link is copied.").waitFor();
  const [first, link] = [await bytesOf(page), await page.evaluate(() => navigator.clipboard.readText())];
  assert.ok(link.startsWith(`${server.address}#t=`));
  const other = await openStudio(browser, link);
  assert.deepEqual(await bytesOf(other), first);
  const asked = server.asked.filter((address) => address.includes("t="));
  assert.deepEqual(asked, []);
  await closed(other);
  await closed(page);
});

test("a link that is cut off is told, and the page goes on", async () => {
  for (const rest of ["!!", "UEsDBAo"]) {
    const page = await openStudio(browser, `${FILE}#t=${rest}`);
    await page.locator(".notice.bad").waitFor();
    await page.waitForFunction(() => htexStudio.texture.value !== null);
    await closed(page);
  }
});

test("a bar that is moved moves alone, by whole steps", async () => {
  const page = await openStudio(browser, FILE);
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: /^Oak/ }).click();
  await shaping(page);
  const moved = await page.evaluate(() => {
    const { handles, moveHandle } = htexStudio;
    const levels = () => handles.value.map(({ db }) => db);
    return [[7, 6], [0, -9], [29, 30], [12, -40]].map(([handle, db]) => {
      const before = levels();
      moveHandle(handle, 0, before[handle] + db, `bar ${handle}`);
      return { handle, db, changes: levels().map((now, i) => now - before[i]) };
    });
  });
  for (const { handle, db, changes } of moved) {
    changes.forEach((change, i) => assert.ok(Math.abs(change - (i === handle ? db : 0)) < 0.05, `bar ${i} by ${change} dB as bar ${handle} moves by ${db} dB`));
  }
  await closed(page);
});

test("a drag of a knob is one step, and a number is taken as it is typed", async () => {
  const page = await openStudio(browser, FILE);
  await shaping(page);
  const { x, y, width, height } = await page.getByRole("slider", { name: "Rougher" }).boundingBox();
  await page.mouse.move(x + width / 2, y + height / 2);
  await page.mouse.down();
  for (let i = 1; i < 8; i++) await page.mouse.move(x + width / 2 + 5 * i, y + height / 2);
  await page.mouse.up();
  await page.waitForFunction(() => htexStudio.depth.value > 0);
  assert.equal(await page.evaluate(() => htexStudio.depth.value), 1);
  await page.getByText("Numbers", { exact: true }).click();
  const number = page.locator(".number-list input").first();
  await number.fill("");
  await number.pressSequentially("12.5");
  await page.keyboard.press("Tab");
  // Bands keeps whole steps.
  assert.equal(await number.inputValue(), "13");
  await closed(page);
});

test("500 random edits that are undone give the first bytes", async () => {
  const page = await openStudio(browser, FILE);
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: /^Oak/ }).click();
  await shaping(page);
  const first = await bytesOf(page);
  const edited = await page.evaluate(async () => {
    let state = 1;
    const random = () => (state = (state * 48271) % 2147483647) / 2147483647;
    const { handles, setMacro, moveHandle, depth, undo } = htexStudio;
    const names = ["rougher", "brighter", "peak", "level"];
    for (let i = 0; i < 500; i++) {
      const at = Math.floor(random() * handles.value.length);
      // A macro begins where another edit ended, and only then is a step of its own.
      if (i % 5 === 4) setMacro(names[Math.floor(random() * 4)], random() - 0.5);
      else moveHandle(at, handles.value[at].hz, handles.value[at].db + 20 * (random() - 0.5), `edit ${i}`);
    }
    const [steps, last] = [depth.value, Array.from(htexStudio.present.value.bytes)];
    for (let i = 0; i < 500; i++) await undo();
    return { steps, last, isEmpty: depth.value === 0 };
  });
  assert.equal(edited.steps, 500);
  assert.ok(edited.isEmpty);
  assert.notDeepEqual(Buffer.from(edited.last), first);
  assert.deepEqual(await bytesOf(page), first);
  await closed(page);
});

test("the folder works without a network once it was opened", async () => {
  const own = await serve();
  const page = await openStudio(browser, own.address);
  // The module and the shelf, too, which load before the script asks for them.
  const assets = await page.evaluate(() => performance.getEntriesByType("resource").map(({ name }) => name).filter((name) => name.includes("/assets/")));
  assert.ok(assets.some((name) => name.endsWith(".wasm")) && assets.some((name) => name.endsWith(".htexlib")), assets.join());
  assert.equal(new Set(assets).size, assets.length, assets.join());
  await page.evaluate(() => navigator.serviceWorker.ready);
  await until(page, async () => (await caches.keys()).length > 0 && navigator.serviceWorker.controller !== null);
  await own.close();
  await page.reload();
  await ready(page);
  await shaping(page);
  await page.evaluate(() => htexStudio.setMacro("level", 0.3));
  assert.deepEqual(page.errors.filter((text) => !text.includes("ERR_CONNECTION_REFUSED")), []);
  await page.context().close();
});

test("own textures and the work of last time are there again", async () => {
  const page = await openStudio(browser, server.address);
  await shaping(page);
  await page.evaluate(() => htexStudio.setMacro("peak", 0.25));
  await goTo(page, "Save");
  await page.getByLabel("Name").fill("Mine");
  await page.getByRole("button", { name: "Keep on the shelf" }).click();
  await page.getByText(/is on the shelf/).waitFor();
  const work = await bytesOf(page);
  await page.reload();
  await ready(page);
  assert.deepEqual(await bytesOf(page), work);
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: /^Mine/ }).first().waitFor();
  await closed(page);
});

test("a recording becomes a texture in a worker", async () => {
  const csv = path.join(folder, "denim.csv");
  htex("simulate", "--surface", "fine-fabric", "--seconds", "6", "-o", csv);
  const page = await openStudio(browser, FILE);
  await goTo(page, "Record");
  await page.locator("input[type=file]").setInputFiles(csv);
  await page.getByRole("img", { name: /Signal of 6.0 s/ }).waitFor();
  await page.getByRole("button", { name: "Fit all models" }).click();
  const ranked = page.locator(".ranked li");
  await ranked.first().waitFor();
  assert.equal(await ranked.count(), 6);
  await page.getByRole("button", { name: "To the pad" }).first().click();
  await page.getByText("recording", { exact: true }).waitFor();
  const file = path.join(folder, "fitted.htex");
  await writeFile(file, await bytesOf(page));
  htex("validate", file);
  await closed(page);
});

/** Fits a simulated recording, and puts the texture on the pad; returns the recording. */
async function fitRecording(page) {
  const csv = path.join(folder, "felt.csv");
  htex("simulate", "--surface", "fine-fabric", "--seconds", "6", "--speed", "80", "--force", "0.4", "-o", csv);
  await goTo(page, "Record");
  await page.locator("input[type=file]").setInputFiles(csv);
  await page.getByRole("button", { name: "Fit all models" }).click();
  await page.getByRole("button", { name: "To the pad" }).first().click();
  await page.getByText("recording", { exact: true }).waitFor();
  return csv;
}

thorough("a recording is compared by ear with its models, with matched levels, blind too", async () => {
  const page = await openStudio(browser, FILE);
  const csv = await fitRecording(page);
  await goTo(page, "Compare");
  await page.getByRole("button", { name: "Compare by ear" }).first().click();
  await page.getByText(/plays as it was recorded, at 80 mm\/s and 0.40 N, [\d.]+ s again and again/).waitFor();
  await page.getByText(/All recordings against the model/).waitFor();
  await page.getByRole("button", { name: "Steady" }).click();
  /** What is heard of a side: its level, and how much of it is a stretch of the recording. */
  const listen = async (side) => {
    await page.locator(".side", { hasText: new RegExp(`^${side}`) }).click();
    return page.evaluate(async (text) => {
      const wait = (seconds) => new Promise((resolve) => setTimeout(resolve, 1e3 * seconds));
      const context = htexStudio.audioContext();
      const [loop] = htexStudio.author.value.recorded({ name: "felt.csv", bytes: new TextEncoder().encode(text) }, { rate: context.sampleRate });
      for (const until = context.currentTime + 0.3; context.currentTime < until; ) await wait(0.02);
      let [power, count, last] = [0, 0, null];
      for (let i = 0; i < 60; i++) {
        await wait(0.025);
        last = htexStudio.heard(new Float32Array(1024));
        last.forEach((x) => ((power += x * x), (count += 1)));
      }
      return { level: Math.sqrt(power / count), likeness: likeness(last, loop.samples) };
      function likeness(heard, samples) {
        const sum = (one) => one.reduce((all, x) => all + x * x, 0);
        const own = sum(heard);
        let most = 0;
        for (let at = 0; at < samples.length; at++) {
          let [both, power] = [0, 0];
          for (let i = 0; i < heard.length; i += 4) {
            const sample = samples[(at + i) % samples.length];
            both += heard[i] * sample;
            power += sample ** 2;
          }
          most = Math.max(most, (4 * both) / Math.sqrt(own * 4 * power));
        }
        return most;
      }
    }, await readFile(csv, "utf8"));
  };
  const [recorded, model] = [await listen("A"), await listen("B")];
  assert.ok(recorded.likeness > 0.98 && model.likeness < 0.9, `${recorded.likeness} ${model.likeness}`);
  assert.ok(Math.abs(20 * Math.log10(recorded.level / model.level)) < 1.5, `${recorded.level} ${model.level}`);
  await page.getByRole("button", { name: "Begin ten trials" }).click();
  for (let i = 0; i < 10; i++) await page.getByRole("button", { name: "X is B" }).click();
  const { bytes } = await saved(page, () => page.getByRole("button", { name: "Save as CSV" }).click());
  const rows = bytes.toString().trim().split("\n").slice(1);
  assert.equal(rows.length, 10);
  for (const row of rows) assert.match(row, /"the recording felt\.csv",".+",1$/);
  // The key changes sides; axe finds nothing in the new controls.
  await page.locator("body").press("c");
  await page.getByRole("button", { name: /^B .*, plays$/ }).waitFor();
  await page.keyboard.press("c");
  await page.getByRole("button", { name: /^A .*, plays$/ }).waitFor();
  await assertAccessible(page);
  await page.keyboard.press("Escape");
  await closed(page);
});

test("a baked block is the one of the command", async () => {
  const page = await openStudio(browser, FILE);
  await goTo(page, "Shelf");
  await page.getByRole("button", { name: /^Corduroy/ }).click();
  await page.waitForFunction(() => htexStudio.texture.value.name === "Corduroy");
  await goTo(page, "Save");
  await tabTo(page, ({ text }) => text === "Save a microcontroller block");
  const { name, bytes } = await saved(page, () => page.keyboard.press("Enter"));
  assert.equal(name, "corduroy.h");
  const [file, header] = [path.join(folder, "corduroy.htex"), path.join(folder, "corduroy.h")];
  await writeFile(file, await bytesOf(page));
  const model = await page.evaluate(() => htexStudio.present.value.model);
  htex("bake", file, "--model", model, "-o", header);
  assert.equal(bytes.toString(), await readFile(header, "utf8"));
  await page.getByText(/bytes for a player at 8000 Hz/).waitFor();
  await closed(page);
});

test("ten blind trials have a p-value and a table", async () => {
  const page = await openStudio(browser, FILE);
  await goTo(page, "Compare");
  await page.getByRole("main").getByRole("combobox").nth(1).selectOption({ label: "Shelf: Zip" });
  await page.getByRole("button", { name: "Begin ten trials" }).click();
  for (let i = 0; i < 10; i++) await page.getByRole("button", { name: "X is A" }).click();
  const told = await page.locator("p", { hasText: /of 10 right/ }).textContent();
  const { bytes } = await saved(page, () => page.getByRole("button", { name: "Save as CSV" }).click());
  const rows = bytes.toString().trim().split("\n").slice(1).map((row) => row.split(","));
  const right = rows.filter(([, x]) => x === "a").length;
  assert.equal(rows.length, 10);
  assert.equal(rows.filter((row) => row[3] === "1").length, right);
  const choose = (n, k) => (k === 0 ? 1 : (choose(n, k - 1) * (n - k + 1)) / k);
  // Two-sided: results as far from five, in both directions.
  const far = Math.max(right, 10 - right);
  const p = Math.min(Array.from({ length: 11 - far }, (_, i) => choose(10, far + i)).reduce((sum, ways) => sum + ways, 0) / 512, 1);
  assert.ok(told.includes(`${right} of 10 right`) && told.includes(p < 0.001 ? "< 0.001" : p.toFixed(3)), `${told}; p = ${p}`);
  await closed(page);
});

test("a player page plays alone", async () => {
  const page = await openStudio(browser, FILE);
  await goTo(page, "Save");
  const { name, bytes } = await saved(page, () => page.getByRole("button", { name: "Save a player page" }).click());
  const file = path.join(folder, name);
  await writeFile(file, bytes);
  const listen = () => {
    const { connect } = AudioNode.prototype;
    AudioNode.prototype.connect = function (to, ...rest) {
      if (to instanceof AudioDestinationNode) connect.call(this, (window.meter = new AnalyserNode(this.context)));
      return connect.call(this, to, ...rest);
    };
  };
  const player = await openStudio(browser, pathToFileURL(file).href, { init: listen });
  await player.locator("#pad").focus();
  await player.keyboard.down("ArrowRight");
  await player.waitForFunction(() => {
    const samples = new Float32Array(2048);
    window.meter.getFloatTimeDomainData(samples);
    return Math.max(...samples) > 0.02;
  });
  assert.deepEqual(player.requests, []);
  await closed(player);
  await closed(page);
});

/** Presses a key until something has the focus that passes. */
async function tabTo(page, isThere, key = "Tab") {
  for (let i = 0; i < 90; i++) {
    const focused = await page.evaluate(() => ({ text: document.activeElement?.textContent?.trim(), label: document.activeElement?.getAttribute("aria-label"), type: document.activeElement?.type, tag: document.activeElement?.tagName }));
    if (isThere(focused)) return;
    await page.keyboard.press(key);
  }
  assert.fail(`no ${isThere} is reached by ${key}`);
}

test("keys alone lead from the shelf to a saved file", async () => {
  const page = await openStudio(browser, FILE);
  await tabTo(page, ({ text }) => text?.startsWith("Coarse fabric"));
  for (let i = 0; i < 3; i++) await page.keyboard.press("ArrowRight");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => htexStudio.texture.value.name !== "Coarse fabric");
  await tabTo(page, ({ label }) => label?.startsWith("Pad of"));
  await page.keyboard.press("3");
  await page.keyboard.down("ArrowRight");
  await page.waitForFunction(() => htexStudio.finger.value.speed > 0 && Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.01);
  await page.keyboard.up("ArrowRight");
  await page.keyboard.press(" ");
  await page.waitForFunction(() => htexStudio.finger.value.speed > 0);
  await page.keyboard.press("Escape");
  await page.waitForFunction(() => htexStudio.finger.value.force === 0);
  await tabTo(page, ({ text }) => text === "Shape", "Shift+Tab");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => htexStudio.handles.value.length > 0);
  const first = await bytesOf(page);
  await tabTo(page, ({ label }) => label?.startsWith("Spectrum of"));
  for (const key of ["ArrowRight", "ArrowUp", "ArrowUp", "ArrowUp"]) await page.keyboard.press(key);
  assert.notDeepEqual(await bytesOf(page), first);
  await tabTo(page, ({ text }) => text === "Save", "Shift+Tab");
  await page.keyboard.press("Enter");
  await tabTo(page, ({ text }) => text === "Save .htex");
  const { bytes } = await saved(page, () => page.keyboard.press("Enter"));
  const file = path.join(folder, "by-keys.htex");
  await writeFile(file, bytes);
  htex("validate", file);
  await closed(page);
});

for (const colorScheme of ["light", "dark"]) {
  for (const viewport of [{ width: 1400, height: 900 }, { width: 390, height: 844 }]) {
    if (!isWhole && (colorScheme === "dark") !== viewport.width < 500) continue;
    test(`no screen has a finding of axe: ${colorScheme}, ${viewport.width} px`, async () => {
      const page = await openStudio(browser, FILE, { colorScheme, viewport, reducedMotion: "reduce" });
      for (const name of SCREENS) {
        await goTo(page, name);
        await assertAccessible(page, name);
      }
      await closed(page);
    });
  }
}

test("on a phone all that is pressed is 44 px high, and nothing is wider than the screen", async () => {
  const page = await openStudio(browser, FILE, { viewport: { width: 390, height: 844 }, hasTouch: true });
  for (const name of SCREENS) {
    await goTo(page, name);
    await page.waitForTimeout(300);
    const small = await page.evaluate(() =>
      [...document.querySelectorAll("button, select, input:not([type=file]):not([type=checkbox]), summary")]
        .filter((element) => element.checkVisibility())
        .map((element) => ({ element, height: element.getBoundingClientRect().height }))
        .filter(({ height }) => height > 0 && height < 43.5)
        .map(({ element, height }) => `${element.outerHTML.slice(0, 80)}: ${height}`),
    );
    assert.deepEqual(small, [], name);
    const wide = await page.evaluate(() => document.documentElement.scrollWidth);
    assert.ok(wide <= 390, `${name} is ${wide} px wide`);
  }
  await closed(page);
});
