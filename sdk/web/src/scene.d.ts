/** Scenes: surfaces, a motion and a device, played from memory. */

import type { NamedBytes } from "./author.js";
import type { Address, Bytes } from "./index.js";

export interface SceneOptions {
  /** Another device, by short name or id, in place of the scene's. It is not opened: the samples are those that it would be given. */
  device?: string;
  /** A profile of the device. */
  profile?: string;
  settings?: Record<string, string | number | boolean>;
  /** What one unit of the textures' quantity is in the device's unit, where they differ. */
  quantity_gain?: number;
  /** Whether models that textures bring along run, in this thread, where nothing stops them. Default: false. */
  trusted?: boolean;
}

export interface PlannedStage {
  name: string;
  /** Its surface; none: all surfaces. */
  surface?: number;
  reason: string;
  rate_hz: number;
  /** Time on the machine that the costs are of, nanoseconds for each sample of the device. */
  ns_per_sample: number;
}

export interface ScenePlan {
  /** The stages that run, in their order. */
  stages: PlannedStage[];
  left_out: { name: string; surface?: number; reason: string }[];
  /** The model of each surface that is touched. */
  representation: { surface: number; model: string; why: string }[];
  /** Cost of the renderer besides its stages, nanoseconds for each sample. */
  renderer_ns: number;
  ns_per_sample_total: number;
  constant: boolean;
  rate_hz: number;
  block_frames: number;
  /** null: it has no end. */
  frames: number | null;
  costs: string;
  reference_rms: number;
  notes: string[];
}

/** A scene that is open. */
export interface Scene {
  /** Unit of the samples: that of the device. */
  readonly unit: string;
  /** Rate of the samples, Hz. */
  readonly rate: number;
  /** Stages that run and that are left out, with reasons. */
  readonly plan: ScenePlan;
  /** Findings that are no errors. */
  readonly notes: string[];
  /** Renders the scene from its start, for its own length or `seconds`. */
  render(seconds?: number): Float32Array;
  /** Renders the next samples; returns the part of the array that was rendered, which is shorter at the end of the scene. */
  render(out: Float32Array): Float32Array;
  /** Renders the scene at another motion: speed (mm/s, negative on the back stroke), force (N) and place (mm) for each block of
   * samples; a number is that of all blocks. A block has 64 samples. */
  renderPath(
    speeds: ArrayLike<number> | number,
    forces: ArrayLike<number> | number,
    options?: { x?: ArrayLike<number> | number; y?: ArrayLike<number> | number; block?: number },
  ): Float32Array;
  /** Frees the memory; it is freed with the object, too. */
  free(): void;
  [Symbol.dispose](): void;
}

/** Opens a scene: the bytes of its file, and those of the textures, traces and responses that it names, by their paths in it. */
export function scene(bytes: Bytes, files?: Record<string, Bytes | NamedBytes> | Map<string, Bytes | NamedBytes>, options?: SceneOptions): Promise<Scene>;

/** Sets where the module `htex-scene.wasm` is. Before the first use. */
export function setSceneLibrary(library: Address | Bytes | object): void;
