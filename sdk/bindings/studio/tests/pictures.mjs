// Takes the pictures of `docs/studio.md`: each screen, and the way from opening to a saved texture, by pointer and keys.
//
//   HTEX_STUDIO=DIR HTEX_COMMAND=htex node pictures.mjs OUT [ONLY]
//
// ONLY is a size and a scheme, such as wide-light, whose screens alone are taken.

import { mkdir, mkdtemp } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";

import { FILE, goTo, htex, launch, openStudio } from "./studio.mjs";

const [out, only] = process.argv.slice(2);
const browser = await launch();
await mkdir(out, { recursive: true });
const folder = await mkdtemp(path.join(tmpdir(), "htex-pictures-"));
const csv = path.join(folder, "linen.csv");
htex("simulate", "--surface", "fine-fabric", "--seconds", "8", "-o", csv);
const [hum, ahap] = ["hum.htex", "buzz.ahap"].map((name) => path.join(folder, name));
htex("make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02", "--at", "speed=80,force=0.5", "-o", hum);
htex("export", hum, "--to", "ahap", "-o", ahap);

async function shot(page, name) {
  await page.waitForTimeout(500);
  await page.screenshot({ path: path.join(out, `${name}.png`) });
}

/** Draws a hill over the bars, from a height; 0 is the upper edge. */
async function draw(page, from) {
  const box = await page.locator(".spectrum canvas").boundingBox();
  const at = (part, height) => [box.x + 50 + part * (box.width - 70), box.y + height * box.height];
  await page.mouse.move(...at(0.42, from));
  await page.mouse.down();
  for (let i = 0; i <= 30; i++) await page.mouse.move(...at(0.42 + 0.008 * i, from + (0.12 * i) / 30 - 0.14 * Math.sin((Math.PI * i) / 30)));
  await page.mouse.up();
}

async function screens(page, suffix) {
  await goTo(page, "Shelf");
  await shot(page, `shelf-${suffix}`);
  await goTo(page, "Shape");
  await page.waitForFunction(() => htexStudio.handles.value.length > 0);
  await page.evaluate(() => [...document.querySelectorAll("button")].find((button) => button.textContent === "Circle").click());
  await draw(page, 0.25);
  await page.evaluate(() => document.querySelector(".notice button")?.click());
  await shot(page, `shape-${suffix}`);
  await page.keyboard.press("Escape");
  for (const name of ["Mix", "Vary", "Compare"]) {
    await goTo(page, name);
    await shot(page, `${name.toLowerCase()}-${suffix}`);
  }
  await goTo(page, "Record");
  await page.locator("input[type=file]").setInputFiles(csv);
  await page.getByRole("button", { name: "Fit all models" }).click();
  await page.locator(".ranked li").first().waitFor();
  await shot(page, `record-${suffix}`);
  await page.evaluate(() => document.querySelector(".notice button")?.click());
  await goTo(page, "Save");
  await shot(page, `save-${suffix}`);
  await goTo(page, "Record");
  await page.locator("input[type=file]").setInputFiles(ahap);
  await page.getByRole("form").waitFor();
  await shot(page, `import-${suffix}`);
  await page.getByRole("button", { name: "Leave it out" }).click();
  await page.getByRole("button", { name: "To the pad" }).first().click();
  await page.getByText("recording", { exact: true }).waitFor();
  await goTo(page, "Compare");
  await page.getByRole("button", { name: "Compare by ear" }).first().click();
  await page.getByText(/plays as it was recorded/).waitFor();
  await page.locator(".side").first().click();
  await page.evaluate(() => document.querySelector(".notice button")?.click());
  await shot(page, `compare-recording-${suffix}`);
  await page.keyboard.press("Escape");
}

/** From opening to a saved texture. */
async function way(page) {
  await shot(page, "way-1-opened");
  const pad = await page.locator(".pad canvas").boundingBox();
  const [x, y] = [pad.x + 0.25 * pad.width, pad.y + 0.4 * pad.height];
  await page.mouse.move(x, y);
  await page.mouse.down();
  for (let i = 0; i < 20; i++) await page.mouse.move(x + 0.02 * i * pad.width, y + 0.01 * i * pad.height);
  await page.screenshot({ path: path.join(out, "way-2-touched.png") });
  await page.mouse.up();
  await page.getByRole("button", { name: /^Denim/ }).click();
  await goTo(page, "Shape");
  await page.waitForFunction(() => htexStudio.handles.value.length > 0);
  await page.getByRole("button", { name: "Circle" }).click();
  await draw(page, 0.4);
  await page.evaluate(() => document.querySelector(".notice button")?.click());
  await shot(page, "way-3-shaped");
  await goTo(page, "Save");
  await page.getByLabel("Name").fill("My denim");
  const saved = page.waitForEvent("download");
  await page.getByRole("button", { name: "Save .htex" }).click();
  await saved;
  await shot(page, "way-4-saved");
}

for (const colorScheme of ["light", "dark"]) {
  for (const [size, width, height] of [["wide", 1240, 800], ["phone", 390, 844]]) {
    if (only && only !== `${size}-${colorScheme}`) continue;
    const page = await openStudio(browser, FILE, { viewport: { width, height }, colorScheme, hasTouch: size === "phone" });
    await page.locator("body").press("Shift");
    await screens(page, `${size}-${colorScheme}`);
    await page.context().close();
  }
}
if (!only) await way(await openStudio(browser, FILE, { viewport: { width: 1240, height: 800 } }));
await browser.close();
