// Saving and sharing: the file with its name and licence, the shelf, a link, a player page, sound and a block for microcontrollers.

import { computed, signal } from "@preact/signals";

import playerAddress from "virtual:player";
import { base64, compressedLibrary } from "./modules.ts";
import { theAuthor } from "./author.ts";
import { finish } from "./first-steps.ts";
import { toLink } from "./link.ts";
import { fileName, save, wav } from "./save.ts";
import { isolated } from "./names.ts";
import { add, lostText } from "./shelf.ts";
import { pilotForce, pilotSpeed } from "./motion.ts";
import type { PlayerOptions } from "./player/options.ts";
import { edit, origin, present, say, screen, settle, texture } from "./state.ts";

export interface Label {
  readonly name: string;
  readonly license: string;
  readonly author: string;
  readonly tags: string;
  readonly description: string;
}

/** Seconds of a saved sound. */
export const SOUND_S = 10;
const WAV_HZ = 48_000;

/** Licence and author that were entered last in this tab. New textures begin with them. */
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

/** What was last saved as a file or kept on the shelf. */
const savedBytes = signal<Uint8Array | null>(null);

/** Whether the texture was changed since it was opened or saved. */
export const isUnsaved = computed(() => {
  const bytes = present.value?.bytes;
  return bytes !== origin.value?.bytes && bytes !== savedBytes.value;
});

/** Whether the large button waits for the keyboard. */
let isAsked = false;

/** Opens the screen *Save*, where the keyboard goes on at the large button. */
export function toSave() {
  isAsked = true;
  screen.value = "give";
}

/** Gives the large button the keyboard, if it waits for it. */
export function takeFocus(button: HTMLElement | null) {
  if (!button || !isAsked) return;
  isAsked = false;
  button.focus({ preventScroll: true });
}

export function saveTexture() {
  const document = present.peek();
  if (!document) return;
  const file = fileName(document.name, "htex");
  save(document.bytes, file, "application/octet-stream");
  savedBytes.value = document.bytes;
  finish("keep");
  say(`${file} is saved, ${document.bytes.length} bytes.`, "good");
}

export async function keepOnShelf() {
  const document = present.peek();
  if (!document) return;
  const added = await add(document.bytes);
  savedBytes.value = document.bytes;
  finish("keep");
  const lost = lostText([added]);
  say(`${isolated(added.name)} is on the shelf${lost ? `. ${lost}` : ", on this device."}`, lost ? "bad" : "good");
}

/** Saves ten seconds at the motion of the pad's sliders. Full scale is one unit of the texture. */
export async function saveSound() {
  const [now, document] = [texture.peek(), present.peek()];
  if (!now || !document) return;
  const motion = { speed: pilotSpeed.peek(), force: pilotForce.peek() };
  const voice = now.voice({ model: document.model, rate: WAV_HZ, motion });
  const samples = voice.render(SOUND_S * WAV_HZ);
  voice.free();
  const { riff } = (await theAuthor()).rights(now);
  save(wav(samples, WAV_HZ, riff), fileName(document.name, "wav"), "audio/wav");
  say(`${SOUND_S} s at ${motion.speed.toFixed(0)} mm/s and ${motion.force.toFixed(2)} N, in ${now.unit}: a full-scale sample is 1 ${now.unit}.`);
}

/** Saves a block for the player on microcontrollers, as a C header: the present model at the texture's default condition. */
export async function saveBlock() {
  const [now, document] = [texture.peek(), present.peek()];
  if (!now || !document) return;
  const file = fileName(document.name, "h");
  const baked = (await theAuthor()).bake(now, { name: file.replace(/\.h$/, ""), model: document.model });
  save(new TextEncoder().encode(baked.c), file, "text/x-c");
  const at = `${baked.speeds.map((x) => x.toFixed(0)).join(", ")} mm/s and ${baked.forces.map((x) => x.toFixed(2)).join(", ")} N`;
  say(`${baked.bytes.length} bytes for a player at ${baked.rate_hz} Hz, made at ${at}. There, the largest error of nine bands is ${baked.error_at_conditions_db.toFixed(2)} dB.`);
}

export function link() {
  const document = present.value;
  return document ? toLink(document.bytes, location.href) : "";
}

export async function copyLink() {
  await navigator.clipboard.writeText(link());
  finish("keep");
  say("The link is copied.", "good");
}

const escaped = (text: string) => text.replaceAll("&", "&amp;").replaceAll("<", "&lt;");

/** The page of a player with places for a texture. The page of one file has it compressed. */
async function playerTemplate() {
  const { headers, body } = await fetch(playerAddress);
  if (!body) throw new Error("The player page cannot be read. Reload this page.");
  const isCompressed = headers.get("content-type") === "application/gzip";
  return new Response(isCompressed ? body.pipeThrough(new DecompressionStream("gzip")) : body).text();
}

/** The address of this page, for *Open in the studio*; null for a file, and for a server of this machine, whose name is secret. */
function studioAddress() {
  const { protocol, hostname, href } = location;
  return protocol.startsWith("http") && !hostname.endsWith(".localhost") ? href.split("#")[0] : null;
}

/** Saves a page that plays this texture, in one file. */
export async function savePlayer() {
  const document = present.peek();
  if (!document) return;
  const [template, library] = await Promise.all([playerTemplate(), compressedLibrary()]);
  const { model, name } = document;
  const options: PlayerOptions = { model, file: fileName(name, "htex"), studio: studioAddress() ?? null, speed: pilotSpeed.peek(), force: pilotForce.peek() };
  const parts: Record<string, string> = {
    __NAME__: escaped(name),
    // No text in it can end the script element.
    __OPTIONS__: JSON.stringify(options).replaceAll("<", "\\u003c"),
    __LIBRARY__: library,
    __TEXTURE__: base64(document.bytes),
  };
  const page = template.replaceAll(/__(NAME|OPTIONS|LIBRARY|TEXTURE)__/g, (word) => parts[word] ?? "");
  const file = fileName(name, "html");
  save(new TextEncoder().encode(page), file, "text/html");
  finish("keep");
  say(`${file} is saved. Open it in any browser.`, "good");
}
