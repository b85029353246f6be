// Makes the shelf's library of `textures.json` by the `htex` command.
//
//   node shelf/make.mjs HTEX OUT.htexlib
//
// Simulated textures are recorded at four motions, and have four models; those made by hand have one. All are given away under CC0-1.0.

import { execFileSync } from "node:child_process";
import { mkdirSync, mkdtempSync, readFileSync, rmSync, writeFileSync } from "node:fs";
import { tmpdir } from "node:os";
import path from "node:path";

const [htex, out] = process.argv.slice(2);
const folder = mkdtempSync(path.join(tmpdir(), "htex-shelf-"));
const textures = path.join(folder, "textures");
const run = (...words) => execFileSync(path.resolve(htex), words.map(String), { stdio: ["ignore", "ignore", "inherit"] });
const { simulated, made } = JSON.parse(readFileSync(new URL("./textures.json", import.meta.url), "utf8"));
const file = (name) => path.join(textures, `${name}.htex`);

/** Writes what a texture is: its name, licence, tags, description and appearance. `origin` says where its numbers come from. */
function label({ name, tags, description, appearance }, tag, origin) {
  const look = path.join(folder, "appearance.json");
  writeFileSync(look, JSON.stringify(appearance));
  const all = ["--name", name, "--license", "CC0-1.0", "--tag", [tag, ...tags].join(","), "--description", `${description} ${origin}`];
  run("edit", file(name), ...all, "--extension", `org.htex.appearance/1=${look}`);
}

mkdirSync(textures);
for (const one of simulated) {
  const recordings = [];
  for (const speed of [70, 110]) {
    for (const force of [0.3, 0.8]) {
      const recording = path.join(folder, `${one.surface} ${speed} ${force}.csv`);
      run("simulate", "--surface", one.surface, "--speed", speed, "--force", force, "--seconds", 10, "-o", recording);
      recordings.push(recording);
    }
  }
  run("fit", ...recordings, "-o", file(one.name), "--model", "bands,ar,sslope,sbeta");
  label(one, "simulated", "A simulated finger slid over a simulated surface. This is not a measurement.");
}
for (const one of made) {
  const set = one.set.flatMap((text) => ["--set", text]);
  run("make", "--model", one.model, ...set, "--level", one.level, "--at", "speed=80,force=0.4", "-o", file(one.name));
  label(one, "by hand", "Made by hand, at 80 mm/s and 0.4 N. This is not a measurement.");
}
run("lib", "pack", path.resolve(out), textures, "--name", "Studio shelf");
rmSync(folder, { recursive: true });
