// The studio in small and zoomed windows, on phones and in forced colours, by mouse, by keys and by
// touch.

import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import test from "node:test";

import { FILE, SCREENS, browser, bytesOf, closed, file, frames, goTo, htex, isWhole, openStudio, prepare, shaping, sounded, swipe } from "./studio.mjs";

const PHONE = { hasTouch: true, isMobile: true, userAgent: "Mozilla/5.0 (Linux; Android 16; Pixel 9) AppleWebKit/537.36 (KHTML, like Gecko) Chrome/156.0.0.0 Mobile Safari/537.36" };

/** 1440x900 and 1280x800 at 200 %, a phone lying and upright, and a small laptop. */
const ALL_WINDOWS = [
  { name: "720x450", viewport: { width: 720, height: 450 } },
  { name: "640x400", viewport: { width: 640, height: 400 } },
  { name: "844x390, a phone", viewport: { width: 844, height: 390 }, ...PHONE },
  { name: "390x844, a phone", viewport: { width: 390, height: 844 }, ...PHONE },
  { name: "1024x700", viewport: { width: 1024, height: 700 } },
];
const UPRIGHT = ALL_WINDOWS[3];
/** A sample is the smallest zoomed window and the phone that is held upright. */
const WINDOWS = isWhole ? ALL_WINDOWS : [ALL_WINDOWS[1], UPRIGHT];
const PHONES = WINDOWS.filter(({ hasTouch }) => hasTouch);
const SCHEMES = isWhole ? ["light", "dark"] : ["dark"];

prepare(async () => {
  await writeFile(file("torn.htex"), "this is no texture");
  htex("make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02", "--at", "speed=80,force=0.5", "-o", file("hum.htex"));
  htex("export", file("hum.htex"), "--to", "ahap", "-o", file("buzz.ahap"));
});

function enter({ name: _, ...options }, more = {}) {
  return openStudio(browser, FILE, { reducedMotion: "reduce", ...options, ...more });
}

/** What comes last on a screen, because it needs the module that makes textures. */
const LAST = { Shelf: ".card", Shape: ".spectrum [role=slider]", Mix: ".corner select", Vary: ".nine .card", Compare: ".felt-bars", Record: "h1", Save: ".field input" };

/** Opens a screen, and waits until it is complete. */
async function show(page, name) {
  await goTo(page, name);
  await page.locator(`main ${LAST[name]}`).first().waitFor();
}

/** Chooses a texture of the shelf. */
async function load(page, name) {
  await goTo(page, "Shelf");
  const card = page.getByRole("button", { name: new RegExp(`^${name}`) });
  await card.scrollIntoViewIfNeeded();
  if (page.viewportSize().width < 900 && (await page.evaluate(() => navigator.maxTouchPoints > 0))) await card.tap();
  else await card.click();
  await page.waitForFunction((wanted) => htexStudio.texture.value.name === wanted, name);
}

/** Presses the button for the controls, which only small windows have. */
async function showControls(page) {
  const button = page.getByRole("button", { name: "Controls", exact: true });
  if (!(await button.isVisible())) return false;
  await button.click();
  return true;
}

for (const window of WINDOWS) {
  test(`${window.name}: at least half of the height is the screen, and the page itself does not scroll`, async () => {
    const page = await enter(window);
    const { width, height } = window.viewport;
    const shown = () =>
      page.evaluate(() => {
        const box = document.querySelector("main").getBoundingClientRect();
        return Math.min(box.bottom, innerHeight) - Math.max(box.top, 0);
      });
    const pad = await page.locator(".pad canvas").boundingBox();
    assert.ok(pad && pad.width >= 90 && pad.height >= 90 && pad.y + pad.height <= height && pad.x + pad.width <= width, JSON.stringify(pad));
    const small = [];
    for (const name of SCREENS) {
      await show(page, name);
      small.push([name, await shown()]);
      // Fields and buttons stand inside their panels.
      const outside = await page.locator("main .panel :is(input, select, textarea, button):not([type=file])").evaluateAll((all) => {
        const ends = (one) => [one.getBoundingClientRect().left, one.getBoundingClientRect().right];
        const isOutside = ([left, right], [from, to]) => left < from - 0.5 || right > to + 0.5;
        return all.filter((one) => one.checkVisibility() && isOutside(ends(one), ends(one.closest(".panel")))).map((one) => one.outerHTML.slice(0, 120));
      });
      assert.deepEqual({ name, outside }, { name, outside: [] });
      // As a wheel, a finger or the key End would.
      await page.mouse.move(8, height - 8);
      await page.mouse.wheel(0, 4000);
      await frames(page);
      const { top, wide, tall } = await page.evaluate(() => ({ top: scrollY, wide: document.documentElement.scrollWidth, tall: document.documentElement.scrollHeight }));
      assert.deepEqual({ name, top, wide, tall }, { name, top: 0, wide: width, tall: height });
    }
    if (await showControls(page)) small.push(["controls", await shown()]);
    assert.deepEqual(small.filter(([, part]) => part < height / 2), [], `of ${height} px`);
    // The curves are seen as a whole, without scrolling.
    await shaping(page);
    const curves = await page.locator(".spectrum canvas").boundingBox();
    const main = await page.locator("main").boundingBox();
    assert.ok(curves.height >= 150 && curves.y + curves.height <= main.y + main.height + 1, `${JSON.stringify(curves)} in ${JSON.stringify(main)}`);
    await closed(page);
  });

  test(`${window.name}: a message covers no control, and an error has its code behind Details`, async () => {
    const page = await enter(window);
    await goTo(page, "Shelf");
    await page.locator("main input[type=file]").setInputFiles(file("torn.htex"));
    const message = page.locator(".notice.bad");
    await message.waitFor();
    for (const name of SCREENS) {
      await show(page, name);
      const covered = await page.evaluate(() => {
        const notice = document.querySelector(".notice");
        const said = notice.getBoundingClientRect();
        const others = [...document.querySelectorAll("button, input, select, textarea, summary, canvas, a")].filter((one) => !notice.contains(one) && !one.matches(".skip") && one.checkVisibility());
        const covers = (one) => {
          // What is scrolled away in its own place is not covered.
          const place = (one.closest("main, .dock, .tabs") ?? document.documentElement).getBoundingClientRect();
          const box = one.getBoundingClientRect();
          const [left, right] = [Math.max(box.left, place.left, said.left), Math.min(box.right, place.right, said.right)];
          const [top, bottom] = [Math.max(box.top, place.top, said.top), Math.min(box.bottom, place.bottom, said.bottom)];
          return right - left > 1 && bottom - top > 1;
        };
        return others.filter(covers).map((one) => one.outerHTML.slice(0, 90));
      });
      assert.deepEqual(covered, [], name);
    }
    const box = await message.boundingBox();
    assert.ok(box.y >= 0 && box.y + box.height <= window.viewport.height, JSON.stringify(box));
    assert.match(await message.innerText(), /cannot be opened\. It is damaged/);
    assert.doesNotMatch(await message.innerText(), /invalid-asset/);
    await message.getByText("Details").click();
    assert.match(await message.innerText(), /\(invalid-asset\)/);
    await closed(page);
  });
}

test("the volume does not squeeze the Sound button", async () => {
  for (const width of [1400, 1024, 920, 720, 640]) {
    const page = await openStudio(browser, FILE, { viewport: { width, height: 700 } });
    const [undo, sound, volume] = await Promise.all(["Undo", "Sound", "Volume"].map((name) => page.locator(`.top [aria-label=${name}]`).boundingBox()));
    assert.ok(Math.abs(sound.width - undo.width) < 0.5 && sound.width >= 38 && volume.width > 40, `${width}: ${JSON.stringify([undo, sound, volume])}`);
    await closed(page);
  }
});

for (const window of PHONES) {
  test(`${window.name}: all that is pressed is 44 px wide and high, also in messages and menus`, async () => {
    const page = await enter(window);
    const small = () =>
      page.evaluate(() =>
        [...document.querySelectorAll("button, select, textarea, summary, .check, input:not([type=file], [type=checkbox])")]
          .filter((one) => one.checkVisibility())
          .map((one) => ({ one, box: one.getBoundingClientRect() }))
          .filter(({ box }) => box.width > 0 && (box.height < 43.5 || box.width < 43.5))
          .map(({ one, box }) => `${one.outerHTML.slice(0, 80)}: ${box.width} x ${box.height}`),
      );
    await page.locator("main input[type=file]").setInputFiles(file("torn.htex"));
    await page.locator(".notice.bad").waitFor();
    for (const name of SCREENS) {
      await show(page, name);
      assert.deepEqual(await small(), [], name);
    }
    await load(page, "Corduroy");
    await shaping(page);
    await page.getByText("Numbers", { exact: true }).tap();
    await page.getByRole("button", { name: "Feel it on" }).tap();
    await page.getByRole("group", { name: "Feel it on" }).waitFor();
    assert.deepEqual(await small(), [], "numbers and outputs");
    await page.getByRole("button", { name: "Feel it on" }).tap();
    await showControls(page);
    assert.deepEqual(await small(), [], "controls");
    await closed(page);
  });

  test(`${window.name}: nothing speaks of hovering, dropping or keys`, async () => {
    const page = await enter(window);
    const found = [];
    const look = async (where) => {
      const words = await page.evaluate(() => {
        const said = [...document.querySelectorAll("[aria-label], [title], [placeholder]")].flatMap((one) => ["aria-label", "title", "placeholder"].map((name) => one.getAttribute(name)));
        return [document.body.innerText, ...said].filter(Boolean);
      });
      const speaks = /hover|pass over|\bdrop|double.click|\bclick|\bkeys?\b|\bEsc|\bCtrl|\bShift\b|\bDelete\b|\barrow|\bpress C\b|key C\b/i;
      found.push(...words.flatMap((text) => text.split("\n")).filter((line) => speaks.test(line)).map((line) => `${where}: ${line}`));
    };
    for (const name of SCREENS) {
      await show(page, name);
      await look(name);
    }
    for (const name of ["Corduroy", "Cork", "Felt", "Oak"]) {
      await load(page, name);
      await shaping(page);
      await look(name);
    }
    assert.deepEqual(found, []);
    await closed(page);
  });
}

test("a phone has a volume, and it is heard", async () => {
  const loudness = (page) =>
    page.evaluate(async () => {
      let most = 0;
      for (let i = 0; i < 30; i++) {
        await new Promise((resolve) => setTimeout(resolve, 20));
        most = Math.max(most, ...htexStudio.heard(new Float32Array(1024)));
      }
      return most;
    });
  for (const window of PHONES) {
    const page = await enter(window);
    await page.getByRole("button", { name: "Back and forth" }).tap();
    await page.waitForFunction(() => Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.02);
    const before = await loudness(page);
    if (window === UPRIGHT) await page.getByRole("button", { name: "Controls", exact: true }).tap();
    const slider = page.getByRole("slider", { name: "Volume" });
    await slider.scrollIntoViewIfNeeded();
    const { x, y, width, height } = await slider.boundingBox();
    await page.touchscreen.tap(x + 0.15 * width, y + height / 2);
    await sounded(page, 0.2);
    const after = await loudness(page);
    assert.ok(after < before / 3, `${window.name}: ${before} before, ${after} after`);
    await closed(page);
  }
});

test("a card that is tapped sounds, and stops sliding; what was chosen since goes on", async () => {
  const page = await enter(UPRIGHT);
  const slides = () => page.evaluate(() => htexStudio.finger.value.force > 0);
  await page.getByRole("button", { name: /^Zip/ }).tap();
  await page.waitForFunction(() => htexStudio.finger.value.speed > 0 && Math.max(...htexStudio.heard(new Float32Array(1024))) > 0.01);
  await page.waitForFunction(() => htexStudio.finger.value.force === 0, null, { timeout: 6000 });
  await frames(page, 30);
  assert.equal(await slides(), false);
  await page.getByRole("button", { name: /^Cork/ }).tap();
  await page.waitForFunction(() => htexStudio.finger.value.speed > 0);
  await page.getByRole("button", { name: "Back and forth" }).tap();
  // For longer than a tapped texture sounds.
  await page.waitForTimeout(4000);
  assert.equal(await slides(), true);
  await page.getByRole("button", { name: "Back and forth" }).tap();
  await page.waitForFunction(() => htexStudio.finger.value.force === 0);
  await closed(page);
});

test("vibration is offered where there is a motor", async () => {
  for (const [window, isOffered] of [[{ viewport: { width: 1400, height: 900 } }, false], [UPRIGHT, true]]) {
    const page = await enter(window);
    await page.getByRole("button", { name: "Feel it on" }).click();
    const menu = page.getByRole("group", { name: "Feel it on" });
    await menu.getByText("Gamepad", { exact: true }).waitFor();
    assert.equal(await menu.getByText(/vibration/i).count(), isOffered ? 1 : 0);
    await closed(page);
  }
});

/** Where handles are in the window, by the axes that the page draws. */
async function handlesAt(page) {
  const canvas = page.locator(".spectrum canvas[aria-valuemin]");
  await canvas.waitFor();
  await frames(page);
  const box = await canvas.boundingBox();
  const [floor, ceiling] = await canvas.evaluate((one) => [Number(one.ariaValueMin), Number(one.ariaValueMax)]);
  const all = await page.evaluate(() => htexStudio.handles.value.map(({ hz, db }) => ({ hz, db })));
  return all.map(({ hz, db }) => ({
    db,
    x: box.x + 44 + ((box.width - 58) * Math.log(hz / 20)) / Math.log(50),
    y: box.y + 10 + ((box.height - 40) * (ceiling - db)) / (ceiling - floor),
  }));
}

for (const window of PHONES) {
  test(`${window.name}: a finger on the curves scrolls the screen, and at the top of a bar draws`, async () => {
    const page = await enter(window);
    await load(page, "Oak");
    await shaping(page);
    await frames(page);
    const box = await page.locator(".spectrum canvas").boundingBox();
    const first = await bytesOf(page);
    const scrolled = () => page.evaluate(() => document.querySelector("main").scrollTop);
    // Oak has little at high frequencies, so that the upper right is empty.
    const inside = [box.x + 0.9 * box.width, box.y + 0.2 * box.height];
    await swipe(page, inside, [inside[0], Math.max(inside[1] - 120, 60)]);
    assert.ok((await scrolled()) > 20, `scrolled by ${await scrolled()} px`);
    assert.ok((await bytesOf(page)).equals(first), "a finger that scrolls changes nothing");
    // A finger that is lifted while it moves lets the screen scroll on.
    for (let rests = 0, last = -1; rests < 5; last = await scrolled()) {
      await frames(page);
      rests = (await scrolled()) === last ? rests + 1 : 0;
    }
    await page.evaluate(() => document.querySelector("main").scrollTo(0, 0));
    const { x, y } = (await handlesAt(page)).reduce((best, one) => (one.db > best.db ? one : best));
    await swipe(page, [x, y], [x + 30, y + 50]);
    assert.ok(!(await bytesOf(page)).equals(first), "a finger at the top of a bar draws");
    assert.equal(await scrolled(), 0);
    await closed(page);
  });

  test(`${window.name}: a peak is added and removed by touch`, async () => {
    const page = await enter(window);
    await load(page, "Guitar string");
    await shaping(page);
    const names = () => page.evaluate(() => htexStudio.handles.value.map(({ hz }) => Math.round(hz)));
    const first = await names();
    assert.equal(first.length, 4);
    await page.getByRole("button", { name: "Add a peak" }).tap();
    await page.waitForFunction(() => htexStudio.handles.value.length === 5);
    const remove = page.getByRole("button", { name: /^Remove peak/ });
    await remove.tap();
    await page.waitForFunction(() => htexStudio.handles.value.length === 4);
    // Another peak is chosen by a tap on it.
    const last = await names();
    await page.evaluate(() => document.querySelector("main").scrollTo(0, 0));
    const { x, y } = (await handlesAt(page)).at(-1);
    await page.touchscreen.tap(x, y);
    await page.getByRole("button", { name: `Remove peak ${last.length}` }).tap();
    await page.waitForFunction(() => htexStudio.handles.value.length === 3);
    assert.deepEqual(await names(), last.slice(0, -1));
    await closed(page);
  });
}

test("the first Tab leads to the screen or to the pad, and the address stays", async () => {
  const page = await openStudio(browser, FILE);
  const focused = () => page.evaluate(() => ({ id: document.activeElement.id, text: document.activeElement.textContent }));
  await page.keyboard.press("Tab");
  assert.equal((await focused()).text, "Skip to the screen");
  const link = page.getByRole("link", { name: "Skip to the screen" });
  const box = await link.boundingBox();
  assert.ok(box.x >= 0 && box.y >= 0 && box.height >= 24 && (await link.evaluate((one) => getComputedStyle(one).clipPath)) === "none");
  await page.keyboard.press("Enter");
  assert.equal((await focused()).id, "screen");
  await page.keyboard.press("Tab");
  assert.equal(await page.evaluate(() => document.activeElement.closest("main") !== null), true);
  await page.reload();
  await page.waitForFunction(() => document.documentElement.dataset.ready === "yes");
  for (const _ of ["screen", "pad"]) await page.keyboard.press("Tab");
  await page.keyboard.press("Enter");
  assert.equal((await focused()).id, "pad");
  assert.equal(new URL(page.url()).hash, "");
  // A small window may show the controls instead of the pad.
  await page.setViewportSize({ width: 640, height: 400 });
  assert.ok(await showControls(page));
  await page.getByRole("link", { name: "Skip to the pad" }).focus();
  await page.keyboard.press("Enter");
  assert.equal((await focused()).id, "pad");
  await closed(page);
});

test("Home, End, Page Up and Page Down move sliders and the handles of the spectrum", async () => {
  const page = await openStudio(browser, FILE);
  await load(page, "Oak");
  await shaping(page);
  const value = (name) => page.getByRole("slider", { name, exact: true }).evaluate((one) => one.valueAsNumber ?? Number(one.ariaValueNow));
  for (const [name, low, high] of [["Rougher", -1, 1], ["Speed", 0, 1000], ["Volume", 0, 1]]) {
    await page.getByRole("slider", { name, exact: true }).focus();
    await page.keyboard.press("Home");
    assert.equal(await value(name), low, name);
    await page.keyboard.press("PageUp");
    const paged = await value(name);
    assert.ok(paged - low > 0.05 * (high - low), `${name}: ${paged}`);
    await page.keyboard.press("End");
    assert.equal(await value(name), high, name);
    await page.keyboard.press("PageDown");
    assert.ok((await value(name)) < high, name);
  }
  const spectrum = page.getByRole("slider", { name: /^Spectrum of/ });
  await spectrum.focus();
  for (let i = 0; i < 4; i++) await page.keyboard.press("ArrowRight");
  const db = () => page.evaluate(() => htexStudio.handles.value[4].db);
  const [start, least, most] = [await db(), ...(await spectrum.evaluate((one) => [Number(one.ariaValueMin), Number(one.ariaValueMax)]))];
  await page.keyboard.press("PageUp");
  assert.ok(Math.abs((await db()) - start - 6) < 0.6, `${start} and ${await db()} dB`);
  await page.keyboard.press("PageDown");
  assert.ok(Math.abs((await db()) - start) < 0.6);
  await frames(page);
  await page.keyboard.press("End");
  assert.ok(Math.abs((await db()) - most) < 1, `${await db()} of ${most} dB`);
  await page.keyboard.press("Home");
  assert.ok((await db()) < least + 12, `${await db()} of ${least} dB`);
  await closed(page);
});

test("one polite live region says the message, the progress, and that a motion was not recorded", async () => {
  const page = await openStudio(browser, FILE);
  const regions = () => page.evaluate(() => [...document.querySelectorAll("[aria-live]:not([aria-live=off]), [role=status], [role=alert], [role=log], output")].map((one) => one.outerHTML.slice(0, 90)));
  for (const name of SCREENS) {
    await show(page, name);
    const found = await regions();
    assert.equal(found.length, 1, `${name}: ${found.join("\n")}`);
    assert.match(found[0], /aria-live="polite"/);
  }
  const said = page.getByRole("status");
  await load(page, "Corduroy");
  await said.getByText(/^Corduroy is on the pad/).waitFor();
  await page.getByRole("slider", { name: "Speed", exact: true }).focus();
  await page.keyboard.press("End");
  await said.getByText(/^Faster than recorded/).waitFor({ state: "attached" });
  await goTo(page, "Compare");
  await page.getByRole("button", { name: "Begin ten trials" }).click();
  await page.getByRole("button", { name: "X is A" }).click();
  await said.getByText("1 of 10 answered.").waitFor({ state: "attached" });
  assert.equal((await regions()).length, 1);
  // What is no longer so is taken back.
  await page.getByRole("button", { name: "Stop the test" }).click();
  await said.getByText("1 of 10 answered.").waitFor({ state: "detached" });
  await goTo(page, "Record");
  await page.locator("main input[type=file]").setInputFiles(file("buzz.ahap"));
  await page.getByRole("form").waitFor();
  await said.getByText(/^The file does not say/).waitFor({ state: "attached" });
  assert.equal((await regions()).length, 1);
  await closed(page);
});

for (const colorScheme of SCHEMES) {
  test(`borders of fields have a contrast of 3:1, ${colorScheme}`, async () => {
    const page = await openStudio(browser, FILE, { colorScheme });
    const faint = async (where) => {
      const found = await page.evaluate(() => {
        const light = (text) => {
          const [r, g, b] = text.match(/[\d.]+/g).map((x) => Number(x) / 255).map((x) => (x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4));
          return 0.2126 * r + 0.7152 * g + 0.0722 * b;
        };
        const contrast = (a, b) => {
          const [x, y] = [light(a), light(b)].sort((p, q) => q - p);
          return (x + 0.05) / (y + 0.05);
        };
        const ground = (one) => {
          for (let at = one; at; at = at.parentElement) {
            const { backgroundColor } = getComputedStyle(at);
            if (!/, 0\)$|transparent/.test(backgroundColor)) return backgroundColor;
          }
          return "rgb(255, 255, 255)";
        };
        const fields = [...document.querySelectorAll(".search, select, textarea, input:not([type=range], [type=checkbox], [type=file], [type=search])")].filter((one) => one.checkVisibility());
        return fields.flatMap((one) => {
          const { borderTopColor, borderTopWidth } = getComputedStyle(one);
          const least = Math.min(...[ground(one), ground(one.parentElement)].map((behind) => contrast(borderTopColor, behind)));
          return least < 3 || parseFloat(borderTopWidth) < 1 ? [`${one.outerHTML.slice(0, 70)}: ${least.toFixed(2)}`] : [];
        });
      });
      assert.deepEqual(found, [], where);
    };
    await faint("Shelf");
    await load(page, "Oak");
    await shaping(page);
    await page.getByText("Numbers", { exact: true }).click();
    for (const name of SCREENS) {
      await show(page, name);
      if (name === "Shape") await page.getByText("Numbers", { exact: true }).click();
      await faint(name);
    }
    await goTo(page, "Record");
    await page.locator("main input[type=file]").setInputFiles(file("buzz.ahap"));
    await page.getByRole("form").waitFor();
    await faint("import");
    await closed(page);
  });
}

/** Colours of a picture of the page at places. */
async function coloursAt(page, places) {
  const picture = (await page.screenshot()).toString("base64");
  return page.evaluate(async ([base64, points]) => {
    const bytes = Uint8Array.from(atob(base64), (letter) => letter.charCodeAt(0));
    const image = await createImageBitmap(new Blob([bytes], { type: "image/png" }));
    const pen = new OffscreenCanvas(image.width, image.height).getContext("2d");
    pen.drawImage(image, 0, 0);
    return points.map(([x, y]) => [...pen.getImageData(Math.round(x), Math.round(y), 1, 1).data].slice(0, 3).join(","));
  }, [picture, places]);
}

for (const colorScheme of SCHEMES) {
  test(`forced colours show what is chosen, ${colorScheme}`, async () => {
    const page = await openStudio(browser, FILE, { colorScheme, forcedColors: "active" });
    /** Of a chosen element and one beside it, the colour inside the left edge. */
    const differ = async (chosen, other) => {
      await chosen.scrollIntoViewIfNeeded();
      const boxes = await Promise.all([chosen, other].map((one) => one.boundingBox()));
      const [a, b] = await coloursAt(page, boxes.map(({ x, y, height }) => [x + 5, y + height / 2]));
      assert.notEqual(a, b, `${chosen} and ${other}`);
    };
    const tab = (name) => page.getByRole("navigation").getByRole("button", { name });
    await load(page, "Zip");
    await page.mouse.move(2, 2);
    await differ(tab("Shelf"), tab("Vary"));
    await differ(page.locator(".card", { hasText: "Zip" }), page.locator(".card", { hasText: "Comb" }));
    await page.locator(".chip", { hasText: "textile" }).click();
    await differ(page.locator(".chip", { hasText: "textile" }), page.locator(".chip", { hasText: "wood" }));
    const pilots = page.getByRole("group", { name: "Who moves the finger" });
    await differ(pilots.getByRole("button", { name: "Hand" }), pilots.getByRole("button", { name: "Steady" }));
    await page.getByRole("button", { name: "Audible" }).click();
    await page.mouse.move(2, 2);
    await differ(page.getByRole("button", { name: "Audible" }), page.getByRole("button", { name: "Feel it on" }));
    await goTo(page, "Compare");
    await page.locator(".side").first().click();
    await page.mouse.move(2, 2);
    await differ(page.locator(".side").nth(0), page.locator(".side").nth(1));
    await page.getByRole("button", { name: "Feel it on" }).click();
    await differ(page.getByRole("button", { name: /^Sound only/ }), page.getByRole("button", { name: /^Gamepad/ }));
    await closed(page);
  });
}

test("Mix: the texture on the pad has one corner", async () => {
  const page = await openStudio(browser, FILE);
  await load(page, "Corduroy");
  await goTo(page, "Mix");
  const corners = page.locator(".corner select");
  const labels = () => corners.evaluateAll((all) => all.map((one) => one.selectedOptions[0]?.textContent.replace(" (on the pad)", "")));
  const first = await labels();
  assert.equal(first[0], "Corduroy");
  assert.equal(new Set(first).size, 4, first.join());
  for (let i = 0; i < 4; i++) {
    const offered = await corners.nth(i).locator("option").allTextContents();
    assert.equal(offered.filter((name) => name.startsWith("Corduroy")).length, i === 0 ? 1 : 0, `corner ${i}: ${offered}`);
  }
  // Another corner can be chosen, and keeps what was chosen.
  await corners.nth(2).selectOption({ label: "Denim" });
  assert.equal((await labels())[2], "Denim");
  assert.equal(new Set(await labels()).size, 4, (await labels()).join());
  // What a corner has comes to the pad.
  await load(page, "Denim");
  await goTo(page, "Mix");
  assert.equal((await labels()).filter((name) => name === "Denim").length, 1, (await labels()).join());
  assert.equal(new Set(await labels()).size, 4, (await labels()).join());
  // A texture that was changed is not mixed with itself unless that is chosen.
  await load(page, "Leather");
  await shaping(page);
  await page.getByRole("slider", { name: /^Spectrum of/ }).focus();
  await page.keyboard.press("ArrowUp");
  await goTo(page, "Mix");
  assert.equal((await labels()).filter((name) => name === "Leather").length, 1, (await labels()).join());
  await closed(page);
});

test("a warning looks like a warning, and a note does not", async () => {
  const page = await openStudio(browser, FILE);
  await goTo(page, "Record");
  await page.locator("main input[type=file]").setInputFiles(file("buzz.ahap"));
  const form = page.getByRole("form");
  for (const [label, value] of [["How strong 1 is", "0.2"], ["Speed, mm/s", "80"], ["Force, N", "0.4"]]) await form.getByLabel(label).fill(value);
  await form.getByRole("button", { name: "Import" }).click();
  const finding = page.locator(".finding", { hasText: "Warning:" }).first();
  await finding.waitFor();
  const look = (of) => of.evaluate((one) => ({ icons: one.querySelectorAll("svg").length, ground: getComputedStyle(one).backgroundColor, edge: getComputedStyle(one).borderLeftColor }));
  const warning = await look(finding);
  assert.equal(warning.icons, 1);
  const note = page.locator(".finding", { hasText: "Note:" }).first();
  if (await note.count()) {
    const plain = await look(note);
    assert.equal(plain.icons, 0);
    assert.notEqual(plain.ground, warning.ground);
    assert.notEqual(plain.edge, warning.edge);
  } else assert.doesNotMatch(warning.ground, /, 0\)$/);
  await closed(page);
});
