// The example of a mesh whose material refers to a texture, in Chromium.

import assert from "node:assert/strict";
import { cp } from "node:fs/promises";
import { createRequire } from "node:module";
import path from "node:path";
import test, { after, before } from "node:test";

import { pause, start } from "./browser.mjs";
import { HTEX_FIXTURES } from "./fixtures.mjs";

const PARTS = ["build", "examples/jsm/loaders", "examples/jsm/utils"];

let here;
before(async () => {
  here = await start();
  // Its entry is build/three.cjs.
  const three = path.dirname(path.dirname(createRequire(import.meta.url).resolve("three")));
  for (const part of PARTS) await cp(path.join(three, part), path.join(here.folder, "example/three", part), { recursive: true });
});
after(() => here?.close());

/** Opens the page with a mesh, and returns the middle of its view. */
async function shown(file = path.join(HTEX_FIXTURES, "vinyl.glb")) {
  const made = await here.page("example/mesh.html");
  await made.setInputFiles("input[type=file]", file);
  await made.waitForFunction(() => document.querySelector("#view[data-ready]") || document.querySelector("#error").textContent);
  const box = await (await made.$("#view")).boundingBox();
  return Object.assign(made, { middle: { x: box.x + box.width / 2, y: box.y + box.height / 2 } });
}

const number = (made, selector) => made.evaluate((selector) => Number(document.querySelector(selector).textContent), selector);

test("a pointer on the mesh plays its texture at its place and speed", async () => {
  const made = await shown();
  assert.equal(await made.textContent("#error"), "");
  assert.equal(await made.textContent("#name"), "vinyl");
  const { x, y } = made.middle;
  await made.mouse.move(x, y);
  await made.mouse.down();
  // The middle of 100 by 100 mm.
  assert.ok(Math.abs((await number(made, "#x")) - 50) < 1, `${await number(made, "#x")}`);
  assert.ok(Math.abs((await number(made, "#y")) - 50) < 1, `${await number(made, "#y")}`);
  let fastest = 0;
  for (let i = 0; i <= 60; i++) {
    await made.mouse.move(x + 40 * Math.sin(i / 5), y);
    fastest = Math.max(fastest, await number(made, "#speed"));
    await pause(5);
  }
  assert.ok(fastest > 10 && fastest < 10_000, `${fastest} mm/s`);
  let loudest = 0;
  for (let i = 0; i < 400 && loudest <= 0.005; i++) {
    await made.mouse.move(x + 40 * Math.sin(i / 5), y);
    loudest = await made.evaluate(() => Number(document.querySelector("#level").dataset.rms));
  }
  assert.ok(loudest > 0.005, `${loudest}`);
  // x increases to the right, y downwards.
  await made.mouse.move(x + 40, y + 20);
  assert.ok((await number(made, "#x")) > 52, `${await number(made, "#x")}`);
  assert.ok((await number(made, "#y")) > 51, `${await number(made, "#y")}`);
  await made.mouse.up();
  assert.equal(await number(made, "#speed"), 0);
  await made.waitForFunction(() => Number(document.querySelector("#level").dataset.rms) < 1e-4);
  assert.deepEqual(made.errors, []);
  await made.close();
});

test("a pointer that leaves the mesh is silent, and one that rests does not move", async () => {
  const made = await shown();
  const { x, y } = made.middle;
  await made.mouse.move(x, y);
  await made.mouse.down();
  for (let i = 0; i < 10; i++) await made.mouse.move(x + 3 * i, y);
  await pause(200);
  assert.equal(await number(made, "#speed"), 0);
  for (let i = 0; i < 10; i++) await made.mouse.move(x + 3 * i, y);
  await made.mouse.move(x + 480, y);
  assert.equal(await number(made, "#speed"), 0);
  await made.mouse.up();
  await made.close();
});

test("a file that is no mesh with a texture says so", async () => {
  const made = await shown(path.join(HTEX_FIXTURES, "vinyl.htex"));
  assert.notEqual(await made.textContent("#error"), "");
  assert.equal(await made.$("#view[data-ready]"), null);
  await made.close();
});
