import { fileURLToPath } from "node:url";
import { gzipSync } from "node:zlib";

import { defineConfig, type Plugin } from "vite";

import { dataAddress, ownModules, playerPage, script } from "./parts.mjs";

const WORKERS = "virtual:workers";
const PLAYER = "virtual:player";
const MODULES = "virtual:modules";

const file = (name: string) => fileURLToPath(new URL(name, import.meta.url));

/** Scripts of workers as `data:` addresses in the page of one file, and the page of a player as an asset. */
function parts(mode: string): Plugin {
  return {
    name: "parts",
    resolveId: (id) => (id === WORKERS || id === PLAYER || id === MODULES ? `\0${id}` : null),
    async load(id) {
      if (id === `\0${WORKERS}`) {
        const isSingle = mode === "single";
        const text = async (entry: string) => (isSingle ? JSON.stringify(dataAddress((await script(entry)).code)) : "undefined");
        return `export const authorWorker = ${await text(".htex/author-worker.js")}; export const guardedWorker = ${await text(".htex/worker.js")}; export const readingWorker = ${await text("src/reading-worker.ts")};`;
      }
      if (id === `\0${MODULES}`) {
        if (mode === "single") return "export const library = undefined; export const author = undefined; export const importer = undefined;";
        const from = (name: string, module: string) => `export { default as ${name} } from ${JSON.stringify(`${file(`./.htex/${module}`)}?url`)};`;
        return from("library", "htex.wasm") + from("author", "htex-author.wasm") + from("importer", "htex-import.wasm");
      }
      if (id !== `\0${PLAYER}`) return null;
      const page = await playerPage();
      if (mode === "single") return `export default ${JSON.stringify(`data:application/gzip;base64,${gzipSync(page, { level: 9 }).toString("base64")}`)};`;
      const reference = this.emitFile({ type: "asset", name: "player.txt", source: page });
      return `export default import.meta.ROLLUP_FILE_URL_${reference};`;
    },
  };
}

export default defineConfig(({ mode }) => ({
  resolve: {
    alias: [
      { find: /^htex$/, replacement: file("./.htex/index.js") },
      { find: /^htex\/import$/, replacement: file("./.htex/import.js") },
    ],
  },
  assetsInclude: ["**/*.htexlib"],
  worker: { format: "es", plugins: () => [ownModules] },
  build: { target: "es2022", chunkSizeWarningLimit: 12_000 },
  plugins: [ownModules, ...(mode === "part" ? [] : [parts(mode)])],
}));
