// Prints how long the page takes, and what it takes of processor and memory. Numbers are of this machine; nothing is asserted.
//
//   HTEX_STUDIO=DIR node numbers.mjs

import { mkdtemp, readdir, readFile, stat } from "node:fs/promises";
import { tmpdir } from "node:os";
import path from "node:path";
import { gzipSync } from "node:zlib";

import { FILE, HTEX_STUDIO, goTo, htex, launch, openStudio, serve, shaping } from "./studio.mjs";

const print = (what, value) => console.log(`${what.padEnd(74)} ${value}`);
const ms = (x) => `${x.toFixed(1)} ms`;
const quantile = (all, part) => [...all].sort((a, b) => a - b)[Math.min(Math.floor(part * all.length), all.length - 1)];
const median = (all) => quantile(all, 0.5);

/** Time from the navigation to a page that plays. */
async function interactive(browser, address, { kbps } = {}) {
  const context = await browser.newContext({ viewport: { width: 1400, height: 900 } });
  const page = await context.newPage();
  if (kbps) {
    const session = await context.newCDPSession(page);
    await session.send("Network.enable");
    await session.send("Network.emulateNetworkConditions", { offline: false, latency: 20, downloadThroughput: (kbps * 1000) / 8, uploadThroughput: (kbps * 1000) / 8 });
  }
  await page.goto(address);
  await page.waitForFunction(() => performance.getEntriesByName("ready").length > 0);
  const time = await page.evaluate(() => performance.getEntriesByName("ready")[0].startTime);
  await context.close();
  return time;
}

/** The processes that this one has begun, and theirs: numbers of `/proc/PID/stat`. */
async function family() {
  const all = new Map();
  for (const name of await readdir("/proc")) {
    if (!/^\d+$/.test(name)) continue;
    const text = await readFile(`/proc/${name}/stat`, "utf8").catch(() => null);
    const fields = text?.slice(text.lastIndexOf(")") + 2).split(" ");
    if (fields) all.set(Number(name), { parent: Number(fields[1]), ticks: Number(fields[11]) + Number(fields[12]), pages: Number(fields[21]) });
  }
  const isOwn = (pid) => pid > 1 && (pid === process.pid || isOwn(all.get(pid)?.parent ?? 0));
  return [...all].filter(([pid]) => pid !== process.pid && isOwn(pid)).map(([, one]) => one);
}

/** Seconds of processor that the browser's processes have taken. */
async function processorSeconds() {
  return (await family()).reduce((sum, { ticks }) => sum + ticks, 0) / 100;
}

async function share(seconds) {
  const before = await processorSeconds();
  await new Promise((resolve) => setTimeout(resolve, 1e3 * seconds));
  return `${((100 * ((await processorSeconds()) - before)) / seconds).toFixed(2)} % of a core`;
}

async function sizes() {
  const folder = path.join(HTEX_STUDIO, "static");
  const names = await readdir(path.join(folder, "assets"));
  const packed = async (test) => {
    const all = await Promise.all(names.filter(test).map((name) => readFile(path.join(folder, "assets", name))));
    return all.reduce((sum, bytes) => sum + gzipSync(bytes, { level: 9 }).length, 0);
  };
  const kB = (bytes) => `${(bytes / 1e3).toFixed(1)} kB gzipped`;
  const html = await readFile(path.join(folder, "index.html"), "utf8");
  const index = await packed((name) => /\.(js|css)$/.test(name) && html.includes(name));
  print("page at its start: script (the package's, too) and style sheet", kB(index));
  print("screen of recordings, when it is first shown (uPlot)", kB(await packed((name) => /^record.*\.(js|css)$/.test(name))));
  print("worklet and workers", kB(await packed((name) => /^(processor|worker|author-worker|reading-worker).*\.js$/.test(name))));
  print("player module", kB(await packed((name) => /^htex-(?!author|import).*\.wasm$/.test(name))));
  print("author module", kB(await packed((name) => /^htex-author.*\.wasm$/.test(name))));
  print("module of imports", kB(await packed((name) => /^htex-import.*\.wasm$/.test(name))));
  print("studio.html", `${((await stat(path.join(HTEX_STUDIO, "studio.html"))).size / 1e6).toFixed(2)} MB`);
}

/** Times of fits of a recording of 11 MB: each page's first, and those after it. */
async function fits(pages, each) {
  const file = path.join(await mkdtemp(path.join(tmpdir(), "htex-studio-")), "recording.csv");
  htex("simulate", "--surface", "fine-fabric", "--seconds", "10", "-o", file);
  const [first, later] = [[], []];
  for (let i = 0; i < pages; i++) {
    const own = await openStudio(browser, FILE);
    await goTo(own, "Record");
    await own.locator("input[type=file]").setInputFiles(file);
    await own.getByRole("img", { name: /Signal of/ }).waitFor();
    for (let k = 1; k <= each; k++) {
      await own.getByRole("button", { name: "Fit all models" }).click();
      await own.waitForFunction((count) => performance.getEntriesByName("fit").length === count, k);
    }
    const times = await own.evaluate(() => performance.getEntriesByName("fit").map(({ duration }) => duration));
    first.push(times[0]);
    later.push(...times.slice(1));
    await own.context().close();
  }
  return [first, later];
}

/** A worklet behind the node, which tells when samples that are not zero come, and of what level they are. */
const TAP = `registerProcessor("tap", class extends AudioWorkletProcessor {
  process([[input]]) {
    const loud = input ? input.reduce((most, x) => Math.max(most, Math.abs(x)), 0) : 0;
    if ((loud > 0) !== this.was) this.port.postMessage({ isLoud: (this.was = loud > 0) });
    return true;
  }
});`;

/** Time from an input event to the first sample that is not zero in the audio thread. */
async function inputToSample(page) {
  await page.evaluate(async (text) => {
    const { audioContext, playingNode } = htexStudio;
    await audioContext().audioWorklet.addModule(`data:text/javascript;base64,${btoa(text)}`);
    const tap = new AudioWorkletNode(audioContext(), "tap");
    playingNode().connect(tap);
    window.heardAt = [];
    window.pressedAt = 0;
    tap.port.onmessage = ({ data }) => data.isLoud && window.heardAt.push(performance.now() - window.pressedAt);
    document.querySelector(".pad canvas").addEventListener("pointermove", (event) => (window.pressedAt ||= event.timeStamp), { capture: true });
  }, TAP);
  const pad = await page.locator(".pad canvas").boundingBox();
  const times = [];
  for (let i = 0; i < 20; i++) {
    await page.evaluate(() => ((window.heardAt = []), (window.pressedAt = 0)));
    await page.mouse.move(pad.x + 60, pad.y + 60);
    await page.mouse.down();
    await page.evaluate(() => (window.pressedAt = 0));
    for (let step = 1; step <= 12; step++) await page.mouse.move(pad.x + 60 + 9 * step, pad.y + 60);
    await page.waitForTimeout(120);
    times.push(...(await page.evaluate(() => window.heardAt.slice(0, 1))));
    await page.mouse.up();
    await page.waitForTimeout(500);
  }
  return times;
}

/** Time from the input of a slider to the fade to the samples of the texture that it made. */
async function sliderToSamples(page) {
  return page.evaluate(async () => {
    const node = htexStudio.playingNode();
    const times = [];
    const load = node.load.bind(node);
    let began = 0;
    node.load = async (...given) => {
      const of = began;
      await load(...given);
      times.push(performance.now() - of);
    };
    for (let i = 0; i < 120; i++) {
      await new Promise((resolve) => requestAnimationFrame(resolve));
      began = performance.now();
      htexStudio.setMacro("brighter", Math.sin(i / 10) / 2);
      await new Promise((resolve) => setTimeout(resolve, 40));
    }
    delete node.load;
    return times;
  });
}

/** The main thread's work in the frames of a drag across the bars. */
async function work(page) {
  await page.evaluate(() => {
    window.frames_ = [];
    const seen = new PerformanceObserver((list) => list.getEntries().forEach((entry) => window.frames_.push(entry.duration)));
    window.tasks = [];
    seen.observe({ type: "long-animation-frame", buffered: false });
    const channel = new MessageChannel();
    let began = 0;
    channel.port1.onmessage = () => window.tasks.push(performance.now() - began);
    const frame = (now) => {
      began = performance.now();
      channel.port2.postMessage(0);
      if (!window.isDone) requestAnimationFrame(frame);
    };
    requestAnimationFrame(frame);
  });
  const box = await page.locator(".spectrum canvas").boundingBox();
  await page.mouse.move(box.x + 100, box.y + 150);
  await page.mouse.down();
  for (let i = 0; i < 150; i++) {
    await page.mouse.move(box.x + 100 + 4 * i, box.y + 150 + 60 * Math.sin(i / 9));
    await page.waitForTimeout(16);
  }
  await page.mouse.up();
  return page.evaluate(() => ((window.isDone = true), window.tasks));
}

/** Growth of the page's memory by edits, bytes. */
async function growth(page, edits) {
  const session = await page.context().newCDPSession(page);
  const memory = async () => {
    await session.send("HeapProfiler.collectGarbage");
    const { usedSize, backingStorageSize = 0 } = await session.send("Runtime.getHeapUsage");
    return { heap: usedSize + backingStorageSize, resident: await residentBytes() };
  };
  const run = (count) =>
    page.evaluate(async (times) => {
      for (let i = 0; i < times; i++) {
        const handle = htexStudio.handles.value[i % 30];
        htexStudio.moveHandle(i % 30, handle.hz, -8 - (i * 7) % 20, `edit ${i}`);
        if (i % 20 === 19) await new Promise((resolve) => setTimeout(resolve, 0));
      }
    }, count);
  await run(600);
  const before = await memory();
  await run(edits);
  const after = await memory();
  return { heap: after.heap - before.heap, resident: after.resident - before.resident };
}

/** Memory of the browser's largest process: the page's. */
async function residentBytes() {
  return 4096 * Math.max(...(await family()).map(({ pages }) => pages));
}

const only = process.argv[2];
const wanted = (name) => !only || only === name;
const browser = await launch();
const server = await serve();
await sizes();
if (wanted("start")) {
  const file = [];
  for (let i = 0; i < 7; i++) file.push(await interactive(browser, FILE));
  print("interactive, studio.html from disk: median and most of seven", `${ms(median(file))}, ${ms(Math.max(...file))}`);
  for (const isCompressed of [true, false]) {
    const own = await serve({ isCompressed });
    const net = [];
    for (let i = 0; i < 3; i++) net.push(await interactive(browser, own.address, { kbps: 5000 }));
    await own.close();
    print(`interactive, folder at 5 Mbit/s and 20 ms, ${isCompressed ? "" : "not "}compressed by the server`, `${ms(median(net))}, ${ms(Math.max(...net))}`);
  }
}
if (wanted("fit")) {
  const [first, later] = await fits(5, 6);
  print("fit of a recording of 11 MB in the worker, first of a page: median and most", `${ms(median(first))}, ${ms(Math.max(...first))}`);
  print("the same again", `${ms(median(later))}, ${ms(Math.max(...later))}`);
}
const page = await openStudio(browser, FILE);
await page.mouse.click(700, 20);
await page.waitForTimeout(6000);
print("idle, all processes of the browser", await share(5));
if (wanted("input")) {
  const times = await inputToSample(page);
  print("input event to first sample that is not zero: median, p95", `${ms(median(times))}, ${ms(quantile(times, 0.95))} of ${times.length}`);
}
await shaping(page);
await page.getByRole("button", { name: "Back and forth" }).click();
await page.waitForTimeout(500);
print("one voice plays, the finger slides back and forth, all drawn", await share(5));
if (wanted("slider")) {
  const times = await sliderToSamples(page);
  print("slider to new samples: median, p95", `${ms(median(times))}, ${ms(quantile(times, 0.95))} of ${times.length}`);
}
if (wanted("voices")) {
  await page.keyboard.press("Escape");
  await page.evaluate(() => {
    const node = htexStudio.playingNode();
    const { context } = node;
    void context.resume();
    context.suspend = async () => {};
    window.eight = Array.from({ length: 8 }, (_, seed) => {
      const one = new node.constructor(context, htexStudio.texture.value, { seed, motion: { speed: 80, force: 0.4 } });
      one.speed.value = 80;
      one.force.value = 0.4;
      one.connect(context.destination);
      return one;
    });
  });
  await page.waitForTimeout(500);
  print("eight voices play, nothing moves in the page", await share(5));
  await page.evaluate(() => (window.eight.forEach((one) => one.stop()), delete htexStudio.playingNode().context.suspend));
  await page.waitForTimeout(500);
  await page.evaluate(() => htexStudio.playingNode().context.resume());
  print("the same without the eight", await share(5));
}
await goTo(page, "Shape");
if (wanted("frames")) {
  const tasks = await work(page);
  print("main thread's work in a frame while bars are drawn: median, p95, most", `${ms(median(tasks))}, ${ms(quantile(tasks, 0.95))}, ${ms(Math.max(...tasks))} of ${tasks.length}`);
}
if (wanted("memory")) {
  await page.keyboard.press("Escape");
  const { heap, resident } = await growth(page, 10_000);
  print("growth by 10,000 edits: heap with buffers, resident", `${(heap / 1e6).toFixed(1)} MB, ${(resident / 1e6).toFixed(1)} MB`);
}
await browser.close();
await server.close();
