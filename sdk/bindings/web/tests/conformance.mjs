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

/** The parameters in one array, in the order of the model's descriptor; lists are preceded by their lengths. */
async function flat(texture, at) {
  const named = texture.parameters(at);
  const descriptor = new URL(`../../../../spec/models/${at.model}.json`, import.meta.url);
  const { fields } = JSON.parse(await readFile(descriptor, "utf8"));
  return fields.flatMap(({ name, kind }) => (kind.type === "list" ? [named[name].length, ...named[name]] : [named[name]]));
}

/** The numbers of a case; null for one that the package refuses. */
async function played(texture, frequencies, { model, speed_mm_s: speed, force_n: force }) {
  try {
    // The sign of a speed is only its direction.
    const at = { model, at: speed === undefined && force === undefined ? undefined : { speed: speed && Math.abs(speed), force } };
    // The voice begins at the motion of the case, because the default condition may be refused.
    const motion = at.at && texture.motion(at.at, model);
    const voice = texture.voice({ model, rate: 48000, motion });
    const coverage = motion && voice.coverage(motion);
    voice.free();
    return {
      parameters: await flat(texture, at),
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
  const cases = await Promise.all(question.cases.map((one) => played(texture, question.frequency_hz, one)));
  return { verdict: "valid", values: { cases } };
}

process.stdout.write(JSON.stringify(part === "playing" ? await playing() : await validated()));
