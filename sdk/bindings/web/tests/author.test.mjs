// The author module in Node.js makes the same files as the command, bit for bit.

import assert from "node:assert/strict";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { HTEX_PACKAGE, bytes, difference, samples } from "./fixtures.mjs";

const { HtexError, Library, fit, loadAuthor, open } = await import(pathToFileURL(path.join(HTEX_PACKAGE, "index.node.js")));

const author = await loadAuthor();
const vinyl = { name: "vinyl.csv", bytes: await bytes("vinyl.csv") };
const MOTION = { speed_mm_s: 80, force_n: 0.5 };

/** Checks that a texture has the same bytes as a file that the command wrote. */
async function isFile(texture, name) {
  assert.ok(Buffer.from(texture.bytes).equals(await bytes(name)), `${name} has other bytes`);
}

/** Returns an NPY file in single precision. */
function npy(numbers) {
  const header = `{'descr': '<f4', 'fortran_order': False, 'shape': (${numbers.length},), }`.padEnd(117) + "\n";
  const start = Buffer.from(`\x93NUMPY\x01\x00${String.fromCharCode(header.length)}\x00`, "latin1");
  return Buffer.concat([start, Buffer.from(header), Buffer.from(numbers.buffer, numbers.byteOffset, numbers.byteLength)]);
}

test("a recording is fitted to the bytes of the command, in a worker and in this thread", async () => {
  const steps = [];
  const { texture, report } = await fit(vinyl, { name: "vinyl", onProgress: ({ done, of, text }) => steps.push([done, of, text]) });
  await isFile(texture, "vinyl.htex");
  assert.deepEqual(steps.map(([done]) => done), [0, 1, 2, 3, 4, 5, 6]);
  assert.deepEqual(steps[0], [0, 7, "read vinyl.csv"]);
  const info = JSON.parse(await bytes("info.json"));
  assert.deepEqual(report.models.map(({ model, bytes: own }) => [model, own]), info.representations.map((r) => [r.model, r.payload_bytes]));
  assert.ok(report.models.every(({ felt, fit_ms }) => felt.error_rms_db >= 0 && fit_ms >= 0));
  assert.equal(report.ranked.length, 6);
  await isFile(author.fit(vinyl, { name: "vinyl" }).texture, "vinyl.htex");
});

test("settings are the same as the command's", async () => {
  const settings = { name: "part", from_s: 2, to_s: 8, models: ["ar", "bands"], options: { ar: { order: 8 } }, keep_reference: true };
  const { texture } = author.fit(vinyl, { ...settings, license: "CC0-1.0", tags: ["smooth"] });
  await isFile(texture, "part.htex");
  assert.throws(() => author.fit(vinyl, { form_s: 2 }), { name: "HtexError", code: "invalid-argument", message: /form_s.*from_s/ });
  assert.throws(() => author.fit(vinyl, { models: "none" }), { code: "no-model" });
  assert.throws(() => author.fit(vinyl, { license: "nothing at all" }), { code: "invalid-argument" });
});

test("the setup's response, a tracker and a grid are read as by the command", async () => {
  const named = async (name) => ({ name, bytes: await bytes(name) });
  const models = ["ar", "bands"];
  const response = await named("response.csv");
  await isFile(author.fit(vinyl, { name: "compensated", models, response }).texture, "compensated.htex");
  const tracker = await named("tracker.csv");
  const { texture } = await fit(await named("sensors.csv"), { name: "tracked", models, tracker, tracker_map: "time=stamp:0.001,x=px,y=py" });
  await isFile(texture, "tracked.htex");
  const free = await named("free.csv");
  const { texture: whole, report } = await fit(free, { name: "grid", models: "bands", grid: "auto" });
  await isFile(whole, "grid.htex");
  assert.ok(report.grid && report.conditions.length > 4);
  const grid = { speed: [80, 160], force: [0.5, 1] };
  await isFile(author.fit(free, { name: "lines", models: "bands", grid }).texture, "lines.htex");
  assert.throws(() => author.fit(vinyl, { tracker, tracker_map: "time=none" }), { name: "HtexError", message: /none/ });
  assert.throws(() => author.fit(free, { grid: { sped: [80] } }), { code: "invalid-argument", message: /sped/ });
});

test("samples are read of WAV, NPY and FLAC", async () => {
  const name = "samples";
  const wav = { name: "ar.wav", bytes: await bytes("ar.wav") };
  const { texture, report } = await fit([wav], { name, scale: 2, ...MOTION });
  await isFile(texture, "samples.htex");
  const numbers = { name: "ar.npy", bytes: npy(await samples("ar.wav")) };
  const other = await fit(numbers, { name, scale: 2, rate_hz: 48000, ...MOTION });
  assert.deepEqual(other.report.spectra, report.spectra);
  assert.deepEqual(other.texture.manifest.representations, texture.manifest.representations);
  const flac = author.columns({ name: "pcm16.flac", bytes: await bytes("pcm16.flac") }, { scale: 1 });
  const pcm = author.columns({ name: "pcm16.wav", bytes: await bytes("pcm16.wav") }, { scale: 1 });
  assert.deepEqual([flac.rate_hz, flac.columns.length], [pcm.rate_hz, pcm.columns.length]);
  // The two writers round differently.
  const isNear = (x, i, k) => Math.abs(x - pcm.columns[i].first[k]) < 3 / 32768;
  assert.ok(flac.columns.every(({ first }, i) => first.length === 5 && first.every((x, k) => isNear(x, i, k))));
});

test("a fit is aborted, and the next one runs", async () => {
  const controller = new AbortController();
  const fitting = fit(vinyl, { onProgress: () => controller.abort(), signal: controller.signal });
  await assert.rejects(fitting, (error) => error instanceof HtexError && error.code === "aborted");
  await assert.rejects(fit(vinyl, { signal: controller.signal }), { code: "aborted" });
  await isFile((await fit(vinyl, { name: "vinyl" })).texture, "vinyl.htex");
});

test("a recording is read as the command reads it", async () => {
  const read = author.process(vinyl);
  const expected = JSON.parse(await bytes("process.json"));
  assert.deepEqual(read.spectrum.magnitude, expected.magnitude);
  assert.deepEqual(read.spectrum.frequency_hz, expected.frequency_hz);
  assert.equal(read.condition.force, expected.force_n);
  const roles = read.columns.columns.map(({ name, role }) => [name, role]);
  assert.deepEqual(roles.slice(0, 3), [["t_s", "time"], ["fx_n", "lateral_x"], ["fy_n", "lateral_y"]]);
  const { steps, signals } = read.picture;
  assert.ok(steps <= 1000 && Object.keys(signals).includes("normal"));
  assert.ok(signals.signal.least.length === steps && signals.signal.least.every((x, i) => x <= signals.signal.greatest[i]));
  // Reading with the guessed map gives the same result.
  const mapped = author.process(vinyl, { map: read.columns.map });
  assert.deepEqual(mapped.spectrum, read.spectrum);
});

/**
 * Returns the magnitude of a loop at a frequency that has a whole number of periods in the loop.
 */
function magnitudeOf({ samples, rate_hz }, hertz) {
  const turn = (2 * Math.PI * hertz) / rate_hz;
  let [re, im] = [0, 0];
  samples.forEach((x, i) => ([re, im] = [re + x * Math.cos(turn * i), im + x * Math.sin(turn * i)]));
  return Math.hypot(re, im) / samples.length;
}

test("a recording is a loop: its level, its band and no seam", () => {
  const [loop] = author.recorded(vinyl, { rate: 48000 });
  const { spectrum, condition } = author.process(vinyl);
  assert.deepEqual([loop.recording, loop.unit, loop.condition], ["vinyl.csv", "N", condition]);
  const rms = (numbers) => Math.sqrt(numbers.reduce((sum, x) => sum + x * x, 0) / numbers.length);
  assert.ok(Math.abs(rms(loop.samples) / loop.level_rms - 1) < 1e-4);
  // The Hann window spreads the power of one bin over one and a half bins.
  assert.ok(Math.abs(Math.sqrt(spectrum.magnitude.reduce((sum, m) => sum + m * m, 0) / 3) / loop.level_rms - 1) < 1e-9);
  const steps = loop.samples.map((x, i) => Math.abs(loop.samples[(i + 1) % loop.samples.length] - x));
  assert.ok(steps.at(-1) <= 1.5 * steps.slice(0, -1).reduce((most, step) => Math.max(most, step)));
  // RMS in a range of frequencies, relative to the whole RMS. It is small outside the band. The
  // window widens the ends of the band by two bins, 10 Hz.
  const period = loop.rate_hz / loop.samples.length;
  const between = (low, high) => {
    const [first, last] = [Math.ceil(low / period), Math.floor(high / period)];
    const power = Array.from({ length: last - first + 1 }, (_, k) => 2 * magnitudeOf(loop, (first + k) * period) ** 2);
    return Math.sqrt(power.reduce((sum, x) => sum + x, 0)) / loop.level_rms;
  };
  const [inside, below, above] = [between(120, 180), between(period, 8), between(1100, 1300)];
  assert.ok(inside > 0.1 && below < 0.05 && above < 1e-4, `${below}, ${inside}, ${above}`);
  assert.throws(() => author.recorded(vinyl, { rate: 1000 }), { code: "invalid-argument", message: /2000 Hz/ });
  assert.throws(() => author.recorded(vinyl), { code: "invalid-argument", message: /rate/ });
});

test("a texture is baked to the bytes and the source code of the command", async () => {
  const texture = await open(await bytes("vinyl.htex"));
  const one = author.bake(texture, { name: "block", model: "bands" });
  assert.ok(Buffer.from(one.bytes).equals(await bytes("block.bin")));
  assert.equal(one.c, (await bytes("block.h")).toString());
  assert.equal(one.rust, (await bytes("block.rs")).toString());
  const grid = { speed: [40, 100, 160], force: [0.5] };
  const many = author.bake(texture, { name: "many-block", model: "ar", rate: 6000, grid });
  assert.equal(many.c, (await bytes("many-block.h")).toString());
  assert.throws(() => author.bake(texture, { grid: { speed: [0], force: [0.5] } }), { code: "invalid-argument" });
  assert.throws(() => author.bake(texture, { within: 0 }), { code: "invalid-argument", message: /within/ });
});

test("licence and author of a texture are told as text and as a chunk of WAV", async () => {
  const texture = author.edit(await open(await bytes("vinyl.htex")), { license: "CC-BY-4.0", author: "Ada" });
  const { license, author: who, text, riff } = author.rights(texture);
  assert.deepEqual([license, who], ["CC-BY-4.0", "Ada"]);
  assert.equal(text, "SPDX-FileCopyrightText: Ada\nSPDX-License-Identifier: CC-BY-4.0\n");
  const chunk = Buffer.from(riff);
  assert.equal(chunk.toString("latin1", 0, 4), "LIST");
  assert.equal(chunk.readUInt32LE(4), chunk.length - 8);
  assert.ok(chunk.includes("ICOP") && chunk.includes(text.trim().split("\n")[1]));
  const none = author.rights(author.edit(texture, { license: "", author: "" }));
  assert.deepEqual([none.license, none.text, none.riff.length], [null, "", 0]);
});

test("a finding says what it means, and a column without a role what to do", () => {
  const silent = "t_s,fx_n\n" + Array.from({ length: 4000 }, (_, i) => `${i / 2000},0.25\n`).join("");
  const { findings } = author.process({ name: "silent.csv", bytes: Buffer.from(silent) });
  const found = findings.find(({ code }) => code === "RECORDING_STUCK");
  assert.ok(found.severity === "error" && /0.2500 N/.test(found.message));
  assert.deepEqual(found.settings, ["from_s", "to_s"]);
  assert.match(author.explain("RECORDING_STUCK").fix, /record/i);
  assert.equal(author.explain("NOTHING"), undefined);
  const strange = { name: "strange.csv", bytes: Buffer.from("p,q\n1,2\n3,4\n5,6\n") };
  const { columns, problem } = author.columns(strange);
  assert.deepEqual(columns.map(({ name, role, first }) => [name, role, first]), [["p", null, [1, 3, 5]], ["q", null, [2, 4, 6]]]);
  assert.match(problem, /map/);
  assert.throws(() => author.fit(strange), { code: "invalid-recording", message: /map/ });
  assert.throws(() => author.process({ bytes: new Uint8Array(4) }), { code: "invalid-argument", message: /name/ });
});

test("a texture is made of parameters, and played", async () => {
  const at = { speed: 80, force: 0.5, level: 0.02, parameters: { alpha: 2, beta: 5 } };
  const hum = author.make({ name: "hum", representations: [{ model: "sbeta", conditions: [at] }] });
  await isFile(hum, "hum.htex");
  const opened = await open(await bytes("hum.htex"));
  const [own, expected] = [hum, opened].map((texture) => texture.voice({ seed: 3 }).render(2000));
  assert.equal(difference(own, expected), -1);
  // Two models at two conditions. One of the models has its level among its parameters.
  const bands = { below_highest: [0, 10, 20], step_db: 1, layout: 1 };
  const two = author.make({
    name: "two",
    license: "CC0-1.0",
    quantity: "acceleration",
    unit: "m/s2",
    representations: [
      { model: "sbeta", conditions: [at, { ...at, speed: 160 }] },
      { model: "bands", conditions: [{ speed: 80, force: 0.5, parameters: bands }, { speed: 160, force: 0.5, parameters: bands }] },
    ],
  });
  assert.deepEqual([two.conditions.length, two.models.length, two.unit], [2, 2, "m/s2"]);
  assert.ok(author.validate(two.bytes).valid);
  // With one condition, the command makes one texture for each model. A texture with both models
  // has the same parameters, levels and bytes.
  const here = { speed: 80, force: 0.5, level: 0.02 };
  const representations = [
    { model: "sbeta", conditions: [{ ...here, parameters: at.parameters }] },
    { model: "mfcc", conditions: [{ ...here, parameters: { cepstrum: [-12, 3.1, 0.4], bands: 26, inverse: 0 } }] },
  ];
  const single = author.make({ name: "cepstrum", license: "CC0-1.0", quantity: "acceleration", representations: representations.slice(1) });
  await isFile(single, "cepstrum.htex");
  const both = author.make({ name: "both", license: "CC0-1.0", quantity: "acceleration", representations });
  for (const [model, file] of [["sbeta", "beta.htex"], ["mfcc", "cepstrum.htex"]]) {
    const made = await open(await bytes(file));
    const [own, expected] = [both, made].map((texture) => texture.manifest.representations.find((one) => one.model.endsWith(model)));
    assert.deepEqual({ ...own, path: undefined }, { ...expected, path: undefined });
    assert.equal(difference(...[both, made].map((texture) => texture.voice({ model, seed: 3 }).render(2000))), -1);
  }
  const refused = (change) => () => author.make({ name: "no", representations: [{ model: "sbeta", conditions: [{ ...at, ...change }] }] });
  assert.throws(refused({ parameters: { alpha: 2 } }), { code: "invalid-argument", message: /beta/ });
  assert.throws(refused({ parameters: { alpha: 2, beta: -1 } }), { code: "invalid-argument", message: /beta/ });
  assert.throws(refused({ level: undefined }), { code: "invalid-argument", message: /level/ });
});

test("every model has a usual range for each number", () => {
  const models = author.models();
  assert.ok(models.length > 0);
  for (const { id, fields } of models) {
    for (const { name, min, max, usual } of fields) {
      assert.ok(usual && min <= usual.min && usual.min < usual.max && usual.max <= max, `${id}.${name}`);
      assert.ok(usual.scale === "linear" || (usual.scale === "log" && usual.min > 0), `${id}.${name}`);
    }
  }
});

test("textures are mixed and edited as by the command", async () => {
  const [a, b] = await Promise.all(["vinyl.htex", "hum.htex"].map(async (name) => open(await bytes(name))));
  await isFile(author.mix(a, b, 0.25, { name: "between" }), "mixed.htex");
  await isFile(author.edit(a, { author: "A. Weaver", contact: "tool" }), "edited.htex");
  assert.throws(() => author.edit(a, {}), { code: "invalid-argument" });
  assert.throws(() => author.mix(a, b, 2), { code: "invalid-argument" });
});

test("extensions are written, kept and removed", async () => {
  const [look, other] = ["org.htex.appearance/1", "com.example.NOTE/2"];
  const wood = { hue_deg: 28, saturation: 0.5, lightness: 0.4, gloss: 0.2, relief: 0.5, pattern: "fibres" };
  const of = ({ manifest }) => manifest.extensions;
  const made = author.make({ name: "oak", extensions: { [look]: wood, [other]: [1, null] }, representations: [{ model: "sbeta", conditions: [{ level: 0.1, parameters: { alpha: 2, beta: 3 } }] }] });
  assert.deepEqual(of(made), { [look]: wood, [other]: [1, null] });
  assert.deepEqual(of(author.edit(made, { tags: ["wood"] })), of(made));
  const edited = author.edit(made, { extensions: { [look]: { ...wood, hue_deg: 30 }, [other]: null } });
  assert.deepEqual(of(edited), { [look]: { ...wood, hue_deg: 30 } });
  assert.deepEqual(author.edit(author.edit(edited, { extensions: { [look]: wood } }), { extensions: { [other]: [1, null] } }).bytes, made.bytes);
  assert.equal(of(author.edit(edited, { extensions: { [look]: null } })), undefined);
  assert.equal(of(author.mix(made, made, 0.5)), undefined);
  assert.deepEqual(of(author.mix(made, made, 0.5, { name: "both", extensions: { [look]: wood } })), { [look]: wood });
  assert.ok(author.validate(edited.bytes).valid);
  // It is the same file as the command's.
  await isFile(author.edit(await open(await bytes("hum.htex")), { extensions: { [look]: wood } }), "lit.htex");
  assert.throws(() => author.edit(made, { extensions: { LOOK: 1 } }), { name: "HtexError", message: /com\.vendor\.NAME/ });
  assert.throws(() => author.edit(made, { extensions: [] }), { code: "invalid-argument", message: /extensions/ });
});

test("a difference is felt by its level, and not at all below the threshold", () => {
  const made = (level) => author.make({ name: "noise", representations: [{ model: "sbeta", conditions: [{ level, parameters: { alpha: 2, beta: 3 } }] }] });
  const [one, same, twice, faint, fainter] = [0.1, 0.1, 0.2, 1e-8, 1e-9].map((level) => ({ texture: made(level) }));
  const none = author.felt(one, same);
  assert.deepEqual([none.error_rms_db, none.total_error_db, none.below_difference_threshold, none.below_if_sensitive], [0, 0, true, true]);
  const louder = author.felt(one, twice);
  assert.ok(Math.abs(louder.total_error_db - 20 * Math.log10(2)) < 0.05 && !louder.below_difference_threshold, JSON.stringify(louder));
  assert.equal(louder.centre_hz.length, louder.error_db.length);
  assert.equal(author.felt(faint, fainter).largest_error_db, 0);
  assert.equal(author.threshold([250], { quantity: "displacement" })[0], 1e-7);
  assert.throws(() => author.threshold([0]), { name: "HtexError", code: "invalid-argument" });
  assert.throws(() => author.felt(one, { texture: made(0.1), model: "ar" }), { name: "HtexError" });
});

test("files are validated", async () => {
  assert.deepEqual(author.validate(await bytes("part.htex")), { kind: "texture", valid: true, findings: [] });
  assert.deepEqual(author.validate(await bytes("vinyl.htex")).findings.map(({ code }) => code), ["LICENSE_MISSING"]);
  const broken = author.validate((await bytes("vinyl.htex")).subarray(0, 500));
  assert.ok(!broken.valid && broken.findings[0].severity === "error");
  assert.ok(author.validate(vinyl.bytes, { name: vinyl.name }).valid);
  assert.equal(author.validate(await bytes("two.htexlib")).kind, "library");
});

test("a library is packed to the bytes of the command, and searched", async () => {
  const textures = { vinyl: await open(await bytes("vinyl.htex")), bursts: await bytes("bursts.htex") };
  assert.throws(() => author.library(textures, { name: "Two" }), /state no licence/);
  const packed = author.library(textures, { name: "Two", unlicensed: true });
  assert.ok(Buffer.from(packed).equals(await bytes("two.htexlib")));
  const library = await Library.open(packed);
  const found = async (query) => {
    const names = [];
    for await (const { name } of library.find(query)) names.push(name);
    return names;
  };
  assert.deepEqual(await found({ words: ["VIN"] }), ["vinyl"]);
  assert.deepEqual(await found({ model: "bands" }), ["vinyl"]);
  assert.deepEqual(await found({ speed: 80, force: 0.5 }), ["bursts", "vinyl"]);
  assert.deepEqual(await found({ tags: ["rough"] }), []);
  await assert.rejects(found({ tag: "rough" }), { code: "invalid-argument" });
});
