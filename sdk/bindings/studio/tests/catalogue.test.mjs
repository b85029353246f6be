// The catalogue of a library, as `htex lib catalogue` writes it: from a disk, and from a server that answers requests for ranges.

import assert from "node:assert/strict";
import { execFileSync } from "node:child_process";
import { existsSync } from "node:fs";
import { mkdir, readFile, stat, writeFile } from "node:fs/promises";
import { createServer } from "node:http";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import puppeteer from "puppeteer-core";

import { HTEX_COMMAND, HTEX_FIREFOX, HTEX_STUDIO, assertAccessible, browser, closed, file, isWhole, prepare, until } from "./studio.mjs";

const htex = (...given) => execFileSync(HTEX_COMMAND, given, { cwd: file(""), encoding: "utf8" });

const NAMES = ["cotton", "linen", "silk", "wool", "oak", "birch", "elm", "slate", "sandpaper", "rubber"];
const REPORT = {
  report: "htex-build-report/1",
  program: "htex 0.2.0",
  library: { name: "all", file: "all.htexlib", bytes: 1, blake3: "", textures: 10, left_out: 1 },
  felt_shares: {},
  findings: { RECORDING_CLIPPED: { severity: "error", textures: 1, in_library: 0, first: ["glass"] } },
  textures: [{ name: "glass", status: "left_out", key: "", recordings: [], missed: [{ gate: "deny", reason: "its recording is clipped" }] }],
};

prepare(async () => {
  await mkdir(file("textures/fabric"), { recursive: true });
  for (const [i, name] of NAMES.entries()) {
    const rights = i < 4 ? ["--license", "CC-BY-4.0", "--author", "Ana"] : ["--license", "CC0-1.0", "--author", "</script><b>Ben"];
    const speed = i % 2 === 0 ? "speed=80,force=0.5" : "speed=20,force=0.5";
    const at = ["--model", "sbeta", "--set", `alpha=${1.5 + 0.4 * i}`, "beta=5", "--level", "0.02", "--at", speed];
    htex("make", ...at, ...rights, "--name", `The ${name}`, "--description", `What ${name} feels like`, "--tag", i < 4 ? "fabric" : "hard", "-o", `textures/${i < 4 ? `fabric/${name}` : name}.htex`);
  }
  const described = ["version=1.2", "description=Ten textures", "authors=Ana;Ben", "homepage=https://textures.example/", "source=javascript:alert(1)"];
  htex("lib", "pack", "all.htexlib", "textures", "--name", "All & more", ...described.flatMap((one) => ["--describe", one]));
  await writeFile(file("report.json"), JSON.stringify(REPORT));
  htex("lib", "catalogue", "all.htexlib", "-o", "site", "--report", "report.json", "--folder", HTEX_STUDIO);
});

const onDisk = () => pathToFileURL(file("site/index.html")).href;

/** Opens a page of the catalogue, and waits until its list is there. */
async function opened(address, { with: other = browser, ...options } = {}) {
  const context = await other.newContext({ viewport: { width: 1440, height: 900 }, acceptDownloads: true, ...options });
  const page = await context.newPage();
  Object.assign(page, { errors: [] });
  page.on("pageerror", (error) => page.errors.push(String(error)));
  page.on("console", (message) => message.type() === "error" && page.errors.push(message.text()));
  await page.goto(address);
  await page.waitForFunction(() => document.documentElement.dataset.ready === "yes");
  return page;
}

const cards = (page) => page.locator(".card .card-name").allTextContents();

/** Serves the folder of the tests, with ranges; `asked` has what was asked for. */
async function serveRanges() {
  const asked = [];
  const types = { ".html": "text/html", ".htexlib": "application/vnd.htexlib" };
  const server = createServer(async (request, response) => {
    const { pathname } = new URL(request.url, "http://x");
    const bytes = await readFile(file(decodeURIComponent(pathname.slice(1)))).catch(() => null);
    if (!bytes) return response.writeHead(404).end();
    const [, from, to] = /^bytes=(\d+)-(\d+)$/.exec(request.headers.range ?? "") ?? [];
    asked.push({ pathname, from, to });
    response.setHeader("Content-Type", types[path.extname(pathname)] ?? "application/octet-stream");
    for (const [name, value] of [["Access-Control-Allow-Origin", "*"], ["Access-Control-Allow-Headers", "*"], ["Access-Control-Expose-Headers", "Content-Range, ETag"], ["ETag", '"one"']]) response.setHeader(name, value);
    if (from === undefined) return response.end(bytes);
    const part = bytes.subarray(Number(from), Number(to) + 1);
    response.writeHead(206, { "Content-Range": `bytes ${from}-${Number(from) + part.length - 1}/${bytes.length}` }).end(part);
  });
  await new Promise((resolve) => server.listen(0, "127.0.0.1", resolve));
  const close = () => new Promise((resolve) => (server.close(resolve), server.closeAllConnections()));
  return { address: `http://127.0.0.1:${server.address().port}`, asked, close };
}

test("from a disk, the textures are listed, searched and filtered", async () => {
  const page = await opened(onDisk());
  assert.equal(await page.title(), "All & more");
  assert.equal((await cards(page)).length, 10);
  // Their pictures are painted, so the textures were opened.
  await until(page, () => [...document.querySelectorAll(".card canvas")].filter((canvas) => canvas.width > 0).length === 10);
  await page.getByLabel("Search textures").fill("FABRIC li");
  assert.deepEqual(await cards(page), ["fabric/linen"]);
  await page.getByLabel("Search textures").fill("nothing");
  await page.getByText("No texture matches").waitFor();
  await page.getByRole("button", { name: "Show all" }).click();
  await page.getByLabel("Licence").selectOption({ label: "CC0-1.0 (6)" });
  assert.equal((await cards(page)).length, 6);
  await page.getByLabel("Recorded at, mm/s").fill("81");
  assert.deepEqual(await cards(page), ["elm", "oak", "sandpaper"]);
  await page.getByRole("button", { name: "Show all" }).click();
  await page.getByRole("button", { name: "fabric", exact: true }).click();
  assert.equal((await cards(page)).length, 4);
  assert.match(await page.getByRole("status").textContent(), /^4 of 10 textures/);
  await closed(page);
});

test("what others wrote is shown as text, and only addresses of the web are links", async () => {
  const page = await opened(onDisk());
  await page.getByText("About this library").click();
  const links = await page.locator(".catalogue-head a").evaluateAll((all) => all.map((link) => link.href));
  assert.deepEqual(links, ["https://textures.example/"]);
  assert.match(await page.locator(".catalogue-head").textContent(), /CC0-1.0 6, CC-BY-4.0 4/);
  await page.getByRole("link", { name: /^oak/ }).click();
  await page.getByText("By </script><b>Ben.").waitFor();
  assert.equal(await page.locator("b").count(), 0);
  await closed(page);
});

test("a texture has an address of its own, plays, and is saved as its file", async () => {
  const page = await opened(onDisk());
  await page.getByRole("link", { name: /fabric\/silk/ }).click();
  await page.getByRole("heading", { name: "The silk" }).waitFor();
  assert.match(page.url(), /#fabric%2Fsilk$/);
  for (const text of ["What silk feels like", "Licence: CC-BY-4.0.", "sbeta", '"The silk" by Ana from All & more 1.2 (https://textures.example/). Licence: CC-BY-4.0.']) {
    await page.getByText(text).first().waitFor();
  }
  assert.equal(await page.getByRole("cell", { name: "80", exact: true }).count(), 1);
  assert.match(await page.getByRole("img", { name: /^Spectrum at 80 mm\/s/ }).getAttribute("aria-label"), /strongest at \d+ Hz/);
  const download = page.waitForEvent("download");
  await page.getByRole("link", { name: "Save silk.htex" }).click();
  const saved = await (await download).path();
  assert.deepEqual(await readFile(saved), await readFile(file("textures/fabric/silk.htex")));
  // The finger of the autopilot moves, and the motion outside of what was recorded is told.
  await page.getByRole("button", { name: "Back and forth" }).click();
  await page.getByText("This speed and force are within the recorded range.").waitFor();
  await page.getByLabel("Speed").fill("1000");
  await page.getByText(/Faster than recorded: it plays/).waitFor();
  // The address leads there again, and another one elsewhere.
  await page.reload();
  await page.getByRole("heading", { name: "The silk" }).waitFor();
  await page.evaluate(() => (location.hash = "#oak"));
  await page.getByRole("heading", { name: "The oak" }).waitFor();
  await page.evaluate(() => (location.hash = "#nowhere"));
  await page.getByText(/no texture .*nowhere/).waitFor();
  await page.getByRole("link", { name: "All textures" }).click();
  await page.locator(".card").first().waitFor();
  assert.equal((await cards(page)).length, 10);
  await closed(page);
});

test("what a build left out is on a page of its own", async () => {
  const page = await opened(onDisk());
  await page.getByRole("link", { name: "Build" }).click();
  await page.getByText("its recording is clipped").waitFor();
  await page.getByRole("cell", { name: "RECORDING_CLIPPED" }).waitFor();
  assert.equal(await page.locator(".card").count(), 0);
  await assertAccessible(page, "build");
  await page.getByRole("link", { name: "Textures" }).click();
  await page.locator(".card").first().waitFor();
  assert.equal((await cards(page)).length, 10);
  await closed(page);
});

test("from a server, only ranges of the library are read", async () => {
  const served = await serveRanges();
  try {
    htex("lib", "catalogue", "all.htexlib", "-o", "remote", "--url", `${served.address}/all.htexlib`, "--folder", HTEX_STUDIO);
    const page = await opened(`${served.address}/remote/index.html#oak`);
    await page.getByRole("heading", { name: "The oak" }).waitFor();
    const { size } = await stat(file("all.htexlib"));
    const ranges = served.asked.filter(({ pathname }) => pathname === "/all.htexlib");
    const read = ranges.reduce((sum, { from, to }) => sum + Number(to) + 1 - Number(from), 0);
    assert.ok(ranges.length >= 2 && ranges.every(({ from }) => from !== undefined), JSON.stringify(ranges));
    // The first 16 KiB contain most of this small library.
    assert.ok(read < size + 16384, `${read} ${size}`);
    await closed(page);
    // Another origin, and a page on a disk that cannot read it.
    const other = await opened(`${served.address.replace("127.0.0.1", "localhost")}/remote/index.html`);
    assert.equal((await cards(other)).length, 10);
    await closed(other);
    const disk = await browser.newPage();
    await disk.goto(pathToFileURL(file("remote/index.html")).href);
    await disk.getByText("Serve this folder by a web server").waitFor();
    await disk.close();
  } finally {
    await served.close();
  }
});

for (const [width, height] of [[390, 844], [820, 1180], [1440, 900]]) {
  for (const colorScheme of isWhole ? ["light", "dark"] : ["light"]) {
    test(`at ${width} px in ${colorScheme} colours, nothing is cut off, and axe finds nothing`, async () => {
      const page = await opened(onDisk(), { viewport: { width, height }, colorScheme });
      const fits = () => page.evaluate(() => document.documentElement.scrollWidth <= innerWidth);
      await assertAccessible(page, "list");
      assert.ok(await fits(), "list");
      if (process.env.HTEX_PICTURES) await page.screenshot({ path: path.join(process.env.HTEX_PICTURES, `list-${width}-${colorScheme}.png`) });
      await page.getByRole("link", { name: /fabric\/silk/ }).click();
      await page.getByRole("heading", { name: "The silk" }).waitFor();
      await page.getByRole("heading", { name: "Attribution" }).waitFor();
      await assertAccessible(page, "texture");
      assert.ok(await fits(), "texture");
      if (process.env.HTEX_PICTURES) await page.screenshot({ path: path.join(process.env.HTEX_PICTURES, `texture-${width}-${colorScheme}.png`), fullPage: true });
      await closed(page);
    });
  }
}

test("Firefox lists and opens textures", { skip: existsSync(HTEX_FIREFOX) ? false : `no ${HTEX_FIREFOX}; to have it: apt-get install firefox-esr` }, async () => {
  const launched = await puppeteer.launch({ browser: "firefox", executablePath: HTEX_FIREFOX, headless: true });
  try {
    const page = await launched.newPage();
    const errors = [];
    page.on("pageerror", (error) => errors.push(String(error)));
    await page.goto(onDisk());
    await page.waitForSelector("html[data-ready=yes]");
    assert.equal((await page.$$(".card")).length, 10);
    await page.evaluate(() => (location.hash = "#oak"));
    await page.waitForSelector(".spectrum-chart");
    assert.equal(await page.$eval(".player h1", (title) => title.textContent), "The oak");
    assert.deepEqual(errors, []);
  } finally {
    await launched.close();
  }
});
