// Uses each declaration of the package; `tsc --strict` checks it.

import type { Author, FitOptions, Fitted } from "htex";
import { GuardedWorker, HtexError, HtexNode, Library, Texture, Voice, fit, follow, followPointer, loadAuthor, open, prepare, setAuthorLibrary, setLibrary } from "htex";

export async function play(context: AudioContext, element: HTMLElement): Promise<number> {
  setLibrary(new URL("htex.wasm", "https://example.org/"));
  const texture: Texture = await open("cloth.htex", { embedded: false, modules: [new Uint8Array(8)] });
  await prepare(context);
  const node: HtexNode = new HtexNode(context, texture, { model: "ar", seed: 7n, gain: 1, worker: new GuardedWorker({ limit: 100 }) });
  node.speed.setTargetAtTime(80, 0, 0.01);
  node.position = 4;
  node.connect(context.destination);
  const end: () => void = follow(element, node, { force: (pressure) => pressure });
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
  // @ts-expect-error: the rate of a node is that of its context.
  new HtexNode(context, texture, { rate: 8000 });
  return samples.length + guarded.length + texture.spectrum([50], { at: { speed: 80, force: 0.4 } })[0]! + texture.level() + texture.band[0];
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
  const mixed: Texture = author.edit(author.mix(texture, made, 0.5), { author: "A. Weaver" });
  const { columns, picture, findings } = author.process({ name: "felt.csv", bytes: new ArrayBuffer(8) }, { map: "lateral=#2" });
  console.log(report.ranked[0], columns.problem, picture.signals["signal"]?.least[0], author.explain(findings[0]!.code)?.fix);
  // @ts-expect-error: a setting of no table.
  author.columns({ name: "felt.csv", bytes: new ArrayBuffer(8) }, { form_s: 2 });
  setAuthorLibrary("htex-author.wasm", { worker: () => new Worker("author-worker.js") });
  return author.library({ mixed, made }, { name: "Two" });
}
