// A program for Node.js, compiled without the types of the browser; `tsc --strict` checks it.

import { GuardedWorker, HtexError, Library, open } from "htex";
import type { Texture } from "htex";
import { importFile } from "htex/import";

export async function samples(bytes: Uint8Array): Promise<number> {
  const texture: Texture = await open(bytes);
  const voice = texture.voice({ model: "ar", rate: 20000 });
  voice.setMotion(80, 0.5);
  const rendered = await new GuardedWorker().render(texture, 64);
  const library = await Library.open(bytes);
  const { report } = await importFile({ name: "felt.xml", bytes });
  const error = new HtexError() instanceof Error;
  return voice.render(20000).length + rendered.length + library.count + texture.manifest.conditions.length + report.models.length + Number(error);
}
