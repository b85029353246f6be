import { fileURLToPath } from "node:url";
import { defineConfig } from "vite";

export default defineConfig({
  resolve: { alias: { htex: fileURLToPath(new URL("./.htex/index.js", import.meta.url)) } },
  assetsInclude: ["**/*.htexlib"],
  build: { target: "es2022", chunkSizeWarningLimit: 2000 },
});
