// Parts of the page that are built before it: the scripts of workers, and the page of a player.

import { createHash } from "node:crypto";
import { readFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import { build } from "vite";

const here = path.dirname(fileURLToPath(import.meta.url));

/** What a page may do; nothing else, and nothing to other addresses. */
export const policy = (parts) =>
  Object.entries({ "default-src": "'none'", "base-uri": "'none'", "form-action": "'none'", ...parts })
    .map(([name, value]) => `${name} ${value}`)
    .join("; ");

export function withPolicy(html, text) {
  return html.replace('<meta charset="utf-8" />', `<meta charset="utf-8" />\n    <meta http-equiv="Content-Security-Policy" content="${text}" />`);
}

export const digest = (text) => `'sha256-${createHash("sha256").update(text).digest("base64")}'`;

/** The page says where the modules are (`virtual:modules`): the package's own addresses would bring them along twice. */
export const ownModules = {
  name: "own-modules",
  transform(code, id) {
    if (!/\.htex\/(library|author|import)\.js$/.test(id)) return null;
    return code.replace(/new URL\("\.\/htex(-author|-import)?\.wasm", import\.meta\.url\)/, "undefined");
  },
};

/**
 * Bytes as text: five letters for four bytes, which are 6 % fewer letters than base64 has. The letters are `#` to `w`, with `z` in
 * place of `<`, which could end a block of a page. `src/modules.ts` reads it.
 */
export function base85(bytes) {
  let text = "";
  for (let at = 0; at < bytes.length; at += 4) {
    let group = 0;
    for (let i = at; i < at + 4; i++) group = group * 256 + (bytes[i] ?? 0);
    const letters = [];
    for (let i = 0; i < 5; i++, group = Math.floor(group / 85)) letters.unshift(String.fromCharCode(35 + (group % 85)));
    text += letters.slice(0, Math.min(bytes.length - at, 4) + 1).join("");
  }
  return text.replaceAll("<", "z");
}

/** A script in one text. */
export async function script(entry, plugins = []) {
  const config = { root: here, configFile: path.join(here, "vite.config.ts"), mode: "part", logLevel: "error", plugins };
  const result = await build({
    ...config,
    build: { write: false, assetsInlineLimit: () => true, modulePreload: false, rolldownOptions: { input: path.join(here, entry), output: { codeSplitting: false } } },
  });
  const { output } = Array.isArray(result) ? result[0] : result;
  const chunk = output.find((one) => one.type === "chunk" && one.isEntry);
  const style = output.find((one) => one.fileName.endsWith(".css"));
  return { code: chunk.code, css: style ? String(style.source) : "" };
}

export const dataAddress = (text) => `data:text/javascript;base64,${Buffer.from(text).toString("base64")}`;

/** A page of one file, of which a program fills in places. Its script and its style sheet stand in it. */
async function filledPage(entry, page, more) {
  const { code, css } = await script(entry);
  const [inner, style] = [`\n${code.replaceAll("</script", "<\\/script")}\n`, `\n${css}\n`];
  const html = await readFile(path.join(here, page), "utf8");
  const filled = html
    .replace(/<script type="module"[^>]*><\/script>/, () => `<script type="module">${inner}</script>`)
    .replace("</head>", () => `  <style>${style}</style>\n  </head>`);
  return withPolicy(filled, policy({ "script-src": `${digest(inner)} data: 'wasm-unsafe-eval'`, "style-src": digest(style), "worker-src": "data:", ...more }));
}

/** The page of a player with places for its name, options, library and texture. */
export const playerPage = () => filledPage("src/player/player.tsx", "src/player/player.html", {});

/** The page of a catalogue with places for its title, options and textures. */
export const cataloguePage = () => filledPage("src/catalogue/catalogue.tsx", "src/catalogue/catalogue.html", { "connect-src": "'self'" });
