// Scenes: surfaces, a motion of the finger over them, and a device. All files are in memory. A
// third WASM module plays scenes. It is loaded when it is first needed.

import { AuthorCore } from "./author-core.js";
import { HtexError, toBytes } from "./core.js";
import { compiledFrom } from "./library.js";
import { checked, signedBy } from "./options.js";

let source = () => new URL("./htex-scene.wasm", import.meta.url);
let core;

/** Options for opening a scene. */
const OPTIONS = { device: "string", profile: "string", settings: "any", quantity_gain: "number", trusted: "boolean", onlySignedBy: "any" };

/** Frees scenes that their owner did not free. */
const abandoned = typeof FinalizationRegistry === "undefined" ? null : new FinalizationRegistry(({ core, id }) => core.call("scene-free", { id }));

/**
 * Sets where the module is: its address, its bytes or a WebAssembly.Module. Call this before the
 * first use.
 */
export function setSceneLibrary(library) {
  if (library !== undefined) source = () => library;
  core = undefined;
}

function loaded() {
  core ??= compiledFrom(source(), "the module of scenes")
    .then((module) => AuthorCore.make(module))
    .catch((error) => {
      core = undefined;
      throw error;
    });
  return core;
}

function argument(text) {
  return new HtexError(text, "invalid-argument");
}

/**
 * Opens a scene from the bytes of its file. `files` holds the files that the scene names, by their
 * paths in the scene.
 */
export async function scene(bytes, files = {}, options = {}) {
  checked(options, OPTIONS, "scene");
  const named = files instanceof Map ? [...files] : Object.entries(files);
  const given = [bytes, ...named.map(([, file]) => file?.bytes ?? file)].map((file) => toBytes(file));
  const { trusted = false, onlySignedBy, ...device } = options;
  const { onlySignedBy: keys = [] } = signedBy({ onlySignedBy }, "scene");
  const request = { files: named.map(([name]) => name), trusted, only_signed_by: keys, device };
  const ready = await loaded();
  return new Scene(ready, ready.call("scene", request, given).document);
}

/** An open scene. */
export class Scene {
  constructor(core, { id, unit, rate, plan, notes }) {
    Object.assign(this, { core, id, unit, rate, plan, notes });
    abandoned?.register(this, { core, id }, this);
  }

  /**
   * Renders the scene from its start, for the given number of seconds or for its own duration. If a
   * Float32Array is passed in, renders the next samples into it, and returns the part of it that
   * was filled. At the end of the scene, this part is shorter than the array.
   */
  render(given) {
    if (given instanceof Float32Array) {
      const samples = this.samples("scene-next", { frames: given.length });
      given.set(samples);
      return given.subarray(0, samples.length);
    }
    if (given !== undefined && typeof given !== "number") throw argument("scene.render takes seconds, or a Float32Array");
    return this.samples("scene-render", { seconds: given });
  }

  /**
   * Renders the scene at another motion: a speed, a force and, if known, a place for each block of
   * samples. A single number applies to all blocks.
   */
  renderPath(speeds, forces, { x, y, block = 64 } = {}) {
    if ((x === undefined) !== (y === undefined)) throw argument("a place has two coordinates; give x and y, or neither");
    const series = [speeds, forces, x ?? NaN, y ?? NaN];
    const lengths = series.filter((one) => typeof one !== "number").map((one) => one.length);
    if (lengths.length === 0) throw argument("give an array for at least one of speeds, forces, x and y: a number for each block");
    if (lengths.some((length) => length !== lengths[0])) throw argument("the arrays of the motion differ in length");
    const numbers = new DataView(new ArrayBuffer(8 * series.length * lengths[0]));
    for (let i = 0; i < lengths[0]; i++) {
      series.forEach((one, k) => numbers.setFloat64(8 * (series.length * i + k), typeof one === "number" ? one : one[i], true));
    }
    return this.samples("scene-path", { block }, [new Uint8Array(numbers.buffer)]);
  }

  samples(name, request, files = []) {
    const { bytes } = this.core.call(name, { id: this.id, ...request }, files);
    return new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
  }

  /**
   * Frees the memory of the scene. The scene cannot be used afterwards. A second call does nothing.
   */
  free() {
    if (this.isFreed) return;
    this.isFreed = true;
    abandoned?.unregister(this);
    this.core.call("scene-free", { id: this.id });
  }
}

if (Symbol.dispose) {
  Scene.prototype[Symbol.dispose] = function () {
    this.free();
  };
}
