// Make textures: fit recordings, write parameters, mix and edit textures. A second WASM module does
// this. It also contains the player, and is loaded when it is first needed.

import { AuthorCore } from "./author-core.js";
import { inThread, setThread, throwIfAborted } from "./author-thread.js";
import { argument, bytesOf, bytesOfTexture, copiesIn, loaded, named } from "./files.js";
import { compiledFrom, library, opened } from "./library.js";

let source = () => new URL("./htex-author.wasm", import.meta.url);
let module;
let author;

/**
 * Sets where the module is (its address, its bytes or a WebAssembly.Module), and how its worker is
 * started if a bundler has moved it. Call this before the first use.
 */
export function setAuthorLibrary(library, { worker = null } = {}) {
  if (library !== undefined) source = () => library;
  [module, author] = [undefined, undefined];
  setThread(worker);
}

function compiled() {
  module ??= compiledFrom(source(), "the author module").catch((error) => {
    module = undefined;
    throw error;
  });
  return module;
}

/** Loads the author module into the calling thread. */
export function loadAuthor() {
  author ??= Promise.all([compiled().then((compiledModule) => AuthorCore.make(compiledModule)), library()])
    .then(([own, player]) => new Author(own, player))
    .catch((error) => {
      author = undefined;
      throw error;
    });
  return author;
}

/**
 * Returns all files that recordings and settings name: first the recordings, then the response,
 * then the trackers.
 */
function filesOf(recordings, { response, tracker }) {
  const list = (one) => (one === undefined || one === null ? [] : Array.isArray(one) ? one : [one]);
  return { recordings: list(recordings), response: list(response), trackers: list(tracker) };
}

/** Calls the module with a document and the bytes of files, which have been loaded. */
function callOf({ recordings, response, trackers }, { response: _, tracker: __, conditions, models, grid, ...settings }) {
  if (recordings.length === 0) throw argument("give at least one recording");
  const names = (files) => files.map((file) => file.name);
  const request = { files: { recordings: names(recordings), response: response[0]?.name, trackers: names(trackers) }, settings };
  if (conditions !== undefined) request.conditions = conditions;
  if (models !== undefined) settings.models = [models].flat();
  if (grid !== undefined) settings.grid = linesOf(grid);
  return { request, files: [...recordings, ...response, ...trackers].map((file) => file.bytes) };
}

/** Converts a grid to lines, as the `htex` command expects them. */
function linesOf(grid) {
  if (typeof grid === "string" || Array.isArray(grid)) return grid;
  const lines = Object.entries(grid).map(([axis, values]) => `${axis}=${values.join(",")}`);
  return lines.length > 0 ? lines : "auto";
}

function eachOf({ recordings, response, trackers }, read) {
  return { recordings: recordings.map(read), response: response.map(read), trackers: trackers.map(read) };
}

/** Makes textures, in the calling thread. */
export class Author {
  constructor(core, player) {
    this.core = core;
    this.player = player;
  }

  texture(bytes) {
    return opened(this.player, bytes);
  }

  /** Returns the descriptors of the models. */
  models() {
    return this.core.call("models", {}).document;
  }

  /** Makes a texture from parameters. */
  make({ representations, quantity, band, unit, extensions, ...metadata }) {
    const { bytes } = this.core.call("make", { representations, quantity, band, metadata, extensions });
    const texture = this.texture(bytes);
    if (unit !== undefined && unit !== texture.unit) {
      texture.free();
      throw argument(`the unit of a ${quantity ?? "lateral_force"} is not ${unit}; leave it out`);
    }
    return texture;
  }

  /** Makes a texture between two others. `weight` is the share of the second. */
  mix(a, b, weight, { extensions, ...metadata } = {}) {
    return this.texture(this.core.call("mix", { weight, metadata, extensions }, [a, b].map(bytesOfTexture)).bytes);
  }

  /** Returns the texture with other metadata or other extensions. */
  edit(texture, { extensions, ...metadata }) {
    return this.texture(this.core.call("edit", { metadata, extensions }, [bytesOfTexture(texture)]).bytes);
  }

  /** Checks a texture, a library or a recording. A recording is recognised by its `name`. */
  validate(bytes, { name } = {}) {
    return this.core.call("validate", { name }, [bytesOf(bytes)]).document;
  }

  /**
   * Returns what a fingertip can feel of the difference between a reference and another texture.
   * Each is played by a model at a motion.
   */
  felt(reference, other) {
    const sideOf = ({ model, at }) => ({ model, at });
    const request = { reference: sideOf(reference), other: sideOf(other) };
    return this.core.call("felt", request, [reference, other].map(({ texture }) => bytesOfTexture(texture))).document;
  }

  /**
   * Returns the detection threshold: for each frequency in Hz, the magnitude, in the quantity's
   * unit, at which a finger just feels a sinusoid.
   */
  threshold(frequencies, { quantity } = {}) {
    return Float64Array.from(this.core.call("threshold", { frequencies: Array.from(frequencies), quantity }).document);
  }

  /** Returns what the code of a finding means; undefined for an unknown code. */
  explain(code) {
    return this.core.call("explain", { code }).document ?? undefined;
  }

  /** Returns the columns of a recording, and how they are interpreted. */
  columns(recording, settings = {}) {
    const { request, files } = callOf(eachOf(filesOf(recording, settings), named), settings);
    return this.core.call("columns", request, files).document;
  }

  /** Reads a recording: its columns, signals, spectrum and findings. */
  process(recording, settings = {}) {
    const { request, files } = callOf(eachOf(filesOf(recording, settings), named), settings);
    const { document, bytes } = this.core.call("process", request, files);
    return { ...document, picture: pictureOf(document.picture, bytes) };
  }

  /**
   * Returns recordings as seamless loops, limited to the band and at the level of models that are
   * fitted to them.
   */
  recorded(recordings, { rate, ...settings } = {}) {
    const { request, files } = callOf(eachOf(filesOf(recordings, settings), named), settings);
    const { document, bytes } = this.core.call("recorded", { ...request, rate }, files);
    return loopsOf(document, bytes);
  }

  /**
   * Bakes a texture: computes a block of data for microcontrollers. `c` and `rust` have the block
   * as source code.
   */
  bake(texture, { name = "texture", model, rate, within, grid } = {}) {
    const { document, bytes } = this.core.call("bake", { name, model, rate, within, grid }, [bytesOfTexture(texture)]);
    return { ...document, bytes };
  }

  /**
   * Returns the licence and the author of a texture. `text` has both as SPDX lines, and `riff` as a
   * chunk to append to a WAV file.
   */
  rights(texture) {
    const { document, bytes } = this.core.call("rights", {}, [bytesOfTexture(texture)]);
    return { ...document, riff: bytes };
  }

  /** Fits models to recordings of a texture. */
  fit(recordings, settings = {}) {
    const { request, files } = callOf(eachOf(filesOf(recordings, settings), named), settings);
    const { document, bytes } = this.core.call("fit", request, files);
    return { texture: this.texture(bytes), report: document };
  }

  /**
   * Packs textures into a `.htexlib` file, under the names that are the keys of `textures`. Each
   * texture must state a licence, unless `unlicensed` is true.
   */
  library(textures, { name = "", unlicensed = false } = {}) {
    const all = Object.entries(textures);
    const request = { name, unlicensed, textures: all.map(([own]) => own) };
    return this.core.call("library", request, all.map(([, texture]) => bytesOfTexture(texture))).bytes;
  }
}

/** Returns the minimum and maximum of each signal in each time step. */
function pictureOf({ signals, steps, ...picture }, bytes) {
  const numbers = new Float32Array(bytes.buffer, bytes.byteOffset, 2 * steps * signals.length);
  const part = (i) => numbers.subarray(i * steps, (i + 1) * steps);
  const drawn = signals.map((signal, i) => [signal, { least: part(2 * i), greatest: part(2 * i + 1) }]);
  return { ...picture, steps, signals: Object.fromEntries(drawn) };
}

/** Splits the samples into loops, which follow one after the other. */
function loopsOf(loops, bytes) {
  const numbers = new Float32Array(bytes.buffer, bytes.byteOffset, bytes.byteLength / 4);
  let end = 0;
  return loops.map(({ samples, ...told }) => ({ ...told, samples: numbers.slice(end, (end += samples)) }));
}

/**
 * Fits models to recordings in a worker. `onProgress` is called with `{ done, of, text }`; `signal`
 * aborts the fit.
 */
export async function fit(recordings, { onProgress, signal, ...settings } = {}) {
  throwIfAborted(signal, "fit");
  const given = filesOf(recordings, settings);
  const ready = await Promise.all([given.recordings, given.response, given.trackers].map((files) => Promise.all(files.map(loaded))));
  const [loadedRecordings, response, trackers] = ready;
  const call = callOf({ recordings: loadedRecordings, response, trackers }, settings);
  const loading = Promise.all([compiled(), library()]);
  const { document, bytes } = await inThread("fit", loading, call, { copies: copiesIn(ready.flat()), onProgress, signal });
  const [, player] = await loading;
  return { texture: opened(player, bytes), report: document };
}
