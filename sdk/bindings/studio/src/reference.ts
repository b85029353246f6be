// What the present texture is compared with: itself as it was opened, and the recording it was fitted to.

import { computed, effect, signal } from "@preact/signals";
import { open, type FitReport, type MakeOptions, type RecordedLoop, type Texture } from "htex";

import { author } from "./author.ts";
import { near, nearest } from "./conditions.ts";
import { isLevelKnown } from "./level.ts";
import { fail, origin } from "./state.ts";
import { toDecibels } from "./shaping/spec.ts";
import { sliders } from "./motion.ts";

export interface Drawn {
  readonly hz: ArrayLike<number>;
  readonly db: readonly number[];
}

export interface Reference {
  readonly opened: Drawn | null;
  readonly recorded: Drawn | null;
  readonly threshold: Drawn | null;
}

const HZ = Float64Array.from({ length: 160 }, (_, i) => 20 * 50 ** (i / 159));

/** The texture as it was opened; its own copy, since the present one is freed with each edit. */
export const opened = signal<{ texture: Texture; model: string } | null>(null);

effect(() => {
  const document = origin.value;
  if (!document) return;
  open(document.bytes).then((texture) => {
    if (origin.peek() !== document) return texture.free();
    opened.peek()?.texture.free();
    opened.value = { texture, model: document.model };
  }, () => {});
});

/** The recordings of the texture that was fitted here, with what was measured; of the bytes that were fitted. */
export interface RecordedWork {
  readonly bytes: Uint8Array;
  readonly names: readonly string[];
  /** Makes the loops of the recordings, as they were read for the fit. */
  readonly loops: () => Promise<readonly RecordedLoop[]>;
  readonly report: FitReport;
  readonly conditions: readonly { speed: number | null; force: number | null }[];
}
export const recordedWork = signal<RecordedWork | null>(null);

/** That of the present piece of work, if it was fitted here. */
export const presentWork = computed(() => {
  const work = recordedWork.value;
  return work && origin.value?.bytes === work.bytes ? work : null;
});

/** The recordings as sound, once they are read. */
const loops = signal<readonly RecordedLoop[]>([]);

effect(() => {
  const work = presentWork.value;
  loops.value = [];
  work?.loops().then((read) => {
    if (presentWork.peek() === work) loops.value = read;
  }, fail);
});

/** The loop of a recording of the present piece of work; undefined until it is read, null if there is no recording. */
export function recordedLoop(name: string): RecordedLoop | null | undefined {
  return presentWork.value && loops.value.find(({ recording }) => recording === name);
}

function nearestRecorded({ report: { spectra }, conditions }: RecordedWork): Drawn | null {
  const found = spectra[nearest(conditions, sliders.value) ?? 0];
  return found ? { hz: found.frequency_hz, db: found.magnitude.map(toDecibels) } : null;
}

const openedDrawn = computed<Drawn | null>(() => {
  const now = opened.value;
  if (!now) return null;
  const { at } = near(now.texture, now.model, sliders.value);
  return { hz: HZ, db: Array.from(now.texture.spectrum(HZ, { model: now.model, at }), toDecibels) };
});

/** The magnitudes at which a finger begins to feel a sinusoid. */
const thresholdDrawn = computed<Drawn | null>(() => {
  const [made, now] = [author.value, opened.value];
  // It is at a level, which the texture may not have.
  if (!made || !now || !isLevelKnown(now.texture)) return null;
  const quantity = now.texture.quantity as NonNullable<MakeOptions["quantity"]>;
  return { hz: HZ, db: Array.from(made.threshold(HZ, { quantity }), toDecibels) };
});

export const reference = computed<Reference>(() => {
  const work = presentWork.value;
  return { opened: openedDrawn.value, recorded: work ? nearestRecorded(work) : null, threshold: thresholdDrawn.value };
});
