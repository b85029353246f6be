// What is given away: the file with its name and licence, sound, a link, and a player of one file.

import { signal } from "@preact/signals";

import playerAddress from "virtual:player";
import { compressedLibrary, plainBase64 } from "./modules.ts";
import { theAuthor } from "./author.ts";
import { toLink } from "./link.ts";
import { fileName, save, wav } from "./save.ts";
import { isolated } from "./names.ts";
import { add, lostText } from "./shelf.ts";
import { pilotForce, pilotSpeed } from "./motion.ts";
import { edit, present, say, settle, texture } from "./state.ts";

export interface Label {
  readonly name: string;
  readonly license: string;
  readonly author: string;
  readonly tags: string;
  readonly description: string;
}

const WAV_S = 10;
const WAV_HZ = 48_000;

/** Who gives away; asked once, and kept in this tab. */
export const giver = signal({ license: "CC0-1.0", author: "" });

/** The label of the present texture. */
export function labelOf(): Label {
  const manifest = texture.value?.manifest;
  const text = (name: string) => (manifest?.[name] as string | undefined) ?? "";
  return {
    name: texture.value?.name ?? "",
    license: text("license") || giver.value.license,
    author: text("author") || giver.value.author,
    tags: ((manifest?.["tags"] as string[] | undefined) ?? []).join(", "),
    description: text("description"),
  };
}

/** Writes a part of the label into the texture as it is typed: one step of the history until the field is left. */
export async function write(part: Partial<Label>) {
  const made = await theAuthor();
  const [now, document] = [texture.peek(), present.peek()];
  if (!now || !document || part.name?.trim() === "") return;
  const { license = giver.peek().license, author = giver.peek().author } = part;
  giver.value = { license, author };
  const { tags, ...texts } = part;
  const list = tags?.split(",").map((tag) => tag.trim()).filter(Boolean);
  const edited = made.edit(now, list ? { ...texts, tags: list } : texts);
  edit({ texture: edited, bytes: edited.toBytes(), model: document.model, change: "label" }, `label ${Object.keys(part).join()}`);
}

/** Writes the licence and the author that the form shows, if the texture has none. */
export async function complete() {
  await theAuthor();
  const manifest = texture.peek()?.manifest;
  const { license, author } = labelOf();
  const missing = { ...(license && !manifest?.["license"] ? { license } : {}), ...(author && !manifest?.["author"] ? { author } : {}) };
  if (Object.keys(missing).length > 0) await write(missing);
  settle();
}

export function saveTexture() {
  const document = present.peek();
  if (!document) return;
  const file = fileName(document.name, "htex");
  save(document.bytes, file, "application/octet-stream");
  say(`${file} is saved, ${document.bytes.length} bytes.`, "good");
}

export async function keepOnShelf() {
  const document = present.peek();
  if (!document) return;
  const added = await add(document.bytes);
  const lost = lostText([added]);
  say(`${isolated(added.name)} is on your shelf${lost ? `. ${lost}` : ", on this device."}`, lost ? "bad" : "good");
}

/** Ten seconds at the motion of the pad's sliders; full scale is one unit of the texture times the factor that is told. */
export async function saveSound() {
  const [now, document] = [texture.peek(), present.peek()];
  if (!now || !document) return;
  const motion = { speed: pilotSpeed.peek(), force: pilotForce.peek() };
  const voice = now.voice({ model: document.model, rate: WAV_HZ, motion });
  const samples = voice.render(WAV_S * WAV_HZ);
  voice.free();
  const { riff } = (await theAuthor()).rights(now);
  save(wav(samples, WAV_HZ, riff), fileName(document.name, "wav"), "audio/wav");
  say(`${WAV_S} s at ${motion.speed.toFixed(0)} mm/s and ${motion.force.toFixed(2)} N, in ${now.unit}: a full-scale sample is 1 ${now.unit}.`);
}

/** A block for the player on microcontrollers, as a C header: the texture's default condition by the present model. */
export async function saveBlock() {
  const [now, document] = [texture.peek(), present.peek()];
  if (!now || !document) return;
  const file = fileName(document.name, "h");
  const baked = (await theAuthor()).bake(now, { name: file.replace(/\.h$/, ""), model: document.model });
  save(new TextEncoder().encode(baked.c), file, "text/x-c");
  const at = `${baked.speeds.map((x) => x.toFixed(0)).join(", ")} mm/s and ${baked.forces.map((x) => x.toFixed(2)).join(", ")} N`;
  say(`${baked.bytes.length} bytes for a player at ${baked.rate_hz} Hz, of ${at}; nine bands err by up to ${baked.error_at_conditions_db.toFixed(2)} dB there.`);
}

export function link() {
  const document = present.value;
  return document ? toLink(document.bytes, location.href) : "";
}

const escaped = (text: string) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");

/** A page that plays this texture, without anything else. */
export async function savePlayer() {
  const document = present.peek();
  if (!document) return;
  const [template, library] = await Promise.all([fetch(playerAddress).then((one) => one.text()), compressedLibrary()]);
  const license = texture.peek()?.manifest["license"];
  const parts: Record<string, string> = {
    __NAME__: escaped(document.name),
    __LICENSE__: license ? `Licence: ${escaped(String(license))}` : "",
    __LIBRARY__: library,
    __TEXTURE__: await plainBase64(document.bytes),
  };
  const page = template.replaceAll(/__(NAME|LICENSE|LIBRARY|TEXTURE)__/g, (word) => parts[word] ?? "");
  save(new TextEncoder().encode(page), fileName(document.name, "html"), "text/html");
}
