// Uses each declaration of the package; `tsc --strict` checks it.

import { GuardedWorker, HtexError, HtexNode, Library, Texture, Voice, follow, followPointer, open, prepare, setLibrary } from "htex";

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
  const bytes: Uint8Array = await library.bytes("oak");
  console.log(library.name, library.count - bytes.length, (await library.entry("oak"))?.blake3);
  library.free();
  return found;
}
