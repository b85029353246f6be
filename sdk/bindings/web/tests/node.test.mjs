// The package in Node.js.

import assert from "node:assert/strict";
import { execFile, execFileSync } from "node:child_process";
import { cp, mkdir, mkdtemp, readFile, rm, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import { tmpdir } from "node:os";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";
import { promisify } from "node:util";

import { HTEX_FIXTURES, HTEX_PACKAGE, MODELS, bytes, difference, samples } from "./fixtures.mjs";

/** The motion at which the command rendered its samples. */
const MOTION = { speed: 80, force: 0.5 };

const { open, GuardedWorker, HtexError, HtexNode } = await import(pathToFileURL(path.join(HTEX_PACKAGE, "index.node.js")));

for (const model of MODELS) {
  test(`${model} has the samples of the command`, async () => {
    const texture = await open(await bytes("vinyl.htex"));
    const voice = texture.voice({ model, rate: 48000, seed: 7, motion: MOTION });
    const expected = await samples(`${model}.wav`);
    const first = voice.render(100);
    const rest = voice.render(new Float32Array(expected.length - 100));
    const all = new Float32Array(expected.length);
    all.set(first);
    all.set(rest, 100);
    assert.equal(difference(all, expected), -1);
    voice.free();
    texture.free();
  });
}

test("a texture that becomes stronger and weaker has the samples of the command, and by default it does not", async () => {
  const texture = await open(await bytes("swell.htex"));
  const expected = await samples("swell.wav");
  const rendered = (options) => texture.voice(options).render(expected.length);
  assert.equal(difference(rendered({ fluctuation: true }), expected), -1);
  assert.notEqual(difference(rendered({}), expected), -1);
});

test("a model that an asset brings along has the samples of the engine", async () => {
  const options = { model: "bursts", rate: 48000, seed: 7, motion: MOTION };
  const texture = await open(await bytes("bursts.htex"));
  assert.ok(texture.hasModules);
  assert.throws(() => texture.voice(options), { name: "HtexError", code: "untrusted", message: /GuardedWorker.*trusted: true/ });
  const trusted = await open(await bytes("bursts.htex"), { trusted: true });
  assert.equal(difference(trusted.voice(options).render(96000), await samples("bursts.wav")), -1);
  const forbidden = await open(await bytes("bursts.htex"), { embedded: false });
  assert.throws(() => forbidden.voice({ model: "bursts" }), { name: "HtexError", code: "no-model" });
});

test("all models as modules have the samples of the built-in ones", async () => {
  for (const model of MODELS) {
    const modules = [await bytes(`htex_${model}.wasm`)];
    const texture = await open(await bytes("vinyl.htex"), { modules, trusted: true });
    assert.ok(texture.hasModules);
    const voice = texture.voice({ model, rate: 48000, seed: 7, motion: MOTION });
    const expected = await samples(`${model}.wav`);
    assert.equal(difference(voice.render(expected.length), expected), -1, model);
    voice.setMotion(123, 0.31);
    voice.render(1000);
    voice.free();
  }
});

test("a texture tells what it is", async () => {
  const texture = await open(await bytes("vinyl.htex"));
  assert.equal(texture.unit, "N");
  assert.equal(texture.models.length, 6);
  assert.deepEqual(texture.band, [20, 1000]);
  const [{ speed, force }] = texture.conditions;
  assert.ok(Math.abs(speed - 80) < 2 && Math.abs(force - 0.5) < 0.01);
  const magnitudes = texture.spectrum([50, 100, 2000], { model: "bands" });
  assert.ok(magnitudes[0] > 0 && magnitudes[2] === 0);
  assert.ok(texture.level() > 0);
  const voice = texture.voice();
  const [{ speed: recorded }] = texture.conditions;
  const faster = { speed: 2 * recorded, force: 0.5 };
  const { text, ...coverage } = voice.coverage(faster);
  assert.match(text, /frequencies are 2\.000 times as high/);
  const speedReach = { kind: "outside", asked: 2 * recorded, recorded };
  assert.deepEqual({ kind: coverage.kind, inside: coverage.inside, speed: coverage.speed, force: coverage.force.kind }, { kind: "outside", inside: false, speed: speedReach, force: "inside" });
  assert.ok(Math.abs(coverage.frequencyFactor - 2) < 1e-9);
  assert.equal(voice.coverage().kind, "inside");
  // The samples at a motion have the spectrum that the texture states for this motion, multiplied
  // by the gain.
  voice.setMotion(faster.speed, faster.force);
  assert.equal(voice.coverage().kind, "outside");
  voice.setGain(0.5);
  const plays = voice.spectrum([50, 100, 400]);
  texture.spectrum([50, 100, 400], { at: faster }).forEach((m, i) => assert.ok(Math.abs(plays[i] / (0.5 * m) - 1) < 1e-6));
  voice.setMotion(0, 0.5);
  assert.deepEqual([...voice.spectrum([50])], [0]);
  assert.equal(voice.coverage().kind, "silent");
  assert.deepEqual([texture.quantity, texture.contact, texture.law.level_force.exponent], ["lateral_force", "finger", 1]);
  assert.deepEqual(Buffer.from(texture.toBytes()), await bytes("vinyl.htex"));
  const { alpha, beta } = texture.parameters({ model: "sbeta" });
  assert.ok(alpha > 0 && beta > 0);
  const { below_highest: levels } = texture.parameters({ model: "bands" });
  assert.ok(Array.isArray(levels) && levels.length === 30 && Math.min(...levels) === 0);
  // A recording shows nearly the spectrum that the model states, in steps of 5 Hz.
  const { frequencies, magnitudes: read } = texture.readSpectrum({ model: "ar" });
  assert.deepEqual([frequencies[0], frequencies.at(-1), read.length], [20, 1000, 197]);
  const stated = texture.spectrum(frequencies, { model: "ar" });
  assert.ok(read.slice(10, 150).every((m, i) => Math.abs(20 * Math.log10(m / stated[i + 10])) < 2));
  // A Hann window spreads a sinusoid over three bins, whose squares add up to 3 times its mean
  // square.
  const sinusoids = texture.readSpectrum({ model: "speak" }).magnitudes;
  const levelRead = Math.sqrt(sinusoids.reduce((sum, m) => sum + m * m, 0) / 3);
  assert.ok(Math.abs(levelRead / texture.level({ model: "speak" }) - 1) < 0.05, `${levelRead}`);
  const path = voice.renderPath([80, 90], [0.5, 0.4], 64);
  assert.equal(path.length, 128);
});

test("bad input is an error of its kind", async () => {
  const whole = await bytes("vinyl.htex");
  const error = (code) => (e) => e instanceof HtexError && e.code === code && e.message.length > 10;
  await assert.rejects(open(new Uint8Array(0)), error("invalid-asset"));
  await assert.rejects(open(whole.subarray(0, 200)), error("invalid-asset"));
  await assert.rejects(open(42), error("invalid-argument"));
  await assert.rejects(open("cloth.htex"), { name: "HtexError", message: /no file is read.*open\(await readFile\("cloth\.htex"\)\)/ });
  await assert.rejects(open(whole, { trused: true }), { name: "HtexError", message: /did you mean `trusted`/ });
  const texture = await open(whole);
  assert.throws(() => texture.voice({ model: "none" }), error("no-representation"));
  assert.throws(() => texture.voice({ rate: NaN }), HtexError);
  assert.throws(() => texture.voice({ synthesis: "loud" }), error("invalid-argument"));
  const voice = texture.voice();
  assert.throws(() => voice.setMotion(NaN, 0.4), error("invalid-motion"));
  assert.throws(() => voice.setMotion(80, -1), error("invalid-motion"));
  assert.throws(() => voice.render(1.5), error("invalid-argument"));
  assert.throws(() => voice.render([]), error("invalid-argument"));
  assert.throws(() => texture.voice({ rate: "8000" }), { name: "HtexError", message: /`rate` must be of the type number/ });
  assert.throws(() => texture.voice({ motion: { sped: 80 } }), { name: "HtexError", message: /did you mean `speed`/ });
  assert.throws(() => voice.renderPath([1], [], 8), error("invalid-argument"));
  voice.free();
  voice[Symbol.dispose]();
  assert.throws(() => voice.render(8), error("bad-handle"));
  assert.throws(() => new HtexNode({}, texture), error("unsupported"));
});

test("mutated files never crash", async () => {
  const whole = await bytes("bursts.htex");
  let random = 1;
  const next = (below) => {
    random = (Math.imul(random, 1664525) + 1013904223) >>> 0;
    return Math.floor((random / 2 ** 32) * below);
  };
  let opened = 0;
  for (let i = 0; i < 3000; i++) {
    const copy = Uint8Array.from(whole.subarray(0, i % 3 === 0 ? next(whole.length) : whole.length));
    for (let k = next(4); k >= 0 && copy.length > 0; k--) copy[next(copy.length)] = next(256);
    try {
      const texture = await open(copy, { embedded: i % 50 === 0, trusted: true });
      const voice = texture.voice();
      assert.ok(voice.render(64).every(Number.isFinite));
      voice.free();
      texture.free();
      opened += 1;
    } catch (error) {
      assert.ok(error instanceof HtexError, `${error?.stack}`);
      assert.notEqual(error.code, "internal");
    }
  }
  assert.ok(opened < 3000);
});

test("a module above its limits is refused", async () => {
  const asset = await bytes("vinyl.htex");
  // A memory of 2,000 pages of 64 KiB, above the 64 MiB of a model.
  const large = Uint8Array.from([0, 97, 115, 109, 1, 0, 0, 0, 5, 4, 1, 0, 0xd0, 0x0f]);
  await assert.rejects(open(asset, { modules: [large], trusted: true }), /memory is limited/);
  await assert.rejects(open(asset, { modules: [large.subarray(0, 8)], trusted: true }), /not an htex model/);
  await assert.rejects(open(asset, { modules: [Uint8Array.of(1, 2, 3)], trusted: true }), /does not begin/);
});

test("a voice tells what it plays", async () => {
  const texture = await open(await bytes("vinyl.htex"));
  const voice = texture.voice({ model: "ar", bands: 3, seed: 7, gain: 0.5 });
  assert.equal(voice.model, "org.htex.ar");
  const edges = [20, 20 * 50 ** (1 / 3), 20 * 50 ** (2 / 3), 1000];
  assert.ok(voice.envelopeEdges.every((edge, k) => Math.abs(edge / edges[k] - 1) < 1e-9));
  const samples = voice.render(20000);
  const rms = Math.sqrt(samples.reduce((sum, x) => sum + x * x, 0) / samples.length);
  const { level, centroid, frames, bands } = voice.envelope();
  assert.equal(frames, 20000);
  assert.ok(Math.abs(level / rms - 1) < 1e-6);
  assert.ok(centroid > 20 && centroid < 1000);
  const power = bands.reduce((sum, x) => sum + x);
  assert.ok(bands.length === 3 && Math.abs(power / level ** 2 - 1) < 0.1, `${power} ${level ** 2}`);
  voice.reset();
  assert.equal(difference(voice.render(20000), samples), -1);
  assert.throws(() => voice.envelope(new Float64Array(2)), { code: "invalid-argument" });
  assert.throws(() => voice.setGain(-1), { code: "invalid-argument" });
  voice.setMotion(0, 0);
  assert.ok(!voice.isSilent);
  voice.render(1000);
  assert.ok(voice.isSilent);
  const limited = texture.voice({ model: "ar", seed: 7, limit: 0.001 });
  assert.ok(limited.render(2000).every((x) => Math.abs(x) <= Math.fround(0.001)));
});

test("a worker stops a module that does not return", async () => {
  const modules = [await bytes("endless.wasm")];
  const endless = await open(await bytes("bursts.htex"), { modules, embedded: false });
  const worker = new GuardedWorker({ limit: 500 });
  const start = performance.now();
  const options = { model: "bursts", rate: 48000, seed: 7, motion: MOTION };
  await assert.rejects(worker.render(endless, 100, options), { name: "HtexError", code: "model", message: /longer than 500 ms/ });
  assert.ok(performance.now() - start < 5000);
  await assert.rejects(worker.render(endless, 100, options), { code: "model" });
  // Another worker plays a WASM module that returns. It reports the same errors as a voice.
  const texture = await open(await bytes("bursts.htex"));
  const guarded = new GuardedWorker();
  const expected = await samples("bursts.wav");
  const played = await guarded.render(texture, 1000, options);
  assert.equal(difference(played, expected.slice(0, 1000)), -1);
  await assert.rejects(guarded.render(texture, 100, { model: "none" }), { code: "no-representation" });
  guarded.end();
  await assert.rejects(guarded.render(texture, 100, options), { message: /ended/ });
});

test("a worker does not keep a program running", () => {
  const index = JSON.stringify(pathToFileURL(path.join(HTEX_PACKAGE, "index.node.js")));
  const program = `const { GuardedWorker } = await import(${index}); new GuardedWorker(); console.log("done");`;
  const arguments_ = ["--input-type=module", "-e", program];
  assert.equal(execFileSync(process.execPath, arguments_, { encoding: "utf8", timeout: 20000 }).trim(), "done");
});

test("the examples of the README for Node.js run", async (t) => {
  const folder = await mkdtemp(path.join(tmpdir(), "htex-web-"));
  t.after(() => rm(folder, { recursive: true, force: true }));
  await mkdir(path.join(folder, "node_modules"));
  await cp(HTEX_PACKAGE, path.join(folder, "node_modules/htex"), { recursive: true });
  await cp(path.join(HTEX_FIXTURES, "vinyl.htex"), path.join(folder, "cloth.htex"));
  const library = await bytes("many.htexlib");
  const server = createServer((_, response) => response.end(library));
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  const url = `http://127.0.0.1:${server.address().port}/cloth.htexlib`;
  const readme = await readFile(path.join(HTEX_PACKAGE, "README.md"), "utf8");
  const examples = [...readme.matchAll(/```js\n([\s\S]*?)```/g)].map(([, text]) => text);
  // The second example is for a page. `sound.test.mjs` and `bundles.test.mjs` test it.
  const [plays, , states, searches, measures] = examples;
  assert.equal(examples.length, 5);
  const search = searches.replace("https://example.org/cloth.htexlib", url).replace("woven/cotton", "vinyl");
  const programs = [
    [plays, /vinyl N 20000/],
    [states, /lateral_force finger 1[\s\S]*alpha[\s\S]*where 80\.95 mm\/s was recorded[\s\S]*\b3\b/],
    [`${search} console.log(texture.unit);`, /floor\/0998[\s\S]*\nN\n/],
    [`${plays.replace("const voice", "const first").replaceAll("voice.", "first.")} ${measures} console.log(level > 0, centroid > 20, bands.length);`, /true true 3/],
  ];
  for (const [program, expected] of programs) {
    await writeFile(path.join(folder, "play.mjs"), program);
    const { stdout } = await promisify(execFile)(process.execPath, ["play.mjs"], { cwd: folder, maxBuffer: 1 << 24 });
    assert.match(stdout, expected);
  }
  server.close();
});
