// The author module in Chromium: a recording is fitted in a worker of the page.

import assert from "node:assert/strict";
import { createServer } from "node:http";
import { readFile } from "node:fs/promises";
import path from "node:path";
import test, { after, before } from "node:test";

import { chromium } from "playwright-core";

import { HTEX_FIXTURES, HTEX_PACKAGE, bytes } from "./fixtures.mjs";

const { HTEX_CHROMIUM = "/usr/bin/chromium" } = process.env;
const TYPES = { ".js": "text/javascript", ".wasm": "application/wasm" };

let server, browser, made;

/** Opens a page of a server that serves the package and the fixtures. */
before(async () => {
  server = createServer(async (request, response) => {
    const [, folder, ...rest] = path.normalize(request.url).split("/");
    if (folder === "") return void response.setHeader("content-type", "text/html").end("<!doctype html><title>empty</title>");
    const file = path.join(folder === "htex" ? HTEX_PACKAGE : HTEX_FIXTURES, ...rest);
    try {
      const body = await readFile(file);
      response.setHeader("content-type", TYPES[path.extname(file)] ?? "application/octet-stream").end(body);
    } catch {
      response.writeHead(404).end();
    }
  });
  await new Promise((listening) => server.listen(0, "127.0.0.1", listening));
  browser = await chromium.launch({ executablePath: HTEX_CHROMIUM, args: ["--no-sandbox", "--disable-gpu"] });
  made = await browser.newPage();
  await made.goto(`http://127.0.0.1:${server.address().port}/`);
});

after(async () => {
  await browser?.close();
  server?.close();
});

test("a page fits a file to the bytes of the command, after a fit that was aborted", async () => {
  const found = await made.evaluate(async () => {
    const { fit } = await import("/htex/index.js");
    const file = new File([await (await fetch("/fixtures/vinyl.csv")).blob()], "vinyl.csv");
    const controller = new AbortController();
    const aborted = fit(file, { signal: controller.signal, onProgress: () => controller.abort() });
    const code = await aborted.then(() => "fitted", (error) => error.code);
    const steps = [];
    const { texture, report } = await fit(file, { name: "vinyl", onProgress: ({ text }) => steps.push(text) });
    const samples = texture.voice({ model: report.ranked[0] }).render(100);
    return { code, steps, bytes: Array.from(texture.bytes), isHeard: samples.some((x) => x !== 0) };
  });
  assert.equal(found.code, "aborted");
  assert.deepEqual(found.steps.slice(0, 2), ["read vinyl.csv", "fit ar"]);
  assert.ok(Buffer.from(found.bytes).equals(await bytes("vinyl.htex")));
  assert.ok(found.isHeard);
});

test("a page makes a texture, and its errors say what to do", async () => {
  const found = await made.evaluate(async () => {
    const { loadAuthor } = await import("/htex/index.js");
    const author = await loadAuthor();
    const at = { speed: 80, force: 0.5, level: 0.02, parameters: { alpha: 2, beta: 5 } };
    const hum = author.make({ name: "hum", representations: [{ model: "sbeta", conditions: [at] }] });
    const attempt = (run) => {
      try {
        run();
      } catch ({ name, code, message }) {
        return { name, code, message };
      }
    };
    return { bytes: Array.from(hum.bytes), error: attempt(() => author.columns({ name: "x.mat", bytes: new Uint8Array(200) })) };
  });
  assert.ok(Buffer.from(found.bytes).equals(await bytes("hum.htex")));
  assert.deepEqual([found.error.name, found.error.code], ["HtexError", "invalid-recording"]);
  assert.match(found.error.message, /MATLAB.*(Python|CSV)/);
});

test("a page imports a file of another format to the bytes of the command, in a worker", async () => {
  const found = await made.evaluate(async () => {
    const { importFile } = await import("/htex/import.js");
    const file = new File([await (await fetch("/fixtures/row.png")).blob()], "row.png");
    const given = { full_scale: 0.2, speed_mm_s: 80, force_n: 0.4 };
    const { texture } = await importFile(file, { ...given, pitch_mm: 0.5 });
    const error = await importFile(file).catch(({ code, message }) => ({ code, message }));
    return { bytes: Array.from(texture.bytes), error };
  });
  assert.ok(Buffer.from(found.bytes).equals(await bytes("imported/row.htex")));
  assert.deepEqual([found.error.code, /give full_scale/.test(found.error.message)], ["invalid-argument", true]);
});

test("a page exports a texture to the bytes of the command, in a worker", async () => {
  const exported = await made.evaluate(async () => {
    const { exportFile } = await import("/htex/import.js");
    const texture = await (await fetch("/fixtures/vinyl.htex")).arrayBuffer();
    return Array.from((await exportFile(texture, "wav", { rate_hz: 4000, model: "ar" })).bytes);
  });
  assert.ok(Buffer.from(exported).equals(await bytes("exported/vinyl.wav")));
});
