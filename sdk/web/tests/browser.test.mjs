// The package in Chromium: worklet, worker, page and bundle.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { createServer } from "node:http";
import { cp, mkdir, mkdtemp, readFile, writeFile } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";

import { chromium } from "playwright-core";

import { HTEX_FIXTURES, HTEX_PACKAGE, MODELS, difference, samples } from "./fixtures.mjs";

const { HTEX_CHROMIUM = "/usr/bin/chromium", HTEX_EXAMPLE, HTEX_PICTURE, HTEX_SECONDS = "60" } = process.env;
const TYPES = { ".js": "text/javascript", ".html": "text/html", ".wasm": "application/wasm", ".css": "text/css" };

let folder, server, address, browser;

/** A static folder: the package, the fixtures, the example, and an empty page. */
before(async () => {
  folder = await mkdtemp(path.join(tmpdir(), "htex-browser-"));
  await cp(HTEX_PACKAGE, path.join(folder, "htex"), { recursive: true });
  await cp(HTEX_FIXTURES, path.join(folder, "fixtures"), { recursive: true });
  await cp(HTEX_EXAMPLE, path.join(folder, "example"), { recursive: true });
  await cp(HTEX_PACKAGE, path.join(folder, "example/htex"), { recursive: true });
  await writeFile(path.join(folder, "empty.html"), "<!doctype html><title>empty</title><div id=surface style='width:600px;height:300px'></div>");
  server = createServer(async (request, response) => {
    if (request.url === "/favicon.ico") return void response.writeHead(204).end();
    const file = path.join(folder, path.normalize(new URL(request.url, "http://x").pathname));
    try {
      const type = TYPES[path.extname(file)] ?? "application/octet-stream";
      response.setHeader("content-type", type).end(await readFile(file));
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  address = `http://127.0.0.1:${server.address().port}`;
  const args = ["--no-sandbox", "--disable-gpu", "--autoplay-policy=no-user-gesture-required", "--disable-background-networking"];
  browser = await chromium.launch({ executablePath: HTEX_CHROMIUM, args });
});

after(async () => {
  await browser?.close();
  server?.close();
});

async function page(at = "empty.html") {
  const made = await browser.newPage({ viewport: { width: 1000, height: 700 } });
  made.errors = [];
  made.on("pageerror", (error) => made.errors.push(String(error)));
  made.on("console", (message) => message.type() === "error" && made.errors.push(message.text()));
  await made.goto(`${address}/${at}`);
  return made;
}

/** Renders a node offline, in the page; returns its samples, or what a function makes of them. */
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

test("the worklet's samples are those of the command", async () => {
  const made = await page();
  for (const model of MODELS) {
    const heard = await offline(made, "vinyl.htex", { model, seed: 7, gain: 1 });
    assert.equal(difference(heard, await samples(`${model}.wav`)), -1, model);
  }
  const heard = await offline(made, "bursts.htex", { model: "bursts", seed: 7, gain: 1, trusted: true });
  assert.equal(difference(heard, await samples("bursts.wav")), -1);
  assert.deepEqual(made.errors, []);
  await made.close();
});

test("what the worklet plays has the spectrum of the texture", async () => {
  const made = await page();
  const { frequency_hz, magnitude } = JSON.parse(await readFile(path.join(HTEX_FIXTURES, "spectrum.json"), "utf8"));
  const [{ speed_mm_s: speed, force_n: force }] = JSON.parse(await readFile(path.join(HTEX_FIXTURES, "info.json"), "utf8")).conditions;
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

/** Magnitudes in steps of 5 Hz, as `htex process` reads them: segments of 0.2 s, half overlapping, Hann window, RMS. */
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
  // The clock of the context goes on only while blocks are rendered in time; other programs may hold it up a little.
  assert.ok(played.played > 0.9 * played.elapsed, JSON.stringify(played));
  await made.close();
});

test("a module plays in a worker, and one that does not return is ended", async () => {
  const made = await page();
  const played = await made.evaluate(async () => {
    const { open, prepare, HtexNode, GuardedWorker } = await import("/htex/index.js");
    const context = new AudioContext({ sampleRate: 48000 });
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
    const options = { model: "bursts", seed: 7, rate: 48000, motion: { speed: 80, force: 0.5 } };
    const rendered = await worker.render(texture, 480, options);
    const voice = texture.voice(options);
    const same = voice.render(480).every((x, i) => x === rendered[i]);
    const error = await worker.render(endless, 100, options).catch((error) => ({ code: error.code, message: error.message }));
    const later = await worker.render(texture, 100, options).catch((error) => error.message);
    return { rms, same, error, later, waiting: worker.waiting.size, ms: performance.now() - start };
  });
  assert.ok(played.rms > 0.01, JSON.stringify(played));
  assert.ok(played.same);
  assert.equal(played.waiting, 0);
  assert.equal(played.error.code, "model");
  assert.match(played.error.message, /500 ms/);
  assert.match(played.later, /500 ms/);
  assert.ok(played.ms < 3000);
  assert.deepEqual(made.errors, []);
  await made.close();
});

test("the pointer moves the finger", async () => {
  const made = await page();
  await made.evaluate(async () => {
    const { followPointer } = await import("/htex/index.js");
    window.motions = [];
    followPointer(document.querySelector("#surface"), (motion) => window.motions.push(motion));
  });
  await made.mouse.move(50, 100);
  await made.mouse.down();
  for (let x = 50; x <= 450; x += 10) {
    await made.mouse.move(x, 100);
    await new Promise((done) => setTimeout(done, 10));
  }
  await new Promise((done) => setTimeout(done, 200));
  await made.mouse.up();
  const motions = await made.evaluate(() => window.motions);
  const fastest = Math.max(...motions.map((motion) => motion.speed));
  const last = motions.at(-1);
  // 400 pixels are 105.8 mm.
  assert.ok(Math.abs(last.position - 105.8) < 0.5, `${last.position}`);
  assert.ok(fastest > 50 && fastest < 2000, `${fastest}`);
  assert.ok(motions.some((motion) => motion.speed === 0 && motion.force > 0), "rests");
  assert.equal(last.force, 0);
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

test("a bundle of Vite plays", async () => {
  const app = path.join(folder, "app");
  await mkdir(path.join(app, "public"), { recursive: true });
  await cp(path.join(HTEX_FIXTURES, "vinyl.htex"), path.join(app, "public/cloth.htex"));
  await mkdir(path.join(app, "node_modules"));
  await cp(HTEX_PACKAGE, path.join(app, "node_modules/htex"), { recursive: true });
  const readme = await readFile(path.join(HTEX_PACKAGE, "README.md"), "utf8");
  const [, example] = [...readme.matchAll(/```js\n([\s\S]*?)```/g)].map(([, code]) => code);
  await writeFile(path.join(app, "main.js"), `${example}\nwindow.node = node; window.context = context;`);
  await writeFile(path.join(app, "index.html"), '<!doctype html><div id=surface style="width:600px;height:300px"></div><script type=module src=/main.js></script>');
  const tool = fileURLToPath(new URL("./node_modules/vite/bin/vite.js", import.meta.url));
  execFileSync(process.execPath, [tool, "build", "--base", "./"], { cwd: app, stdio: "pipe" });
  const made = await page("app/dist/index.html");
  await made.waitForFunction(() => window.node);
  const error = await made.evaluate(async () => {
    await window.node.ready;
    window.node.speed.value = 80;
    window.node.force.value = 0.5;
    const analyser = new AnalyserNode(window.context);
    window.node.connect(analyser);
    await new Promise((done) => setTimeout(done, 500));
    const heard = new Float32Array(2048);
    analyser.getFloatTimeDomainData(heard);
    return window.node.error?.message ?? (heard.some((x) => x !== 0) ? null : "silent");
  });
  assert.equal(error, null);
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
  await made.goto(`${address}/fixtures/catalogue/index.html`);
  await made.click("button.play");
  await made.waitForFunction(() => window.heard !== undefined || document.querySelector("button.play").textContent === "!");
  assert.equal(await made.textContent("button.play"), "▶", await made.getAttribute("button.play", "title"));
  assert.ok(Math.abs((await made.evaluate(() => window.heard)) - 0.1) < 1e-3);
  assert.deepEqual(made.errors, []);
  await made.close();
});
