// Prints the time for one sample, ns: the shortest of several runs with blocks of 64 samples.

import { readFile } from "node:fs/promises";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [, , asset, model] = process.argv;
const { open } = await import(pathToFileURL(path.join(process.env.HTEX_PACKAGE, "index.node.js")));
const voice = (await open(await readFile(asset))).voice({ model, seed: 7 });
const samples = new Float32Array(64);
let least = Infinity;
for (let run = 0; run < 5; run++) {
  const start = performance.now();
  for (let block = 0; block < 30000; block++) voice.render(samples);
  least = Math.min(least, ((performance.now() - start) * 1e6) / (30000 * 64));
}
console.log(least.toFixed(4));
