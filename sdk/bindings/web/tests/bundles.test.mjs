// The page of the README as a bundle: each tool can build it, and it plays on a press.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cp, mkdir, writeFile } from "node:fs/promises";
import path from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath } from "node:url";

import { drag, example, loudest, start } from "./browser.mjs";
import { HTEX_FIXTURES, HTEX_PACKAGE } from "./fixtures.mjs";

const tool = (file) => fileURLToPath(new URL(`./node_modules/${file}`, import.meta.url));
const run = (cwd, file, ...options) => execFileSync(process.execPath, [tool(file), ...options], { cwd, stdio: "pipe" });

/** Files that esbuild does not copy by itself. */
const BESIDE = ["htex.wasm", "processor.js", "worker.js"];

const TOOLS = {
  Vite: (app) => run(app, "vite/bin/vite.js", "build", "--base", "./"),
  webpack: (app) => run(app, "webpack-cli/bin/cli.js", "--mode", "production", "--entry", "./main.js"),
  esbuild: async (app) => {
    execFileSync(tool("esbuild/bin/esbuild"), ["main.js", "--bundle", "--format=esm", "--outfile=dist/main.js"], { cwd: app, stdio: "pipe" });
    for (const file of BESIDE) await cp(path.join(HTEX_PACKAGE, file), path.join(app, "dist", file));
  },
  Parcel: (app) => run(app, "parcel/lib/bin.js", "build", "index.html", "--no-cache", "--public-url", "./"),
};

let here;
before(async () => {
  here = await start();
});
after(() => here?.close());

for (const [name, build] of Object.entries(TOOLS)) {
  test(`a bundle of ${name} sounds`, { timeout: 120_000 }, async () => {
    const app = path.join(here.folder, name);
    await mkdir(path.join(app, "node_modules"), { recursive: true });
    await mkdir(path.join(app, "dist"), { recursive: true });
    await cp(HTEX_PACKAGE, path.join(app, "node_modules/htex"), { recursive: true });
    await writeFile(path.join(app, "package.json"), '{ "private": true, "type": "module" }');
    await writeFile(path.join(app, "main.js"), `${await example()}\nwindow.load = async (address) => node.load(await open(address), { model: "bursts" });`);
    // A script that webpack builds does not have the type "module".
    const script = name === "webpack" ? "<script defer src=./main.js></script>" : "<script type=module src=./main.js></script>";
    const page = `<!doctype html><div id=surface style="width:600px;height:300px"></div>${script}`;
    await writeFile(path.join(app, "index.html"), page);
    await build(app);
    if (name === "webpack" || name === "esbuild") await writeFile(path.join(app, "dist/index.html"), page);
    await cp(path.join(HTEX_FIXTURES, "vinyl.htex"), path.join(app, "dist/cloth.htex"));
    const made = await here.page();
    await made.context().addInitScript({ path: path.join(here.folder, "recorder.js") });
    await made.goto(`${here.address}/${name}/dist/index.html`);
    await made.until("window.recorded !== undefined");
    await drag(made, { lift: false });
    const heard = await made.run("window.recorded()");
    assert.ok(loudest(heard) > 0.01, `${loudest(heard)}`);
    // The page also finds the worker, because it plays a WASM module.
    await made.run("window.load('/fixtures/bursts.htex')");
    await drag(made, { lift: false });
    const module = await made.run("window.recorded()");
    assert.ok(loudest(module) > 0.01, `${loudest(module)}`);
    assert.deepEqual(made.errors, []);
    await made.close();
  });
}
