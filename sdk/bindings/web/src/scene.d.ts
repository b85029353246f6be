/** Scenes: surfaces, a motion and a device, played from memory. */

import type { NamedBytes } from "./author.js";
import type { Address, Bytes } from "./index.js";

export interface SceneOptions {
  /**
   * Another device to use instead of the scene's, by short name or id. It is not opened: the
   * result is the samples that it would receive.
   */
  device?: string;
  /** A profile of the device. */
  profile?: string;
  settings?: Record<string, string | number | boolean>;
  /** Value of one unit of the textures' quantity in the device's unit, if the quantities differ. */
  quantity_gain?: number;
  /**
   * Whether models embedded in textures run, in this thread, where nothing stops them. Default:
   * false.
   */
  trusted?: boolean;
}

export interface PlannedStage {
  name: string;
  /** Its surface; absent for all surfaces. */
  surface?: number;
  reason: string;
  rate_hz: number;
  /** Time per sample of the device, nanoseconds, on the machine where the costs were measured. */
  ns_per_sample: number;
}

export interface ScenePlan {
  /** The stages that run, in order. */
  stages: PlannedStage[];
  left_out: { name: string; surface?: number; reason: string }[];
  /** The model of each surface that the finger touches. */
  representation: { surface: number; model: string; why: string }[];
  /** Cost of the renderer besides its stages, nanoseconds for each sample. */
  renderer_ns: number;
  ns_per_sample_total: number;
  constant: boolean;
  rate_hz: number;
  block_frames: number;
  /** null if it has no end. */
  frames: number | null;
  costs: string;
  reference_rms: number;
  notes: string[];
}

/** An open scene. */
export interface Scene {
  /** Unit of the samples: the device's unit. */
  readonly unit: string;
  /** Sample rate, Hz. */
  readonly rate: number;
  /** Stages that run and stages that are left out, with reasons. */
  readonly plan: ScenePlan;
  /** Findings that are not errors. */
  readonly notes: string[];
  /** Renders the scene from its start, for its own duration or for `seconds`. */
  render(seconds?: number): Float32Array;
  /**
   * Renders the next samples. Returns the part of the array that was rendered, which is shorter at
   * the end of the scene.
   */
  render(out: Float32Array): Float32Array;
  /**
   * Renders the scene at another motion: speed (mm/s, negative on the back stroke), force (N) and
   * place (mm) for each block of samples. A single number applies to all blocks. A block has 64
   * samples.
   */
  renderPath(
    speeds: ArrayLike<number> | number,
    forces: ArrayLike<number> | number,
    options?: { x?: ArrayLike<number> | number; y?: ArrayLike<number> | number; block?: number },
  ): Float32Array;
  /** Frees the memory. It is also freed when the object is garbage-collected. */
  free(): void;
  [Symbol.dispose](): void;
}

/**
 * Opens a scene from the bytes of its file and of the textures, traces and responses that it names,
 * by their paths in it.
 */
export function scene(bytes: Bytes, files?: Record<string, Bytes | NamedBytes> | Map<string, Bytes | NamedBytes>, options?: SceneOptions): Promise<Scene>;

/** Sets where the module `htex-scene.wasm` is. Call this before the first use. */
export function setSceneLibrary(library: Address | Bytes | object): void;
