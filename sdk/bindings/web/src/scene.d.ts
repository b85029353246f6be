/** Scenes: surfaces, a motion of the finger over them, and a device. All files are in memory. */

import type { NamedBytes } from "./author.js";
import type { Address, Bytes } from "./index.js";

export interface SceneOptions {
  /**
   * Short name or id of a device to use instead of the scene's. No device is opened: the results
   * are the samples that the device would receive.
   */
  device?: string;
  /** Name of a profile of the device, which selects values for its settings. */
  profile?: string;
  settings?: Record<string, string | number | boolean>;
  /**
   * Factor that converts the textures' samples to the device's unit. Only needed if the quantities
   * of textures and device differ.
   */
  quantity_gain?: number;
  /**
   * Whether models that are embedded in textures run. They run in the calling thread, where nothing
   * can stop a call that does not return. Default false.
   */
  trusted?: boolean;
  /**
   * Public keys in hexadecimal digits, of which one must have signed each texture. The signature of
   * the file NAME is the file NAME.sig in `files`.
   */
  onlySignedBy?: string | string[];
}

export interface PlannedStage {
  name: string;
  /** Index of the surface that the stage processes; absent if it processes all surfaces. */
  surface?: number;
  reason: string;
  rate_hz: number;
  /**
   * Time for one sample of the device, nanoseconds, on the machine where the costs were measured.
   */
  ns_per_sample: number;
}

export interface ScenePlan {
  /** The stages that run, in order. */
  stages: PlannedStage[];
  left_out: { name: string; surface?: number; reason: string }[];
  /** The model of each surface that the finger touches. */
  representation: { surface: number; model: string; why: string }[];
  /** Time that the renderer takes in addition to its stages, nanoseconds per sample. */
  renderer_ns: number;
  ns_per_sample_total: number;
  constant: boolean;
  rate_hz: number;
  block_frames: number;
  /** Length of the scene, samples; null if it has no end. */
  frames: number | null;
  costs: string;
  reference_rms: number;
  notes: string[];
}

/** An open scene. */
export interface Scene {
  /** Unit of the samples, which is the device's unit. */
  readonly unit: string;
  /** Sample rate, Hz. */
  readonly rate: number;
  /** The stages that run and the stages that are left out, with reasons. */
  readonly plan: ScenePlan;
  /** Remarks about the scene that are not errors. */
  readonly notes: string[];
  /** Renders the scene from its start. Default `seconds`: the scene's own duration. */
  render(seconds?: number): Float32Array;
  /**
   * Renders the next samples into `out`. Returns the part of the array that was filled. At the end
   * of the scene, this part is shorter than the array.
   */
  render(out: Float32Array): Float32Array;
  /**
   * Renders the scene at another motion, which is given for each block of samples: speed (mm/s,
   * negative on the back stroke), force (N) and place (mm). A single number applies to all blocks.
   * `block` is the number of samples in a block; default 64.
   */
  renderPath(
    speeds: ArrayLike<number> | number,
    forces: ArrayLike<number> | number,
    options?: { x?: ArrayLike<number> | number; y?: ArrayLike<number> | number; block?: number },
  ): Float32Array;
  /** Frees the memory of the scene. It is also freed when the object is garbage-collected. */
  free(): void;
  [Symbol.dispose](): void;
}

/**
 * Opens a scene from the bytes of its file. `files` holds the files that the scene names (textures,
 * recorded motions and responses), by their paths in the scene.
 */
export function scene(bytes: Bytes, files?: Record<string, Bytes | NamedBytes> | Map<string, Bytes | NamedBytes>, options?: SceneOptions): Promise<Scene>;

/** Sets where the module `htex-scene.wasm` comes from. Call this before the first use. */
export function setSceneLibrary(library: Address | Bytes | object): void;
