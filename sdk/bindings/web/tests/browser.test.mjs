// The package in Chromium: worklet, worker, example and catalogue.

import assert from "node:assert/strict";
import { readFile } from "node:fs/promises";
import path from "node:path";
import test, { after, before } from "node:test";

import { start } from "./browser.mjs";
import { HTEX_FIXTURES, MODELS, difference, samples } from "./fixtures.mjs";

const { HTEX_PICTURE, HTEX_SECONDS = "20" } = process.env;
/** Number of samples of the fade at a start, at 48 kHz. */
const FADE = 480;

let here;
before(async () => {
  here = await start();
});
after(() => here?.close());
const page = (...options) => here.page(...options);

/**
 * Renders a node offline in the page. Returns its samples, or the result of a function of the
 * samples.
 */
async function offline(made, asset, options, { seconds = 2, rate = 48000, speed = 80, force = 0.5, of = (samples) => samples } = {}) {
  const list = await made.evaluate(
    async ({ asset, options, seconds, rate, speed, force, of }) => {
      const { open, prepare, HtexNode } = await import("/htex/index.js");
      const texture = await open(`/fixtures/${asset}`);
      const context = new OfflineAudioContext(1, seconds * rate, rate);
      await prepare(context);
      const node = new HtexNode(context, texture, { motion: { speed, force }, ...options });
      node.speed.value = speed;
      node.force.value = force;
      node.connect(context.destination);
      await node.ready;
      const buffer = await context.startRendering();
      if (node.error) throw node.error;
      return Array.from(new Function(`return ${of}`)()(buffer.getChannelData(0), rate));
    },
    { asset, options, seconds, rate, speed, force, of: of.toString() },
  );
  return Float32Array.from(list);
}

test("the worklet gives the samples of the command", async () => {
  const made = await page();
  for (const model of MODELS) {
    const heard = await offline(made, "vinyl.htex", { model, seed: 7, gain: 1 });
    assert.equal(difference(heard.slice(FADE), (await samples(`${model}.wav`)).slice(FADE)), -1, model);
  }
  const heard = await offline(made, "bursts.htex", { model: "bursts", seed: 7, gain: 1, trusted: true });
  assert.equal(difference(heard.slice(FADE), (await samples("bursts.wav")).slice(FADE)), -1);
  assert.deepEqual(made.errors, []);
  await made.close();
});

test("what the worklet plays has the spectrum of the texture", async () => {
  const made = await page();
  const { frequency_hz, magnitude } = JSON.parse(await readFile(path.join(HTEX_FIXTURES, "spectrum.json"), "utf8"));
  const [{ speed_mm_s: speed, force_n: force }] = JSON.parse(await readFile(path.join(HTEX_FIXTURES, "info.json"), "utf8")).manifest.conditions;
  const options = { model: "bands", seed: 3, gain: 1 };
  const heard = await offline(made, "vinyl.htex", options, { seconds: 400, rate: 8000, speed, force, of: spectrum });
  for (let band = 0; band < 9; band++) {
    const [low, high] = [band, band + 1].map((b) => 20 * 50 ** (b / 9));
    const inside = frequency_hz.map((hz, i) => [hz, i]).filter(([hz]) => hz >= low && hz < high);
    const power = (of) => inside.reduce((sum, [hz, i]) => sum + of(hz, i) ** 2, 0);
    const error = 10 * Math.log10(power((hz) => heard[Math.round(hz / 5)]) / power((_, i) => magnitude[i]));
    assert.ok(Math.abs(error) < 0.3, `${low.toFixed(0)}-${high.toFixed(0)} Hz: ${error.toFixed(2)} dB`);
  }
  await made.close();
});

/**
 * Returns magnitudes in steps of 5 Hz, computed as in `htex process`: segments of 0.2 s that
 * overlap by half, Hann windows, RMS.
 */
function spectrum(signal, rate) {
  const len = rate / 5;
  const turns = Array.from({ length: len }, (_, n) => [Math.cos((2 * Math.PI * n) / len), Math.sin((2 * Math.PI * n) / len)]);
  const power = new Float64Array(201);
  let count = 0;
  for (let at = 0; at + len <= signal.length; at += len / 2, count += 1) {
    const windowed = Float64Array.from({ length: len }, (_, n) => signal[at + n] * (0.5 - 0.5 * turns[n][0]));
    for (let k = 0; k < power.length; k++) {
      let [re, im] = [0, 0];
      for (let n = 0, turn = 0; n < len; n++, turn = (turn + k) % len) {
        re += windowed[n] * turns[turn][0];
        im += windowed[n] * turns[turn][1];
      }
      power[k] += re * re + im * im;
    }
  }
  return power.map((p) => (4 / len) * Math.sqrt(p / count));
}

test("a hundred voices play without a gap", async () => {
  const made = await page();
  const played = await made.evaluate(async ([seconds, models]) => {
    const { open, prepare, HtexNode } = await import("/htex/index.js");
    const texture = await open("/fixtures/vinyl.htex");
    const context = new AudioContext({ sampleRate: 48000, latencyHint: "playback" });
    await context.resume();
    await prepare(context);
    const watch = `registerProcessor("watch", class extends AudioWorkletProcessor {
      constructor() { super(); this.next = null; this.gaps = 0; this.quanta = 0; this.silent = 0;
        this.port.onmessage = () => this.port.postMessage([this.gaps, this.quanta, this.silent]); }
      process([input]) {
        if (this.next !== null && currentFrame !== this.next) this.gaps += 1;
        this.next = currentFrame + 128; this.quanta += 1;
        if (input[0] && input[0].every((x) => x === 0)) this.silent += 1;
        return true; } });`;
    await context.audioWorklet.addModule(URL.createObjectURL(new Blob([watch], { type: "text/javascript" })));
    const meter = new AudioWorkletNode(context, "watch");
    const nodes = [];
    for (let i = 0; i < 100; i++) {
      const node = new HtexNode(context, texture, { model: models[i % models.length], seed: i, gain: 0.01 });
      node.speed.value = 80;
      node.force.value = 0.5;
      node.connect(meter);
      nodes.push(node);
    }
    meter.connect(context.destination);
    await new Promise((done) => setTimeout(done, 1000));
    const count = () =>
      new Promise((done) => {
        meter.port.onmessage = ({ data }) => done(data);
        meter.port.postMessage(0);
      });
    const [began, before] = [context.currentTime, await count()];
    const clock = performance.now();
    const moved = setInterval(() => nodes.forEach((node, i) => (node.speed.value = 60 + ((i * 7 + performance.now() / 50) % 40))), 20);
    await new Promise((done) => setTimeout(done, 1000 * seconds));
    clearInterval(moved);
    const elapsed = (performance.now() - clock) / 1e3;
    const after = await count();
    const result = {
      gaps: after[0] - before[0],
      quanta: after[1] - before[1],
      silent: after[2] - before[2],
      played: context.currentTime - began,
      elapsed,
      errors: nodes.filter((node) => node.error).length,
    };
    await context.close();
    return result;
  }, [Number(HTEX_SECONDS), MODELS]);
  console.log(JSON.stringify(played));
  assert.equal(played.errors, 0);
  assert.equal(played.gaps, 0);
  assert.equal(played.silent, 0);
  // The clock of the context advances only while blocks are rendered in time. Other programs may
  // delay it a little.
  assert.ok(played.played > 0.9 * played.elapsed, JSON.stringify(played));
  await made.close();
});

test("a module plays in a worker, and one that does not return is ended", async () => {
  const made = await page();
  const played = await made.evaluate(async () => {
    const { open, prepare, HtexNode, GuardedWorker } = await import("/htex/index.js");
    const context = new AudioContext({ sampleRate: 48000 });
    await context.resume();
    await prepare(context);
    const texture = await open("/fixtures/bursts.htex");
    const node = new HtexNode(context, texture, { model: "bursts", seed: 7 });
    const analyser = new AnalyserNode(context);
    node.connect(analyser).connect(context.destination);
    node.speed.value = 80;
    node.force.value = 0.5;
    await node.ready;
    await new Promise((done) => setTimeout(done, 1500));
    const heard = new Float32Array(2048);
    analyser.getFloatTimeDomainData(heard);
    const rms = Math.hypot(...heard) / Math.sqrt(heard.length);
    node.stop();

    const modules = [await (await fetch("/fixtures/endless.wasm")).arrayBuffer()];
    const worker = new GuardedWorker({ limit: 500 });
    const start = performance.now();
    const endless = await open("/fixtures/bursts.htex", { modules, embedded: false });
    // None of these modules runs in the page: neither a module that would not return, nor a module
    // of an untrusted author.
    const attempt = (run) => {
      try {
        return `${run()}`;
      } catch (error) {
        return `${error.code}: ${error.message}`;
      }
    };
    const refused = [() => endless.voice(), () => texture.voice({ model: "bursts" }), () => texture.level({ model: "bursts" }), () => endless.spectrum([50])].map(attempt);
    // The same for a module that does not return from its start function.
    const looping = Uint8Array.of(0, 97, 115, 109, 1, 0, 0, 0, 1, 4, 1, 96, 0, 0, 3, 2, 1, 0, 8, 1, 0, 10, 9, 1, 7, 0, 3, 64, 12, 0, 11, 11);
    const started = await open("/fixtures/vinyl.htex", { modules: [looping] });
    refused.push(attempt(() => started.voice()));
    const looped = new GuardedWorker({ limit: 500 });
    const stopped = await looped.render(started, 100).catch((error) => `${error.code}: ${error.message}`);
    const builtIn = texture.voice({ model: "sbeta" }).render(8).length;
    const options = { model: "bursts", seed: 7, rate: 48000, motion: { speed: 80, force: 0.5 } };
    const rendered = await worker.render(texture, 480, options);
    const voice = (await open("/fixtures/bursts.htex", { trusted: true })).voice(options);
    const same = voice.render(480).every((x, i) => x === rendered[i]);
    const error = await worker.render(endless, 100, options).catch((error) => ({ code: error.code, message: error.message }));
    const later = await worker.render(texture, 100, options).catch((error) => error.message);
    return { rms, same, error, later, refused, stopped, builtIn, gain: [node.gain.value, 0.1 / texture.manifest.representations[0].at[0].level_rms], waiting: worker.waiting.size, ms: performance.now() - start };
  });
  assert.ok(played.rms > 0.01, JSON.stringify(played));
  assert.ok(played.same);
  assert.equal(played.waiting, 0);
  assert.equal(played.error.code, "model");
  assert.match(played.error.message, /500 ms/);
  assert.match(played.later, /500 ms/);
  assert.ok(played.ms < 6000);
  for (const text of played.refused) assert.match(text, /^untrusted: .*GuardedWorker.*trusted: true/);
  assert.match(played.stopped, /^model: .*500 ms/);
  assert.equal(played.builtIn, 8);
  assert.ok(Math.abs(played.gain[0] / played.gain[1] - 1) < 1e-5, `${played.gain}`);
  assert.deepEqual(made.errors, []);
  await made.close();
});

test("the example plays a file that is dropped", async () => {
  const made = await page("example/index.html");
  await made.setInputFiles("input[type=file]", path.join(HTEX_FIXTURES, "vinyl.htex"));
  await made.waitForSelector("#surface[data-ready]");
  const box = await (await made.$("#surface")).boundingBox();
  await made.mouse.move(box.x + 20, box.y + 40);
  await made.mouse.down();
  for (let x = 20; x < box.width - 20; x += 6) await made.mouse.move(box.x + x, box.y + 40 + 20 * Math.sin(x / 30));
  await made.waitForFunction(() => Number(document.querySelector("#level").dataset.rms) > 0.005);
  if (HTEX_PICTURE) await made.screenshot({ path: HTEX_PICTURE, fullPage: true });
  assert.deepEqual(made.errors, []);
  await made.close();
});

test("the catalogue of a library plays a texture that is rendered in the page", async () => {
  const made = await page();
  await made.addInitScript(() => {
    const { start } = AudioBufferSourceNode.prototype;
    AudioBufferSourceNode.prototype.start = function (...when) {
      const samples = this.buffer.getChannelData(0);
      window.heard = Math.sqrt(samples.reduce((sum, x) => sum + x * x, 0) / samples.length);
      start.apply(this, when);
    };
  });
  await made.goto(`${here.address}/fixtures/catalogue/index.html`);
  await made.click("button.play");
  await made.waitForFunction(() => window.heard !== undefined || document.querySelector("button.play").textContent === "!");
  assert.equal(await made.textContent("button.play"), "▶", await made.getAttribute("button.play", "title"));
  assert.ok(Math.abs((await made.evaluate(() => window.heard)) - 0.1) < 1e-3);
  assert.deepEqual(made.errors, []);
  await made.close();
});
