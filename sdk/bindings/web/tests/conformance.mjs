// The npm package as a reader of `htex conformance run` (spec/conformance-protocol.md):
// `node conformance.mjs PACKAGE PART FILE`, with the folder of the package. The parts are assets, libraries,
// recordings without arguments, and playing.

import { readFile } from "node:fs/promises";
import path from "node:path";
import { pathToFileURL } from "node:url";

const [folder, part, file] = process.argv.slice(2);
const { loadAuthor, open } = await import(pathToFileURL(path.resolve(folder, "index.node.js")));

async function validated() {
  const author = await loadAuthor();
  const { valid, findings } = author.validate(await readFile(file), { name: path.basename(file) });
  return {
    verdict: valid ? "valid" : "invalid",
    findings: findings.map(({ code, pointer }) => ({ code, pointer })),
  };
}

/** The parameters in one array, in the order of the representation's fields; lists are preceded by their lengths. */
function flat(texture, at) {
  const named = texture.parameters(at);
  const { fields } = texture.manifest.representations.find(({ model }) => model === at.model);
  return fields.flatMap(({ name, list }) => (list ? [named[name].length, ...named[name]] : [named[name]]));
}

/** The numbers of a case; null for one that the package refuses. */
function played(texture, frequencies, { model, speed_mm_s: speed, force_n: force }) {
  try {
    const at = { model, at: speed === undefined ? undefined : { speed, force } };
    const voice = texture.voice({ model, rate: 48000 });
    const coverage = at.at ? voice.coverage(at.at) : undefined;
    voice.free();
    return {
      parameters: flat(texture, at),
      frequency_factor: coverage?.frequencyFactor ?? 1,
      level_rms: texture.level(at),
      magnitude: [...texture.spectrum(frequencies, at)],
    };
  } catch (error) {
    console.error(String(error));
    return null;
  }
}

async function playing() {
  const question = JSON.parse(await readFile(file, "utf8"));
  const texture = await open(await readFile(question.asset));
  const cases = question.cases.map((one) => played(texture, question.frequency_hz, one));
  return { verdict: "valid", values: { cases } };
}

process.stdout.write(JSON.stringify(part === "playing" ? await playing() : await validated()));
