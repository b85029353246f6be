// Scenes from memory in Node.js give the same samples as the command.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { HTEX_FIXTURES, HTEX_PACKAGE, bytes, difference, samples } from "./fixtures.mjs";

const { open } = await import(pathToFileURL(path.join(HTEX_PACKAGE, "index.node.js")));
const { scene } = await import(pathToFileURL(path.join(HTEX_PACKAGE, "scene.node.js")));

/** The files of examples/scenes. */
const file = (name) => readFile(path.join(HTEX_FIXTURES, "scenes", name));
const filesOf = async (names) => Object.fromEntries(await Promise.all(names.map(async (name) => [name, await file(name)])));

/** Returns a plan without its times, because the command may have measured its own. */
const withoutCosts = (plan) => JSON.parse(JSON.stringify(plan, (name, value) => (/^(ns_per_sample|renderer_ns|costs)/.test(name) ? undefined : value)));

const FILES = {
  "two-swatches": ["coarse-fabric.htex", "vinyl.htex", "hand.csv"],
  electrovibration: ["coarse-fabric.htex", "display.csv"],
};

for (const [name, names] of Object.entries(FILES)) {
  test(`${name} has the samples and the plan of the command`, async () => {
    const opened = await scene(await file(`${name}.scene.json`), await filesOf(names));
    const plan = JSON.parse(await bytes(`${name}.json`));
    assert.deepEqual(withoutCosts(opened.plan), withoutCosts(plan));
    assert.equal(opened.rate, plan.rate_hz);
    assert.equal(opened.unit, name === "electrovibration" ? "V" : "N");
    assert.equal(opened.notes.length, name === "electrovibration" ? 1 : 0);
    const expected = await samples(`${name}.wav`);
    assert.equal(difference(opened.render(), expected), -1);
    // In blocks, to the end.
    const [all, block] = [[], new Float32Array(4001)];
    for (let part; (part = opened.render(block)).length > 0; ) all.push(...part);
    assert.equal(difference(Float32Array.from(all), expected), -1);
    const second = opened.render(1);
    assert.equal(second.length, opened.rate);
    opened.free();
    opened.free();
    assert.throws(() => opened.render(), { name: "HtexError", code: "invalid-argument", message: /freed/ });
  });
}

test("a motion of the program is rendered as a voice plays it", async () => {
  const live = await scene(await file("live.scene.json"), new Map([["coarse-fabric.htex", { name: "any", bytes: await file("coarse-fabric.htex") }]]));
  assert.throws(() => live.render(), { code: "invalid-argument", message: /renderPath/ });
  const at = live.renderPath(new Float64Array(400).fill(80), 0.4, { block: 50 });
  const moved = live.renderPath(Array.from({ length: 400 }, (_, i) => 80 + i / 4), 0.4, { block: 50, x: 10, y: 10 });
  assert.deepEqual([at.length, moved.length], [20000, 20000]);
  const level = (all) => Math.sqrt(all.slice(2000).reduce((sum, x) => sum + x * x, 0) / (all.length - 2000));
  const expected = (await open(await file("coarse-fabric.htex"))).level({ model: live.plan.representation[0].model });
  assert.ok(Math.abs(20 * Math.log10(level(at) / expected)) < 1, `${level(at)} ${expected}`);
  assert.notEqual(difference(at, moved), -1);
  assert.throws(() => live.renderPath([80, 80], [0.4]), { code: "invalid-argument", message: /length/ });
  assert.throws(() => live.renderPath([80], 0.4, { x: 1 }), { code: "invalid-argument", message: /x and y/ });
  assert.throws(() => live.renderPath([80, 80], [0.4, -1]), { code: "invalid-motion", message: /block 1/ });
});

test("the device is chosen by options", async () => {
  const given = await filesOf(["coarse-fabric.htex"]);
  const constant = await file("constant.scene.json");
  const other = { settings: { quantity: "acceleration" } };
  await assert.rejects(scene(constant, given, other), { code: "invalid-scene", message: /quantity/ });
  const [twice, half] = await Promise.all([2, 0.5].map((quantity_gain) => scene(constant, given, { ...other, quantity_gain })));
  assert.equal(twice.unit, "m/s2");
  assert.equal(difference(twice.render(0.5), half.render(0.5).map((x) => 4 * x)), -1);
  await assert.rejects(scene(constant, given, { settings: { bits: 8 } }), { code: "invalid-scene", message: /bits/ });
  await assert.rejects(scene(constant, given, { device: "none" }), { code: "invalid-scene", message: /none/ });
  await assert.rejects(scene(constant, given, { devise: "file" }), { code: "invalid-argument", message: /device/ });
});

test("what is missing is named", async () => {
  const text = await file("two-swatches.scene.json");
  const error = await scene(text, await filesOf(["coarse-fabric.htex"])).catch((error) => error);
  assert.equal(error.code, "invalid-scene");
  assert.match(error.message, /vinyl\.htex/);
  await assert.rejects(scene(Buffer.from("{}")), { code: "invalid-scene" });
  await assert.rejects(scene("file"), { code: "invalid-argument" });
});

test("a model that a texture brings along runs if that is allowed", async () => {
  const own = (representation) => Buffer.from(JSON.stringify({
    htex_scene: "1.0",
    surfaces: [{ asset: "bursts.htex", representation }],
    motion: { constant: { speed_mm_s: 80, force_n: 0.5 } },
    duration_s: 0.5,
  }));
  const { models } = await open(await bytes("bursts.htex"));
  const model = models.find((id) => id.includes("bursts"));
  const files = { "bursts.htex": await bytes("bursts.htex") };
  await assert.rejects(scene(own(model), files), { code: "invalid-scene" });
  const allowed = await scene(own(model), files, { trusted: true });
  assert.equal(allowed.plan.representation[0].model, model);
  assert.ok(allowed.render().some((x) => Math.abs(x) > 1e-4));
});
