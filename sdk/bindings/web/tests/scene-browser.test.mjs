// Scenes in Chromium, in a page and in a worker, give the same samples as the command.

import assert from "node:assert/strict";
import { writeFile } from "node:fs/promises";
import path from "node:path";
import test, { after, before } from "node:test";

import { start } from "./browser.mjs";
import { difference, samples } from "./fixtures.mjs";

/** Plays a scene of the fixtures with files from the server. The worker runs the same script. */
const PLAY = `
import { scene } from "/htex/scene.js";
const file = async (name) => new Uint8Array(await (await fetch("/fixtures/scenes/" + name)).arrayBuffer());
export async function play(name, names) {
  const files = new Map(await Promise.all(names.map(async (one) => [one, await file(one)])));
  const opened = await scene(await file(name + ".scene.json"), files);
  const { unit, rate } = opened;
  const heard = opened.render();
  opened.free();
  return { unit, rate, heard: Array.from(heard) };
}
globalThis.onmessage = ({ data }) => play(...data).then((played) => postMessage({ played }), ({ code, message }) => postMessage({ error: code + ": " + message }));
`;

const SCENES = [["two-swatches", ["coarse-fabric.htex", "vinyl.htex", "hand.csv"], "N"], ["electrovibration", ["coarse-fabric.htex", "display.csv"], "V"]];

let here;
before(async () => {
  here = await start();
  await writeFile(path.join(here.folder, "play.js"), PLAY);
});
after(() => here?.close());

const WAYS = {
  "a page": (call) => import("/play.js").then(({ play }) => play(...call)),
  "a worker": (call) =>
    new Promise((resolve, reject) => {
      const worker = new Worker("/play.js", { type: "module" });
      worker.onmessage = ({ data }) => (data.error ? reject(new Error(data.error)) : resolve(data.played));
      worker.onerror = ({ message }) => reject(new Error(message));
      worker.postMessage(call);
    }),
};

for (const [where, way] of Object.entries(WAYS)) {
  test(`${where} plays scenes as the command does`, async () => {
    const made = await here.page();
    for (const [name, names, unit] of SCENES) {
      const played = await made.evaluate(way, [name, names]);
      assert.equal(played.unit, unit);
      assert.equal(difference(Float32Array.from(played.heard), await samples(`${name}.wav`)), -1, name);
    }
    await assert.rejects(made.evaluate(way, ["two-swatches", ["coarse-fabric.htex"]]), /invalid-scene.*vinyl|vinyl/s);
    assert.deepEqual(made.errors, []);
    await made.close();
  });
}
