// Builds the page twice: `static/`, for web servers and offline, and `studio.html`, one file for a double click. Builds
// `catalogue.html` besides, of which `htex lib catalogue` makes the catalogue of a library.
//
//   node build.mjs OUT
//
// The npm package is in the folder `.htex`, where `cargo xtask studio` puts it.

import { createHash } from "node:crypto";
import { mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "vite";

import { base85, cataloguePage, digest, policy, withPolicy } from "./parts.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const out = path.resolve(process.argv[2] ?? path.join(here, "dist"));
const common = {
  root: here,
  base: "./",
  logLevel: "warn",
};

const STATIC_POLICY = policy({
  "script-src": "'self' 'wasm-unsafe-eval'",
  "style-src": "'self'",
  "img-src": "'self' data: blob:",
  "connect-src": "'self'",
  "worker-src": "'self'",
  "manifest-src": "'self'",
});

async function files(folder, below = "") {
  const entries = await readdir(path.join(folder, below), { withFileTypes: true });
  const all = entries.map((entry) => {
    const name = path.posix.join(below, entry.name);
    return entry.isDirectory() ? files(folder, name) : [name];
  });
  return (await Promise.all(all)).flat().sort();
}

/** Writes the service worker: the page's files, whose hash is the version. */
async function writeServiceWorker(folder) {
  const names = (await files(folder)).filter((name) => name !== "sw.js");
  const hash = createHash("sha256");
  for (const name of names) hash.update(name).update(await readFile(path.join(folder, name)));
  const text = await readFile(path.join(here, "src/service-worker.js"), "utf8");
  const filled = text.replace("__VERSION__", hash.digest("hex").slice(0, 16)).replace('["__FILES__"]', JSON.stringify(["./", ...names]));
  await writeFile(path.join(folder, "sw.js"), filled);
}

/** The module of the player and the shelf load while the script does, which asks for them when it runs. */
async function preloads(folder) {
  const names = (await files(folder)).filter((name) => /assets\/(htex-(?!author|import).*\.wasm|shelf-.*\.htexlib)$/.test(name));
  if (names.length !== 2) throw new Error(`the page needs one module of the player and one shelf: ${names.join(", ")}`);
  return names.map((name) => `  <link rel="preload" href="./${name}" as="fetch" crossorigin />\n  `).join("");
}

async function buildStatic() {
  const folder = path.join(out, "static");
  await build({ ...common, mode: "static", build: { outDir: folder, emptyOutDir: true, assetsInlineLimit: 0, modulePreload: { polyfill: false } } });
  const index = path.join(folder, "index.html");
  const html = await readFile(index, "utf8");
  await writeFile(index, withPolicy(html.replace("</head>", `${await preloads(folder)}</head>`), STATIC_POLICY));
  await writeServiceWorker(folder);
}

/** A module as text that runs nothing: compressed, since a page is read as a whole. */
async function block(name) {
  const text = base85(await readFile(path.join(here, ".htex", `${name}.gz`)));
  return `<script type="application/octet-stream" id="${name}">${text}</script>\n    `;
}

/** One file: the script and the style sheet stand in it, and the library, the worklet and the shelf are `data:` addresses in the script. */
async function buildSingle() {
  const folder = path.join(out, ".single");
  await build({
    ...common,
    mode: "single",
    build: {
      outDir: folder,
      emptyOutDir: true,
      assetsInlineLimit: () => true,
      cssCodeSplit: false,
      modulePreload: { polyfill: false },
      rolldownOptions: { output: { codeSplitting: false } },
    },
  });
  let html = await readFile(path.join(folder, "index.html"), "utf8");
  const read = (address) => readFile(path.join(folder, address), "utf8");
  const [scriptTag, script] = /<script type="module"[^>]* src="([^"]+)"><\/script>/.exec(html) ?? [];
  const [styleTag, style] = /<link rel="stylesheet"[^>]* href="([^"]+)">/.exec(html) ?? [];
  const [iconTag] = /<link rel="icon"[^>]*>/.exec(html) ?? [];
  const code = `\n${(await read(script)).replaceAll("</script", "<\\/script")}\n`;
  const css = `\n${await read(style)}\n`;
  const icon = Buffer.from(await read("icon.svg")).toString("base64");
  html = html.replace(scriptTag, "").replace(styleTag, () => `<style>${css}</style>`);
  html = html.replace(iconTag, `<link rel="icon" href="data:image/svg+xml;base64,${icon}" />`);
  const blocks = await Promise.all(["htex.wasm", "htex-import.wasm"].map(block));
  html = html.replace("</body>", () => `${blocks.join("")}<script type="module">${code}</script>\n  </body>`);
  const single = policy({
    "script-src": `${digest(code)} data: 'wasm-unsafe-eval'`,
    "style-src": digest(css),
    "img-src": "data: blob:",
    "connect-src": "data:",
    "worker-src": "data:",
  });
  await writeFile(path.join(out, "studio.html"), withPolicy(html, single));
  await rm(folder, { recursive: true });
}

await mkdir(out, { recursive: true });
await buildStatic();
await buildSingle();
const player = await readFile(path.join(here, ".htex", "htex.wasm.gz"), "base64");
await writeFile(path.join(out, "catalogue.html"), (await cataloguePage()).replace("__LIBRARY__", () => player));
