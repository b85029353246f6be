// The page of the README as a bundle: each tool can build it, and it plays on a press.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { cp, mkdir, readFile, symlink, writeFile } from "node:fs/promises";
import path from "node:path";
import test, { after, before } from "node:test";
import { fileURLToPath, pathToFileURL } from "node:url";

import { drag, example, loudest, start } from "./browser.mjs";
import { HTEX_FIXTURES, HTEX_PACKAGE } from "./fixtures.mjs";

const { HTEX_EXAMPLE } = process.env;
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

/** Builds the example app in a folder of the server, and returns the HTML that its server renders. */
async function react(folder) {
  await cp(path.join(HTEX_EXAMPLE, "../app-react"), folder, { recursive: true });
  await symlink(fileURLToPath(new URL("./node_modules", import.meta.url)), path.join(folder, "node_modules"));
  await mkdir(path.join(folder, "public"), { recursive: true });
  for (const name of ["cloth.htex", "vinyl.htex"]) await cp(path.join(HTEX_FIXTURES, "vinyl.htex"), path.join(folder, "public", name));
  run(folder, "typescript/bin/tsc");
  run(folder, "vite/bin/vite.js", "build", "--base", "./");
  run(folder, "vite/bin/vite.js", "build", "--ssr", "src/server.tsx", "--outDir", "dist-server");
  const { render } = await import(pathToFileURL(path.join(folder, "dist-server/server.js")));
  const html = render();
  const page = path.join(folder, "dist/index.html");
  await writeFile(page, (await readFile(page, "utf8")).replace('<div id="app">', `<div id="app">${html}`));
  return html;
}

test("the app in React is rendered by a server, plays, fades and is silent when haptics are off", { timeout: 120_000 }, async () => {
  const folder = path.join(here.folder, "react");
  const html = await react(folder);
  assert.match(html, /aria-pressed="true">cloth\.htex/);
  const made = await here.page();
  await made.context().addInitScript({ path: path.join(here.folder, "recorder.js") });
  // The app itself keeps no node for tests.
  await made.context().addInitScript(`
    const connect = AudioNode.prototype.connect;
    AudioNode.prototype.connect = function (to, ...rest) {
      if (to instanceof AudioDestinationNode) window.record(this);
      return connect.call(this, to, ...rest);
    };`);
  await made.goto(`${here.address}/react/dist/index.html`);
  const heard = async () => {
    await made.until("!!window.recorded && document.querySelector('[aria-busy=false]') !== null");
    await drag(made);
    return loudest(await made.run("window.recorded()"));
  };
  assert.ok((await heard()) > 0.01);
  await made.click("text=vinyl.htex");
  assert.ok((await heard()) > 0.01);
  await made.click("text=Haptics off");
  await made.run("new Promise((done) => setTimeout(done, 200))");
  await made.run("window.recorded()");
  assert.ok((await heard()) < 1e-4);
  assert.deepEqual(made.errors, []);
  await made.close();
});
