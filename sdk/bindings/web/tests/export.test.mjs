// Exports to other haptic formats in Node.js give the same files and reports as the command, bit for
// bit.

import assert from "node:assert/strict";
import path from "node:path";
import test from "node:test";
import { pathToFileURL } from "node:url";

import { HTEX_PACKAGE, bytes } from "./fixtures.mjs";

const packaged = (name) => import(pathToFileURL(path.join(HTEX_PACKAGE, name)));
const { HtexError, open } = await packaged("index.node.js");
const { exportFile, loadImporter } = await packaged("import.node.js");

const importer = await loadImporter();
const stroke = { name: "stroke.csv", bytes: await bytes("stroke.csv") };
const NO_LICENCE = /^It states no licence, and without one nobody may pass it on/;

/** Files that the command exports; the texture, the format and the settings for the package; the sentence about rights. */
const EXPORTS = [
  ["part.haptic", "part.htex", "haptic", {}, /^It states the licence CC0-1\.0 \(metadata\.description, metadata\.author\)\.$/],
  ["edited.ahap", "edited.htex", "ahap", { profile: "lra-175", seconds: 1.5, seed: 7 }, /^It states the author A\. Weaver \(Metadata\.Description\)\. It states no licence/],
  ["part.json", "part.htex", "android", { model: "bands" }, /licence CC0-1\.0/],
  ["part.kt", "part.htex", "android", { speed_mm_s: 100, extension: "kt" }, /licence CC0-1\.0/],
  ["vinyl.hjif", "vinyl.htex", "hjif", { force_n: 0.7 }, NO_LICENCE],
  ["wavelet.hjif", "vinyl.htex", "hjif", { coding: "wavelet", speed_mm_s: 120, force_n: 0.5 }, NO_LICENCE],
  ["vinyl.wav", "vinyl.htex", "wav", { rate_hz: 4000, model: "ar" }, NO_LICENCE],
  ["vinyl.png", "vinyl.htex", "png", { speed_mm_s: 100, force_n: 0.5 }, NO_LICENCE],
  ["part.glb", "part.htex", "gltf", {}, /licence CC0-1\.0/],
  ["vinyl.gltf", "vinyl.htex", "gltf", { extension: "gltf" }, NO_LICENCE],
  ["lines.ahap", "lines.htex", "ahap", { stroke }, NO_LICENCE],
  ["bursts.haptic", "bursts.htex", "haptic", {}, NO_LICENCE],
];

for (const [file, texture, to, settings, rights] of EXPORTS) {
  test(`${file} is the file of the command, in a worker and in this thread`, async () => {
    const expected = await bytes(`exported/${file}`);
    const { file: _, bytes: length, ...report } = JSON.parse(await bytes(`exported/${file}.report`));
    const data = await bytes(texture);
    for (const exported of [await exportFile(data, to, settings), importer.exportFile(data, to, settings)]) {
      assert.ok(Buffer.from(exported.bytes).equals(expected), "other bytes");
      assert.equal(exported.bytes.length, length);
      assert.equal(exported.extension, file.split(".")[1]);
      assert.deepEqual(exported.report, report);
      assert.match(exported.report.rights, rights);
    }
  });
}

test("every format is exported, and says which settings it takes", async () => {
  const { exports, profiles } = importer.formats();
  const tried = new Set(EXPORTS.map(([, , to]) => to));
  assert.deepEqual(new Set(exports.map(({ name }) => name)), tried);
  const data = await bytes("part.htex");
  for (const { name, title, extensions, settings, profile, keeps, loses, rights } of exports) {
    assert.ok(title && keeps && loses && rights);
    assert.equal(profile !== null, settings.includes("profile"));
    assert.ok(profile === null || profiles.some((one) => one.name === profile));
    const { extension, report } = importer.exportFile(data, name);
    assert.deepEqual([extension, report.format, report.profile ?? null, report.loses], [extensions[0], name, profile, loses]);
  }
});

test("an opened texture and a File with a stroke are exported", async () => {
  const texture = await open(await bytes("lines.htex"));
  const file = new File([stroke.bytes], "stroke.csv");
  const { bytes: exported } = await exportFile(texture, "ahap", { stroke: file });
  assert.ok(Buffer.from(exported).equals(await bytes("exported/lines.ahap")));
  // The texture and the stroke remain usable.
  assert.ok(texture.name.length > 0 && stroke.bytes.length > 0);
});

test("errors say what is wrong and what to do", async () => {
  const refused = async (texture, to, settings, code, message) => {
    const data = typeof texture === "string" ? await bytes(texture) : texture;
    assert.throws(() => importer.exportFile(data, to, settings), { name: "HtexError", code, message });
    await assert.rejects(exportFile(data, to, settings), (error) => error instanceof HtexError && error.code === code && message.test(error.message));
  };
  const wrong = (to, settings, message) => refused("part.htex", to, settings, "invalid-argument", message);
  await wrong("bmp", {}, /^there is no format `bmp`; there are haptic, ahap, android, hjif, wav, png and gltf$/);
  await wrong(undefined, {}, /there is no format ``/);
  await wrong("hatt", {}, /^hatt: it is not written; there are haptic, ahap/);
  await wrong("wav", { coding: "wavelet" }, /its export takes no coding; leave it out \(it takes model, speed_mm_s, force_n, .* and rate_hz\)/);
  await wrong("gltf", { speed_mm_s: 80 }, /its export takes no speed_mm_s; leave it out/);
  await wrong("png", { seconds: 3 }, /its export takes no seconds/);
  await wrong("ahap", { stroke, force_n: 0.4 }, /its export along a stroke takes no force_n/);
  await wrong("ahap", { speed: 80 }, /^there is no speed; there are extension, model, speed_mm_s/);
  await wrong("ahap", { speed_mm_s: "fast" }, /speed_mm_s is a number/);
  await wrong("ahap", { speed_mm_s: -80, force_n: 0.4 }, /invalid motion: -80 mm\/s at 0\.4 N/);
  await wrong("ahap", { speed_mm_s: 0, force_n: 0.4 }, /the texture is silent at this motion/);
  await wrong("ahap", { profile: "phone" }, /^there is no profile `phone`; there are quest/);
  await wrong("hjif", { coding: "tones" }, /^there is no coding `tones`; there are vectorial and wavelet$/);
  await wrong("android", { extension: "xml" }, /^android: its extension is json or kt$/);
  await wrong("wav", { profile: "erm" }, /choose haptic, ahap or android/);
  await wrong("wav", { seconds: 0.1 }, /^seconds 0\.1: 0\.5 to 600 s$/);
  await wrong("wav", { rate_hz: 1000 }, /^rate_hz 1000: twice the texture's highest frequency/);
  await wrong("wav", { seconds: 600, rate_hz: 192000 }, /^seconds 600: at this sample rate, so many samples do not fit into the memory$/);
  for (const seed of [-1, 0.5, 2 ** 60]) await wrong("wav", { seed }, /a whole number from 0 to 9007199254740991/);
  await wrong("wav", { model: "nothing" }, /no representation `nothing`/);
  await refused("part.htex", "ahap", { stroke: { name: "stroke.csv", bytes: Buffer.from("a,b\n1,2\n") } }, "invalid-recording", /stroke\.csv: /);
  await refused((await bytes("part.htex")).subarray(0, 100), "ahap", {}, "invalid-asset", /./);
  assert.throws(() => importer.exportFile("part.htex", "ahap"), { code: "invalid-argument", message: /bytes are an ArrayBuffer/ });
});

test("a texture that needs a model that is not there says so", async () => {
  for (const [texture, settings, message] of [
    ["guest.htex", {}, /no model `.*bursts.*`/],
    ["bursts.htex", { model: "bursts" }, /no model `.*bursts` is installed; the asset embeds it/],
  ]) {
    const data = await bytes(texture);
    for (const to of ["ahap", "wav", "png"]) assert.throws(() => importer.exportFile(data, to, settings), { code: "no-model", message });
    await assert.rejects(exportFile(data, "hjif", settings), { code: "no-model", message });
  }
  // This format stores the texture itself and plays nothing.
  assert.ok(importer.exportFile(await bytes("guest.htex"), "gltf").bytes.length > 0);
});

test("an export is aborted before it begins, and while it runs", async () => {
  const data = await bytes("part.htex");
  await assert.rejects(exportFile(data, "ahap", { signal: AbortSignal.abort() }), { code: "aborted", message: "the export was aborted" });
  const controller = new AbortController();
  const exporting = exportFile(data, "wav", { seconds: 60, signal: controller.signal });
  setTimeout(() => controller.abort(), 20);
  await assert.rejects(exporting, { name: "HtexError", code: "aborted" });
  assert.equal((await exportFile(data, "wav")).report.format, "wav");
});
