// Imports of files of other haptic formats in Node.js give the same textures as the command, bit
// for bit.

import assert from "node:assert/strict";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { HTEX_PACKAGE, bytes } from "./fixtures.mjs";

const packaged = (name) => import(pathToFileURL(path.join(HTEX_PACKAGE, name)));
const { HtexError } = await packaged("index.node.js");
const { importFile, loadImporter } = await packaged("import.node.js");

const importer = await loadImporter();
const GIVEN = { full_scale: 0.2, speed_mm_s: 80, force_n: 0.4 };
const named = async (name) => ({ name, bytes: await bytes(name) });

/** Files, the settings for the command, and the same settings for the package. */
const IMPORTS = [
  ["felt.xml", { license: "CC-BY-4.0" }],
  ["vinyl.glb", {}],
  ["shake.haptic", { ...GIVEN, quantity: "acceleration" }],
  [
    "taps.ahap",
    { ...GIVEN, models: ["ar", "bands"], options: { ar: { order: 8 } }, profile: "quest", level: "fitted", keep_reference: true, license: "CC0-1.0", tags: ["smooth"] },
  ],
  ["strip.hjif", { ...GIVEN, models: "bands" }],
  ["row.png", { ...GIVEN, pitch_mm: 0.5 }],
];

for (const [name, settings] of IMPORTS) {
  test(`${name} becomes the texture of the command, in a worker and in this thread`, async () => {
    const expected = await bytes(`imported/${name.replace(/\.\w+$/, ".htex")}`);
    const steps = [];
    const { texture, report } = await importFile(await named(name), { ...settings, onProgress: ({ done, of, text }) => steps.push([done, of, text]) });
    assert.ok(Buffer.from(texture.bytes).equals(expected), "other bytes in the worker");
    assert.deepEqual(steps, [[0, 1, `import ${name}`]]);
    assert.ok(Buffer.from(importer.importFile(await named(name), settings).texture.bytes).equals(expected), "other bytes in this thread");
    const models = texture.manifest.representations.map(({ model }) => model);
    assert.deepEqual(report.models.map(({ model }) => model), models);
    assert.deepEqual([...report.ranked].sort(), [...models].sort());
    const { fitted } = importer.formats().formats.find((format) => format.name === report.format);
    assert.ok(report.models.every(({ felt, bytes: own }) => own > 0 && (felt !== null) === fitted));
    const isUnlicensed = report.notes.some(({ text, settings: help }) => /no licence/.test(text) && help.includes("license"));
    assert.equal(isUnlicensed, settings.license === undefined);
  });
}

test("a glTF file gives out the texture that it carries", async () => {
  const { texture } = await importFile(await named("vinyl.glb"));
  assert.ok(Buffer.from(texture.bytes).equals(await bytes("vinyl.htex")));
});

test("a File is imported, and warnings say what was done", async () => {
  const json = JSON.stringify({ Version: 1, Pattern: [{ Event: { Time: 0, EventType: "HapticContinuous", EventDuration: 0.5 } }] });
  const { texture, report } = await importFile(new File([json], "tick.ahap"), { ...GIVEN, models: "sslope", name: "Tick" });
  assert.equal(texture.name, "Tick");
  assert.deepEqual(report.conditions, [{ speed_mm_s: 80, force_n: 0.4 }]);
  assert.ok(report.warnings.some(({ text }) => text.includes("Its 0.500 s are repeated 8 times.")), JSON.stringify(report.warnings));
});

test("formats say what comes in, what is asked, and what is kept and lost", async () => {
  const { formats, profiles } = importer.formats();
  const asks = Object.fromEntries(formats.map(({ name, asks: asked }) => [name, asked.map(({ setting }) => setting)]));
  const signal = ["full_scale", "speed_mm_s", "force_n"];
  assert.deepEqual(asks, { hatt: [], haptic: signal, ahap: signal, hjif: signal, png: [...signal, "pitch_mm"], gltf: [] });
  for (const { extensions, keeps, loses, title, settings, profile, asks: asked } of formats) {
    assert.ok(extensions.length > 0 && keeps && loses && title);
    assert.ok(asked.every(({ setting, words }) => settings.includes(setting) && words.length > 0));
    assert.equal(profile !== null, settings.includes("profile"));
    assert.ok(profile === null || profiles.some(({ name, low_hz, high_hz }) => name === profile && low_hz < high_hz));
  }
  const settings = async (name) => importer.asks(await named(name)).map(({ setting }) => setting);
  assert.deepEqual(await settings("taps.ahap"), signal);
  // The image that the command writes states the distance between its pixels.
  assert.deepEqual(await settings("row.png"), signal);
  assert.deepEqual(await settings("felt.xml"), []);
});

test("errors say what is wrong, where, and what to do", async () => {
  const refused = async (name, data, settings, code, message) => {
    const file = { name, bytes: typeof data === "string" ? Buffer.from(data) : data };
    assert.throws(() => importer.importFile(file, settings), { name: "HtexError", code, message });
    await assert.rejects(importFile(file, settings), (error) => error instanceof HtexError && error.code === code && message.test(error.message));
  };
  const taps = await bytes("taps.ahap");
  await refused("taps.ahap", taps, {}, "invalid-argument", /does not say how strong 1 is, at which speed it is felt and at which force; give full_scale, speed_mm_s and force_n/);
  await refused("taps.ahap", taps, { ...GIVEN, full_scale: 0 }, "invalid-argument", /full_scale 0: more than 0/);
  await refused("taps.ahap", taps, { ...GIVEN, pitch_mm: 1 }, "invalid-argument", /takes no pitch_mm; leave it out \(it takes full_scale, .*speed_mm_s/);
  await refused("taps.ahap", taps, { ...GIVEN, models: "none" }, "no-model", /none/);
  await refused("taps.ahap", taps, { ...GIVEN, profile: "none" }, "invalid-argument", /no profile `none`; there are quest/);
  await refused("taps.ahap", taps, { ...GIVEN, fullScale: 1 }, "invalid-argument", /no fullScale; there are .*full_scale/);
  await refused("taps.ahap", taps, { ...GIVEN, license: "nothing at all" }, "invalid-argument", /licen[cs]e/);
  await refused("taps.ahap", taps.subarray(0, 200), GIVEN, "invalid-file", /taps\.ahap: line \d+ column \d+: it is not JSON/);
  await refused("late.ahap", '{"Version": 2, "Pattern": []}', GIVEN, "invalid-file", /\/Version: version 2 is not known/);
  await refused("felt.xml", (await bytes("felt.xml")).subarray(0, 400), {}, "invalid-file", /felt\.xml: line \d+.*/);
  await refused("felt.xml", await bytes("felt.xml"), { speed_mm_s: 80 }, "invalid-argument", /takes no speed_mm_s; leave it out/);
  await refused("cloth.mp4", "", {}, "invalid-argument", /no format that is read has this extension; there are .*\.ahap/);
  await refused("large.ahap", new Uint8Array((16 << 20) + 1), GIVEN, "invalid-file", /16777217 bytes, and at most 16777216/);
  assert.throws(() => importer.asks({ name: "row.png", bytes: Buffer.from("PNG") }), { code: "invalid-file", message: /row\.png: it is no PNG/ });
  assert.throws(() => importer.asks({ bytes: taps }), { code: "invalid-argument", message: /name/ });
});

test("an import is aborted, and the next one runs", async () => {
  const controller = new AbortController();
  const importing = importFile(await named("taps.ahap"), { ...GIVEN, onProgress: () => controller.abort(), signal: controller.signal });
  await assert.rejects(importing, { name: "HtexError", code: "aborted", message: "the import was aborted" });
  await assert.rejects(importFile(await named("felt.xml"), { signal: controller.signal }), { code: "aborted" });
  assert.equal((await importFile(await named("felt.xml"))).report.format, "hatt");
});
