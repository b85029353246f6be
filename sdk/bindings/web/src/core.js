// The C library of `sdk/bindings/capi`, compiled to WASM, with methods that call its C functions.
// Structs have the layout of 32-bit WASM.
//
// The C interface is called directly, without generated bindings. So there is only one interface
// and one set of errors. It also needs no text decoder, which audio worklets lack.

import { Guests, decode, encode } from "./guests.js";

/** Names of the statuses of the C interface (`htex_status`), by number. */
const STATUS = [
  "ok",
  "invalid-argument",
  "bad-handle",
  "busy",
  "io",
  "invalid-asset",
  "no-representation",
  "no-model",
  "model",
  "invalid-motion",
  "invalid-scene",
  "unsupported",
  "truncated",
  "internal",
  "invalid-library",
  "absent",
  "device",
  "not-signed",
];

/** An error of the library; `code` is the kind, such as "invalid-asset". */
export class HtexError extends Error {
  constructor(message, code) {
    super(message);
    this.name = "HtexError";
    this.code = code;
  }
}

/** Sizes of the structs htex_open_options, htex_voice_options, htex_bytes and htex_envelope. */
const OPEN_OPTIONS = 52;
const VOICE_OPTIONS = 80;
const BYTES = 8;
const ENVELOPE = 32;
/** Largest number of bands in an envelope. */
const MOST_BANDS = 32;
/** Size of htex_motion. */
export const MOTION = 48;
/** HTEX_ENGINE_CHECKED. The browser itself runs the modules that are passed in or allowed. */
const ENGINE = 1;
/** Bytes reserved for results at the start of each call. */
const RESULTS = ENVELOPE + 8 * (MOST_BANDS + 1);
/** Number of frames rendered at once. Longer blocks are rendered in parts. */
export const BLOCK = 4096;

/**
 * Writes a htex_motion to an address. Its size is written as an integer, because the same bits as a
 * float would be a subnormal number, which an audio thread may round to zero.
 */
export function writeMotion(view, at, { speed = 0, force = 0, position = NaN, x = NaN, y = NaN }) {
  view.setUint32(at, MOTION, true);
  view.setUint32(at + 4, 0, true);
  view.setFloat64(at + 8, speed, true);
  view.setFloat64(at + 16, force, true);
  view.setFloat64(at + 24, position, true);
  view.setFloat64(at + 32, x, true);
  view.setFloat64(at + 40, y, true);
}

function fault(error) {
  return new HtexError(`an error of the library itself; please report it: ${error.message}`, "internal");
}

export class Core {
  /** Instantiates the library synchronously, from the compiled module or its bytes. */
  static now(library) {
    const guests = new Guests();
    const module = library instanceof WebAssembly.Module ? library : new WebAssembly.Module(library);
    return new Core(new WebAssembly.Instance(module, { htex: guests.imports() }), guests);
  }

  /**
   * Instantiates the compiled library. It refuses models in WASM modules unless `runsModules` is
   * true.
   */
  static async make(module, { runsModules }) {
    const guests = new Guests({ runsModules });
    return new Core(await WebAssembly.instantiate(module, { htex: guests.imports() }), guests);
  }

  constructor(instance, guests) {
    this.exports = instance.exports;
    guests.memory = this.exports.memory;
    this.results = this.allocate(RESULTS);
    this.rendering = this.allocate(4 * BLOCK);
    this.samples = new Float32Array(0);
  }

  version() {
    const at = this.exports.htex_version();
    const bytes = new Uint8Array(this.exports.memory.buffer, at);
    return decode(bytes.subarray(0, bytes.indexOf(0)));
  }

  /** Calls a function that returns a status. */
  call(name, ...values) {
    let status;
    try {
      status = this.exports[name](...values);
    } catch (error) {
      throw fault(error);
    }
    if (status !== 0) throw this.error(status);
  }

  /**
   * Renders at most BLOCK frames of a voice. The samples stay in the library's memory until the
   * next call.
   */
  render(id, frames) {
    let status;
    try {
      status = this.exports.htex_voice_render(id, this.rendering, frames);
    } catch (error) {
      throw fault(error);
    }
    if (status !== 0) throw this.error(status);
    // When memory grows, existing views of it become empty.
    if (this.samples.length !== frames) this.samples = new Float32Array(this.exports.memory.buffer, this.rendering, frames);
    return this.samples;
  }

  /**
   * Returns the level and mean frequency of what a voice played since the last call. Writes the
   * mean square in each band to a Float64Array.
   */
  envelope(id, bands) {
    const at = this.results;
    this.view().setUint32(at, ENVELOPE, true);
    this.call("htex_voice_envelope", id, at, at + ENVELOPE, bands.length);
    const view = this.view();
    for (let i = 0; i < bands.length; i++) bands[i] = view.getFloat64(at + ENVELOPE + 8 * i, true);
    return {
      level: view.getFloat64(at + 8, true),
      centroid: view.getFloat64(at + 16, true),
      frames: Number(view.getBigUint64(at + 24, true)),
      bands,
    };
  }

  error(status) {
    const at = this.exports.htex_last_error();
    const bytes = new Uint8Array(this.exports.memory.buffer, at);
    return new HtexError(decode(bytes.slice(0, bytes.indexOf(0))), STATUS[status] ?? `status-${status}`);
  }

  view() {
    return new DataView(this.exports.memory.buffer);
  }

  allocate(bytes) {
    const at = this.exports.htex_alloc(bytes);
    if (at === 0) throw new HtexError(`${bytes} bytes of memory cannot be allocated`, "internal");
    return at;
  }

  /** Runs `body` with an arena: `take(bytes)` allocates memory that is freed afterwards. */
  scope(body) {
    const taken = [];
    const take = (bytes) => {
      const at = this.allocate(bytes);
      taken.push([at, bytes]);
      return at;
    };
    try {
      return body(take);
    } finally {
      for (const [at, bytes] of taken) this.exports.htex_free(at, bytes);
    }
  }

  /** Copies bytes to memory in an arena. */
  put(take, bytes) {
    const at = take(Math.max(bytes.length, 1));
    new Uint8Array(this.exports.memory.buffer, at, bytes.length).set(bytes);
    return at;
  }

  putText(take, text) {
    if (text === undefined || text === null) return 0;
    return this.put(take, encode(`${text}\0`));
  }

  /** Copies 64-bit numbers to an address that is a multiple of 8. */
  putNumbers(take, numbers) {
    const at = take(8 * Math.max(numbers.length, 1));
    new Float64Array(this.exports.memory.buffer, at, numbers.length).set(numbers);
    return at;
  }

  putMotion(take, motion) {
    if (!motion) return 0;
    const at = take(MOTION);
    writeMotion(this.view(), at, motion);
    return at;
  }

  /** Writes an array of texts. */
  putTexts(take, texts) {
    const list = take(4 * Math.max(texts.length, 1));
    texts.forEach((text, i) => {
      const at = this.putText(take, text);
      this.view().setUint32(list + 4 * i, at, true);
    });
    return list;
  }

  /** Writes the options for opening; see `OpenOptions` in index.d.ts. */
  putOpenOptions(take, { modules = [], embedded = true, onlySignedBy = [], signature = new Uint8Array(0) }) {
    const list = take(BYTES * Math.max(modules.length, 1));
    modules.forEach((module, i) => {
      const bytes = toBytes(module);
      const at = this.put(take, bytes);
      this.view().setUint32(list + BYTES * i, at, true);
      this.view().setUint32(list + BYTES * i + 4, bytes.length, true);
    });
    const [keys, signed] = [this.putTexts(take, onlySignedBy), this.put(take, signature)];
    const at = take(OPEN_OPTIONS);
    const view = this.view();
    new Uint8Array(view.buffer, at, OPEN_OPTIONS).fill(0);
    view.setUint32(at, OPEN_OPTIONS, true);
    view.setUint32(at + 4, ENGINE, true);
    view.setUint32(at + 16, list, true);
    view.setUint32(at + 20, modules.length, true);
    view.setUint32(at + 28, embedded ? 0 : 1, true);
    view.setUint32(at + 36, keys, true);
    view.setUint32(at + 40, onlySignedBy.length, true);
    view.setUint32(at + 44, signed, true);
    view.setUint32(at + 48, signature.length, true);
    return at;
  }

  /** Writes the options of a voice; see `VoiceOptions` in index.d.ts. */
  putVoiceOptions(take, options) {
    const { model, rate = 20_000, seed = 0, motion, synthesis, ceiling = 0, fluctuation = false } = options;
    const { frequencyScaling = true, levelScaling = true, contact = true, gain = 0, limit = 0, bands = 0 } = options;
    const texts = [this.putText(take, model), this.putMotion(take, motion), this.putText(take, synthesis)];
    const at = take(VOICE_OPTIONS);
    const view = this.view();
    new Uint8Array(view.buffer, at, VOICE_OPTIONS).fill(0);
    view.setUint32(at, VOICE_OPTIONS, true);
    view.setUint32(at + 4, texts[0], true);
    view.setFloat64(at + 8, rate, true);
    view.setBigUint64(at + 16, BigInt.asUintN(64, BigInt(seed)), true);
    view.setUint32(at + 24, texts[1], true);
    view.setUint32(at + 28, texts[2], true);
    view.setFloat64(at + 32, gain, true);
    view.setFloat64(at + 40, limit, true);
    view.setUint32(at + 48, bands, true);
    view.setUint32(at + 52, frequencyScaling ? 0 : 1, true);
    view.setUint32(at + 56, levelScaling ? 0 : 1, true);
    view.setUint32(at + 60, contact ? 0 : 1, true);
    view.setFloat64(at + 64, ceiling, true);
    view.setUint32(at + 72, fluctuation ? 1 : 0, true);
    return at;
  }

  /** Returns the text that a function writes. First calls the function to get the text's length. */
  text(name, ...values) {
    this.call(name, ...values, 0, 0, this.results);
    const len = this.view().getUint32(this.results, true);
    return this.scope((take) => {
      const at = take(len + 1);
      this.call(name, ...values, at, len + 1, 0);
      return decode(new Uint8Array(this.exports.memory.buffer, at, len));
    });
  }
}

/** Bytes of an ArrayBuffer, a typed array or a DataView. */
export function toBytes(data) {
  if (data instanceof ArrayBuffer) return new Uint8Array(data);
  if (ArrayBuffer.isView(data)) return new Uint8Array(data.buffer, data.byteOffset, data.byteLength);
  throw new HtexError("bytes are an ArrayBuffer, a typed array or a DataView", "invalid-argument");
}
