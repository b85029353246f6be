// Loading in a page, with servers that fail, pages that are not secure, and browsers that cannot
// send a module to a worklet.

import assert from "node:assert/strict";
import test, { after, before } from "node:test";

import { rms, start } from "./browser.mjs";

let here;
before(async () => {
  here = await start();
});
after(() => here?.close());

/**
 * Returns the error that an expression throws in a page. In the expression, `htex` is the package.
 */
const thrown = (made, code) =>
  made.evaluate(`(async () => { const htex = await import("/htex/index.js"); try { ${code} } catch (e) { return { name: e.name, code: e.code, message: e.message }; } })()`);

function answerOnce(name, status) {
  let asked = 0;
  here.answer = (pathname, response) => {
    if (!pathname.endsWith(name)) return false;
    asked += 1;
    if (asked > 1) return false;
    response.writeHead(status).end();
    return true;
  };
}

test("a server that fails once does not spoil the page", async () => {
  for (const [name, code] of [["htex.wasm", "await htex.open('/cloth.htex')"], ["cloth.htex", "await htex.open('/cloth.htex')"], ["processor.js", "await htex.prepare(window.context ??= new AudioContext())"]]) {
    const made = await here.page();
    answerOnce(name, 503);
    const error = await thrown(made, code);
    assert.deepEqual([error?.name, error?.code], ["HtexError", "io"], name);
    assert.match(error.message, name === "processor.js" ? /processor\.js.*again/ : /503.*again/);
    assert.equal(await thrown(made, code), undefined, name);
    await made.close();
  }
  here.answer = null;
  const made = await here.page();
  assert.match((await thrown(made, "await htex.open('/absent.htex')")).message, /404.*address/);
  await made.close();
});

test("library and texture are fetched at the same time, and the library is compiled while it arrives", async () => {
  // The library waits for the request of the texture.
  let told;
  const asked = new Promise((resolve) => (told = resolve));
  let inTime = true;
  here.answer = async (pathname) => {
    if (pathname === "/cloth.htex") told();
    if (pathname.endsWith("htex.wasm")) await Promise.race([asked, new Promise((done) => setTimeout(done, 3000)).then(() => (inTime = false))]);
    return false;
  };
  const made = await here.page();
  const opened = await made.evaluate(async () => {
    let streamed = 0;
    const { compileStreaming } = WebAssembly;
    WebAssembly.compileStreaming = (response) => ((streamed += 1), compileStreaming(response));
    const { open } = await import("/htex/index.js");
    return [(await open("/cloth.htex")).name, streamed];
  });
  here.answer = null;
  assert.deepEqual(opened, ["vinyl", 1]);
  assert.ok(inTime);
  await made.close();
});

test("a server that does not know the type of the library, and a browser that cannot stream", async () => {
  const made = await here.page();
  here.answer = (pathname, response) => (pathname.endsWith("htex.wasm") && response.setHeader("content-type", "application/octet-stream"), false);
  await made.route("**/htex.wasm", async (route) => {
    const response = await route.fetch();
    await route.fulfill({ response, headers: { ...response.headers(), "content-type": "application/octet-stream" } });
  });
  assert.equal(await thrown(made, "await htex.open('/cloth.htex')"), undefined);
  here.answer = null;
  await made.close();
  const other = await here.page();
  assert.equal(await thrown(other, "delete WebAssembly.compileStreaming; await htex.open('/cloth.htex')"), undefined);
  await other.close();
});

test("a page that is not secure is told so", async () => {
  const made = await here.page("empty.html", { origin: here.elsewhere });
  assert.equal(await made.run("window.isSecureContext"), false);
  const error = await thrown(made, "await htex.prepare(new AudioContext())");
  assert.deepEqual([error.name, error.code], ["HtexError", "unsupported"]);
  assert.match(error.message, /https or localhost.*elsewhere\.example/);
  // Functions that need no worklet work.
  assert.equal(await thrown(made, "(await htex.open('/cloth.htex')).voice().render(8)"), undefined);
  await made.close();
});

test("calls in the wrong order or with the wrong things say what to do", async () => {
  const made = await here.page();
  const before = "const context = new AudioContext(), texture = await htex.open('/cloth.htex');";
  for (const [code, text] of [
    ["new htex.HtexNode(context, texture)", /await prepare\(context\)/],
    ["await htex.prepare(context); new htex.HtexNode(context, htex.open('/cloth.htex'))", /await open/],
    ["await htex.prepare(context); new htex.HtexNode(context, texture, { model: 'none' })", /none/],
    ["await htex.prepare(context); new htex.HtexNode(context, texture, { rate: 8000 })", /rate comes from the context/],
    ["await htex.prepare(context); new htex.HtexNode(context, texture, { modle: 'ar' })", /did you mean `model`/],
    ["await htex.prepare(context); texture.free(); new htex.HtexNode(context, texture)", /freed/],
    ["await htex.prepare(context); const node = new htex.HtexNode(context, texture); node.stop(); await node.load(texture)", /was stopped/],
    ["await htex.prepare({})", /AudioContext/],
    ["await htex.open('/cloth.htex', { embeded: false })", /did you mean `embedded`/],
  ]) {
    const error = await thrown(made, before + code);
    assert.equal(error?.name, "HtexError", code);
    assert.match(error.message, text);
  }
  const kinds = "const response = await fetch('/cloth.htex'); const bytes = await response.clone().arrayBuffer();";
  const each = "[bytes, new Uint8Array(bytes), new DataView(bytes), new Blob([bytes]), new File([bytes], 'cloth.htex'), response, new URL('/cloth.htex', location)]";
  assert.equal(await thrown(made, `${kinds} for (const source of ${each}) if ((await htex.open(source)).name !== 'vinyl') throw new Error(source);`), undefined);
  assert.match((await thrown(made, `${kinds} await response.text(); await htex.open(response)`)).message, /was read already/);
  await made.close();
});

/** Plays for half a second in the page. Returns the RMS, and the node's error. */
const PLAY = `async (options = {}) => {
  const { open, prepare, HtexNode } = await import("/htex/index.js");
  const context = new AudioContext({ sampleRate: 48000 });
  await context.resume();
  await prepare(context);
  window.node = new HtexNode(context, await open("/fixtures/" + (options.file ?? "vinyl.htex")), { motion: { speed: 80, force: 0.5 } });
  node.speed.value = 80;
  node.force.value = 0.5;
  await record(node);
  await node.ready;
  await new Promise((done) => setTimeout(done, 500));
  await node.load(node.texture, { motion: { speed: 80, force: 0.5 } });
  await new Promise((done) => setTimeout(done, 100));
  return { heard: (await recorded()).slice(-4800), error: node.error?.message };
}`;

test("a browser that sends no compiled library to other threads sends its bytes", async () => {
  for (const file of ["vinyl.htex", "bursts.htex"]) {
    const made = await here.page();
    await made.evaluate(() => {
      // Simulates the behaviour of Safari.
      const isModule = (value) => value instanceof WebAssembly.Module || (value && typeof value === "object" && !ArrayBuffer.isView(value) && Object.values(value).some(isModule));
      const refuse = (value) => {
        if (isModule(value)) throw new DOMException("a module cannot be cloned", "DataCloneError");
      };
      globalThis.AudioWorkletNode = class extends AudioWorkletNode {
        constructor(context, name, options) {
          refuse(options?.processorOptions);
          super(context, name, options);
        }
      };
      for (const type of [MessagePort, Worker]) {
        const { postMessage } = type.prototype;
        type.prototype.postMessage = function (message, ...rest) {
          refuse(message);
          return postMessage.call(this, message, ...rest);
        };
      }
    });
    const { heard, error } = await made.evaluate(`(${PLAY})({ file: "${file}" })`);
    assert.equal(error, undefined);
    assert.ok(rms(heard) > 0.03, `${file}: ${rms(heard)}`);
    assert.deepEqual(made.errors, []);
    await made.close();
  }
});

test("an error of the worklet itself reaches node.onerror", async () => {
  const made = await here.page();
  const told = await made.evaluate(async (play) => {
    await new Function(`return ${play}`)()();
    let events = 0;
    window.node.addEventListener("error", () => (events += 1));
    const heard = new Promise((done) => (window.node.onerror = ({ error }) => setTimeout(() => done([error.name, error.code, events, error.message]), 100)));
    await window.node.context.audioWorklet.addModule("data:text/javascript,Array.prototype.forEach = () => { throw new Error('broken') }");
    return heard;
  }, PLAY);
  assert.deepEqual(told.slice(0, 3), ["HtexError", "internal", 1]);
  assert.match(told[3], /audio worklet failed/);
  await made.close();
});

test("the voices and textures of nodes that were stopped are freed", async () => {
  const made = await here.page();
  const counts = await made.evaluate(async () => {
    const { open, prepare, HtexNode } = await import("/htex/index.js");
    const context = new AudioContext({ sampleRate: 48000 });
    await context.resume();
    // Counts the calls to the library in the audio thread.
    const counting = `const { Instance } = WebAssembly; globalThis.counts = {};
      WebAssembly.Instance = function (...values) {
        const made = new Instance(...values);
        const exports = Object.fromEntries(Object.entries(made.exports).map(([name, of]) => [name, typeof of !== "function" ? of : (...all) => {
          counts[name] = (counts[name] ?? 0) + 1; return of(...all); }]));
        return { exports };
      };
      registerProcessor("counts", class extends AudioWorkletProcessor {
        constructor() { super(); this.port.postMessage(counts); } process() { return false; } });`;
    await context.audioWorklet.addModule(`data:text/javascript,${encodeURIComponent(counting)}`);
    await prepare(context);
    for (let i = 0; i < 20; i++) {
      const texture = await open("/fixtures/vinyl.htex");
      const node = new HtexNode(context, texture, { model: "ar", seed: i });
      node.connect(context.destination);
      await node.load(texture, { model: "bands" });
      await node.load(await open("/fixtures/vinyl.htex"), { model: "sbeta" });
      node.stop();
      texture.free();
    }
    // The same in a suspended context.
    await new Promise((done) => setTimeout(done, 300));
    await context.suspend();
    const node = new HtexNode(context, await open("/fixtures/vinyl.htex"), { model: "ar" });
    await node.load(node.texture, { model: "bands" });
    node.stop();
    await new Promise((done) => setTimeout(done, 300));
    const counted = new Promise((done) => (new AudioWorkletNode(context, "counts").port.onmessage = ({ data }) => done(data)));
    return counted;
  });
  assert.equal(counts.htex_voice_new, 62);
  assert.equal(counts.htex_voice_free, 62);
  assert.equal(counts.htex_asset_free, counts.htex_asset_from_bytes);
  assert.deepEqual(made.errors, []);
  await made.close();
});
