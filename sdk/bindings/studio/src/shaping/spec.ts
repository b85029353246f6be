// What a texture is made of: a model's parameters at each condition. Read from a texture, changed, and made to a texture again.

import type { Author, MakeOptions, Metadata, Texture } from "htex";

import { sliding } from "../conditions.ts";
import { keptAppearance } from "../look/appearance.ts";

export type Parameters = Readonly<Record<string, number | readonly number[]>>;

export interface Point {
  /** The condition; null where it is not known. */
  readonly speed: number | null;
  readonly force: number | null;
  /** RMS, in the texture's unit. */
  readonly level: number;
  readonly parameters: Parameters;
}

export interface Spec {
  readonly model: string;
  readonly points: readonly Point[];
}

const known = (x: number | undefined) => (x === undefined || Number.isNaN(x) ? null : x);

/** The parameters of a texture's model at all its conditions. */
export function read(texture: Texture, model: string): Spec {
  const stated = texture.manifest.representations.find((one) => one.model === model);
  const { conditions } = texture;
  const points = (stated?.at ?? []).map(({ condition, level_rms }): Point => {
    const own = conditions[condition];
    const [speed, force] = [known(own?.speed), known(own?.force)];
    const question = speed === null && force === null ? { model } : { model, at: { speed: speed ?? 0, force: force ?? 0 } };
    // The level that the file states. A condition at rest plays nothing, but its level counts
    // between conditions.
    return { speed, force, level: level_rms, parameters: texture.parameters(question) as Parameters };
  });
  return { model, points };
}

export interface Frame {
  /** The texture that is changed: its name, quantity, law, contact, metadata and appearance stay. */
  readonly from: Texture;
  /** The specification of that texture, whose spectra need not be made. */
  readonly of?: Spec;
}

/** What a texture states of itself, to be kept in one that is made of it. */
export function metadataOf(manifest: Texture["manifest"]): Metadata {
  const names = ["license", "author", "description", "tags"] as const;
  const stated = names.filter((name) => manifest[name] !== undefined && manifest[name] !== null);
  return Object.fromEntries(stated.map((name) => [name, manifest[name]]));
}

/** Makes a texture of a specification; what else the given texture states stays. */
export function make(author: Author, { from }: Frame, spec: Spec): Texture {
  const { manifest, law } = from;
  const conditions = spec.points.map(({ speed, force, level, parameters }) => ({
    ...(speed === null ? {} : { speed }),
    ...(force === null ? {} : { force }),
    level,
    parameters: parameters as Record<string, number | number[]>,
  }));
  return author.make({
    name: from.name,
    quantity: from.quantity as NonNullable<MakeOptions["quantity"]>,
    contact: from.contact,
    band: from.band,
    law: {
      frequency_speed: law.frequency_speed.exponent,
      level_speed: law.level_speed.exponent,
      level_force: law.level_force.exponent,
    },
    ...metadataOf(manifest),
    ...keptAppearance(manifest),
    representations: [{ model: spec.model, conditions }],
  });
}

/** The spectra of a specification: decibels relative to a thousandth of the unit, at frequencies, for each point. */
export function decibels(author: Author, frame: Frame, spec: Spec, frequencies: ArrayLike<number>): number[][] {
  if (frame.of === spec) return spec.points.map((point) => pointDecibels(frame.from, spec.model, point, frequencies));
  const texture = make(author, frame, spec);
  try {
    return spec.points.map((point) => pointDecibels(texture, spec.model, point, frequencies));
  } finally {
    texture.free();
  }
}

export function pointDecibels(texture: Texture, model: string, point: Point, frequencies: ArrayLike<number>): number[] {
  const magnitude = texture.spectrum(frequencies, { model, at: sliding(point) });
  return Array.from(magnitude, toDecibels);
}

/** Decibels relative to a thousandth of the unit: 1 mN for a force. */
export const toDecibels = (magnitude: number) => 20 * Math.log10(Math.max(magnitude, 1e-15) / 1e-3);

export const fromDecibels = (db: number) => 10 ** (db / 20);

/** A specification with other parameters at each point. */
export function change(spec: Spec, of: (parameters: Parameters, point: Point, index: number) => Partial<Parameters>): Spec {
  const points = spec.points.map((point, i) => ({ ...point, parameters: { ...point.parameters, ...(of(point.parameters, point, i) as Parameters) } }));
  return { ...spec, points };
}

/** A specification whose levels are such that each point has given decibels at a frequency. */
export function anchored(author: Author, frame: Frame, spec: Spec, hz: number, wanted: readonly number[]): Spec {
  const there = decibels(author, frame, spec, [hz]);
  const points = spec.points.map((point, i) => {
    const factor = fromDecibels((wanted[i] ?? 0) - (there[i]?.[0] ?? 0));
    return { ...point, level: point.level * factor };
  });
  return { ...spec, points };
}

export const list = (parameters: Parameters, name: string) => (parameters[name] as readonly number[] | undefined) ?? [];
export const scalar = (parameters: Parameters, name: string) => Number(parameters[name] ?? 0);
export const clamp = (x: number, low: number, high: number) => Math.min(Math.max(x, low), high);
