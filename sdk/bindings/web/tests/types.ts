// Uses each declaration of the package; `tsc --strict` checks it.

import {
  GuardedWorker,
  HtexError,
  HtexNode,
  Library,
  Texture,
  Voice,
  dualRumble,
  fit,
  follow,
  followPointer,
  loadAuthor,
  open,
  playOnPad,
  prepare,
  setAuthorLibrary,
  setLibrary,
} from "htex";
import { exportFile, importFile, loadImporter, setImportLibrary } from "htex/import";
import type { Asked, Exported, ExportFormat, Imported, ImportFormat } from "htex/import";
import { scene, setSceneLibrary } from "htex/scene";
import type { Scene } from "htex/scene";
import type { PadPlayer } from "htex";
import type { Author, Coverage, FitOptions, Fitted, Law, Manifest } from "htex";

const pads: PadPlayer[] = [];

export async function play(context: AudioContext, element: HTMLElement, file: File): Promise<number> {
  setLibrary(new URL("htex.wasm", "https://example.org/"), { processor: "/processor.js", worker: new URL("https://example.org/worker.js") });
  const texture: Texture = await open("cloth.htex", { embedded: false, modules: [new Uint8Array(8)], trusted: true });
  await prepare(context);
  const node: HtexNode = new HtexNode(context, texture, { model: "ar", seed: 7n, gain: 1, bands: 3, worker: new GuardedWorker({ limit: 100 }) });
  node.speed.setTargetAtTime(80, 0, 0.01);
  node.position = 4;
  node.connect(context.destination);
  node.onerror = ({ error, type }) => console.log(type, error.code);
  node.onenvelope = ({ level, bands }) => console.log(level, bands[0], node.envelopeEdges[0]);
  await node.load(await open(file), { gain: 0.5 });
  const end: () => void = follow(element, node, { force: (pressure) => pressure, defaultForce: 0.4 });
  follow(document.querySelector("#surface"), node);
  followPointer(document.querySelector("svg path"), ({ x, y }) => console.log(x + y));
  // @ts-expect-error: no element.
  follow("#surface", node);
  for (const pad of navigator.getGamepads()) if (pad) pads.push(playOnPad(pad, texture, { model: "ar", seed: 7n, gain: 1, motion: { speed: 80 } }));
  console.log(dualRumble({ level: 0.1, centroid: 200 }, { gain: 3, duration: 100 }).strongMagnitude, pads[0]?.way);
  followPointer(element, ({ speed, force, position }) => console.log(speed + force + position));
  const voice: Voice = texture.voice({ synthesis: "loop:2", motion: { speed: 80 } });
  const samples: Float32Array = voice.render(voice.renderPath([80], [0.4], 64));
  const guarded: Float32Array = await new GuardedWorker().render(texture, 64, { rate: 8000 });
  try {
    await node.ready;
  } catch (error) {
    if (error instanceof HtexError) console.log(error.code);
  }
  end();
  // @ts-expect-error: a node has the rate of its context.
  new HtexNode(context, texture, { rate: 8000 });
  // @ts-expect-error: a typo.
  await open("cloth.htex", { embeded: false });
  return samples.length + guarded.length + texture.spectrum([50], { at: { speed: 80, force: 0.4 } })[0]! + texture.level() + texture.band[0];
}

export async function tell(response: Response): Promise<string> {
  using texture = await open(response);
  using voice = texture.voice();
  const manifest: Manifest = texture.manifest;
  const law: Law = texture.law;
  const coverage: Coverage = voice.coverage();
  const { frequencies, magnitudes } = texture.readSpectrum({ model: "bands", condition: 0 });
  const below: number | number[] | undefined = texture.parameters({ model: "bands", at: { speed: 80 } })["below_highest"];
  const numbers = [voice.spectrum(frequencies)[0], magnitudes[0], law.level_force.exponent, manifest.conditions[0]?.speed_mm_s, texture.toBytes().length];
  return `${texture.quantity} ${texture.contact} ${coverage.kind} ${coverage.speed.recorded} ${below} ${manifest.license} ${numbers.join()}`;
}

export async function search(tag: string): Promise<Texture[]> {
  const library: Library = await Library.open("cloth.htexlib", { fetch: (url, init) => fetch(url, { ...init, credentials: "include" }) });
  const found: Texture[] = [];
  for await (const { name, tags, conditions } of library.entries()) {
    if (tags.includes(tag) && (conditions.speed_mm_s?.max ?? 0) > 100) found.push(await library.texture(name));
  }
  for await (const { name } of library.find({ words: ["oak"], speed: 80 })) found.push(await library.texture(name));
  const bytes: Uint8Array = await library.bytes("oak");
  console.log(library.name, library.count - bytes.length, (await library.entry("oak"))?.blake3);
  library.free();
  return found;
}

export async function make(file: File, signal: AbortSignal): Promise<Uint8Array> {
  const options: FitOptions = { models: ["ar", "bands"], options: { ar: { order: 8 } }, grid: { speed: [40, 80] }, license: "CC0-1.0" };
  const { texture, report }: Fitted = await fit([file, { name: "felt.csv", bytes: new Uint8Array(8) }], {
    ...options,
    onProgress: ({ done, of, text }) => console.log(done / of, text),
    signal,
  });
  const author: Author = await loadAuthor();
  const [slider] = author.models()[0]!.fields.map(({ usual, min }) => usual?.min ?? min);
  const parameters = { below_highest: [0, 10], step_db: 1, layout: slider ?? 1 };
  const made: Texture = author.make({ name: "made", representations: [{ model: "bands", conditions: [{ speed: 80, force: 0.5, parameters }] }] });
  const mixed: Texture = author.edit(author.mix(texture, made, 0.5, { extensions: { "com.example.NOTE/1": [1] } }), { author: "A. Weaver", extensions: { "com.example.NOTE/1": null } });
  const { columns, picture, findings } = author.process({ name: "felt.csv", bytes: new ArrayBuffer(8) }, { map: "lateral=#2" });
  console.log(report.ranked[0], columns.problem, picture.signals["signal"]?.least[0], author.explain(findings[0]!.code)?.fix);
  // @ts-expect-error: a setting of no table.
  author.columns({ name: "felt.csv", bytes: new ArrayBuffer(8) }, { form_s: 2 });
  setAuthorLibrary("htex-author.wasm", { worker: () => new Worker("author-worker.js") });
  const [loop] = author.recorded({ name: "felt.csv", bytes: new ArrayBuffer(8) }, { rate: 48000, from_s: 2 });
  if (loop) await new HtexNode(new AudioContext(), texture).load(loop, { gain: 1 });
  console.log(loop?.samples.length, loop?.level_rms, author.bake(texture, { name: "made", grid: { speed: [40, 80], force: [0.5] } }).c);
  return author.library({ mixed, made }, { name: "Two" });
}

export async function importFiles(file: File): Promise<number> {
  setImportLibrary("htex-import.wasm", { worker: () => new Worker("author-worker.js") });
  const importer = await loadImporter();
  const { formats, profiles } = importer.formats();
  const first: ImportFormat | undefined = formats[0];
  const asked: Asked[] = importer.asks({ name: "taps.ahap", bytes: await file.arrayBuffer() });
  const { texture, report }: Imported = await importFile(file, { full_scale: 0.2, quantity: "lateral_force", speed_mm_s: 80, force_n: 0.4, models: "bands", license: "CC0-1.0", onProgress: ({ text }) => console.log(text), signal: new AbortController().signal });
  const here: Imported = importer.importFile({ name: "row.png", bytes: new ArrayBuffer(8) }, { pitch_mm: 0.1 });
  // @ts-expect-error: speeds have their unit in the name.
  await importFile(file, { speed: 80 });
  console.log(first?.keeps, profiles[0]?.low_hz, asked[0]?.words, report.warnings[0]?.text, report.models[0]?.felt?.error_rms_db, report.format, here.report.ranked);
  return texture.toBytes().length;
}

export async function exportTexture(texture: Texture, stroke: File): Promise<number> {
  const importer = await loadImporter();
  const format: ExportFormat | undefined = importer.formats().exports.find(({ settings }) => settings.includes("coding"));
  const { bytes, extension, report }: Exported = await exportFile(texture, format?.name ?? "hjif", { coding: "wavelet", speed_mm_s: 80, force_n: 0.4, seed: 7, signal: new AbortController().signal });
  const along: Exported = await exportFile(texture.toBytes(), "ahap", { stroke, profile: "iphone" });
  const here: Exported = importer.exportFile(texture, "android", { extension: "kt", stroke: { name: "stroke.csv", bytes: new ArrayBuffer(8) } });
  // @ts-expect-error: speeds have their unit in the name.
  await exportFile(texture, "wav", { speed: 80 });
  console.log(extension, report.rights, report.loses, report.notes[0], report.profile, report.limited, report.lost?.felt.error_rms_db, report.lost?.level_db, along.extension, here.bytes.length);
  return bytes.length;
}

export async function playScene(text: ArrayBuffer, texture: Uint8Array): Promise<number> {
  setSceneLibrary("htex-scene.wasm");
  using played: Scene = await scene(text, { "cloth.htex": texture }, { device: "file", settings: { quantity: "acceleration" }, quantity_gain: 0.5 });
  const samples: Float32Array = played.render(new Float32Array(played.rate));
  const left = played.plan.left_out.map(({ name, reason, surface }) => `${name} of ${surface}: ${reason}`);
  // @ts-expect-error: a place has a name for each coordinate.
  played.renderPath([80], 0.4, { position: 3 });
  return samples.length + played.render(2).length + played.renderPath([80, 90], 0.4, { x: 1, y: [0, 1] }).length + left.length + played.notes.length;
}
