// Four textures in the corners of a pad, and what is between them.

import { computed, signal, untracked } from "@preact/signals";
import type { Author, Texture } from "htex";

import { theAuthor } from "./author.ts";
import { isSame } from "./bytes.ts";
import { tried } from "./engine.ts";
import type { Opened } from "./item.ts";
import { EXTENSION, mixed as mixedLook } from "./look/appearance.ts";
import { appearanceOf } from "./look/guess.ts";
import { items } from "./shelf.ts";
import { BANDS, redrawn } from "./shaping/bands.ts";
import { make, read } from "./shaping/spec.ts";
import { edit, origin, present, texture } from "./state.ts";

/**
 * Ids of the textures in the corners: upper left, upper right, lower left, lower right. "" is the
 * present texture; null is a corner that nobody has chosen.
 */
export const corners = signal<readonly (string | null)[]>([null, null, null, null]);
/** Where the mixture is, 0 to 1. */
export const place = signal({ x: 0.5, y: 0.5 });

/** Names for corners that nobody has chosen. The upper left one has the present texture instead. */
const DEFAULTS = ["Corduroy", "Leather", "Frosted glass", "Denim", "Oak", "Cork", "Silk"];

/**
 * Id of the item of the shelf that is on the pad, unchanged. The lists of the corners leave it out,
 * because they offer the texture on the pad.
 */
export const onPad = computed(() => {
  const now = present.value;
  return items.value.find(({ bytes }) => now && isSame(bytes, now.bytes))?.id;
});

/**
 * The texture of each corner. A default does not repeat another corner, and is not the texture that
 * the present one was made from.
 */
export const chosen = computed(() => {
  const begun = origin.value?.bytes;
  // A chosen texture may be on the pad by now. The texture on the pad has only one corner.
  const all = corners.value.map((id) => (id !== null && id === onPad.value ? "" : id));
  const own = all.map((id, i) => (id === "" && all.indexOf("") < i ? null : id));
  const free = DEFAULTS.filter((id) => !own.includes(id) && id !== onPad.value && items.value.some((item) => item.id === id && !(begun && isSame(item.bytes, begun))));
  return own.map((id, i) => id ?? (i === 0 && !own.includes("") ? "" : free.shift() ?? ""));
});

/** Parts of the corners. */
export const parts = computed(() => {
  const { x, y } = place.value;
  return [(1 - x) * (1 - y), x * (1 - y), (1 - x) * y, x * y];
});

/** The open texture of a corner; null until it is open. */
function openedOf(id: string): Opened | null {
  const item = items.value.find((one) => one.id === id);
  if (item) return item.opened.value;
  const [now, model] = [texture.value, present.value?.model];
  return now && model ? { texture: now, model } : null;
}

export const openedCorners = computed(() => chosen.value.map(openedOf));

/** Corners as Bands, by the item they are of: all textures have this model, so that all can be mixed. */
const asBands = new Map<string, { of: unknown; texture: Texture }>();

function bandsOf(author: Author, id: string): Texture | null {
  const opened = untracked(() => openedOf(id));
  const of = items.peek().find((one) => one.id === id) ?? present.peek();
  if (!opened) return null;
  const { texture: source, model } = opened;
  const cached = asBands.get(id);
  if (cached?.of === of) return cached.texture;
  cached?.texture.free();
  const spec = read(source, source.models.includes(BANDS) ? BANDS : model);
  const bands = spec.model === BANDS ? spec : redrawn({ author, from: source, shown: 0 }, spec);
  const made = make(author, { from: source }, bands);
  asBands.set(id, { of, texture: made });
  return made;
}

const percent = (part: number) => `${Math.round(100 * part)} %`;

/** The mixture at the place; its provenance names what it was mixed of. */
async function mixture(): Promise<Texture | null> {
  const author = await theAuthor();
  const wanted = new Set(chosen.peek());
  await Promise.all(items.peek().map((item) => wanted.has(item.id) && item.open()));
  const four = chosen.peek().map((id) => bandsOf(author, id));
  const looks = openedCorners.peek().flatMap((one) => (one ? [appearanceOf(one.texture)] : []));
  const [a, b, c, d] = four;
  if (!a || !b || !c || !d) return null;
  const { x, y } = place.peek();
  const between = (one: Texture, two: Texture, part: number) => author.mix(one, two, part, { name: `${percent(1 - part)} ${one.name}, ${percent(part)} ${two.name}` });
  const [upper, lower] = [between(a, b, x), between(c, d, x)];
  const shares = parts.peek().map((part, i) => [part, four[i]?.name] as const).filter(([part]) => part > 0.005);
  const name = shares.map(([part, own]) => `${percent(part)} ${own}`).join(", ");
  const extensions = { [EXTENSION]: mixedLook(looks, parts.peek()) };
  const mixed = author.mix(upper, lower, y, { name: name.length > 90 ? `Mixture of ${shares.length}` : name, extensions });
  upper.free();
  lower.free();
  return mixed;
}

let sounding: Texture | null = null;

/** Plays the mixture at the place. */
export async function listen() {
  const mixed = await mixture();
  if (!mixed) return;
  const before = sounding;
  sounding = mixed;
  tried.value = { texture: mixed, model: BANDS, own: true };
  before?.free();
}

export function endListening() {
  if (tried.peek()?.texture === sounding) tried.value = null;
  sounding?.free();
  sounding = null;
}

/** Takes the mixture as the next step of the present texture. */
export async function takeMixture() {
  const mixed = await mixture();
  if (!mixed) return;
  endListening();
  edit({ texture: mixed, bytes: mixed.toBytes(), model: BANDS, change: "mix" });
}

