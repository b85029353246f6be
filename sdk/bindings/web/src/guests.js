// Runs models in WASM modules, which the WASM library (the core) cannot run itself. A *guest* is a
// module that is instantiated here. The core passes addresses in its own memory. It refers to
// guests by handles, which are numbers above 0.

const I32 = 0;
const I64 = 1;
const F64 = 2;

export class Guests {
  constructor({ runsModules = true } = {}) {
    this.runsModules = runsModules;
    /** The core's memory; set once the core has been instantiated. */
    this.memory = null;
    this.modules = new Map();
    this.instances = new Map();
    this.last = 0;
    this.failure = new Uint8Array(0);
    /**
     * The author module calls this function to report progress: the number of finished steps, the
     * total number of steps, and a text that describes the step that begins.
     */
    this.onProgress = null;
  }

  /** The imports of the core; see `sdk/core/host/src/browser/imports.rs`. */
  imports() {
    return {
      now_ms: () => Date.now(),
      progress: (done, of, text, len) => this.onProgress?.(done, of, decode(this.bytes(text, len))),
      module_new: (at, len) => this.attempt(() => this.compile(this.bytes(at, len).slice())),
      module_free: (module) => void this.modules.delete(module),
      instance_new: (module, names, len) =>
        this.attempt(() => this.instantiate(module, decode(this.bytes(names, len)).split(","))),
      instance_free: (instance) => void this.instances.delete(instance),
      instance_memory: (instance) => this.instances.get(instance).memory.buffer.byteLength,
      instance_call: (instance, index, types, slots, len, returns, result) =>
        this.status(() => this.call(instance, index, types, slots, len, returns, result)),
      instance_read: (instance, at, to, len) =>
        this.status(() => {
          const { memory } = this.instances.get(instance);
          this.bytes(to, len).set(new Uint8Array(memory.buffer, at >>> 0, len >>> 0));
        }),
      instance_write: (instance, at, from, len) =>
        this.status(() => {
          const { memory } = this.instances.get(instance);
          new Uint8Array(memory.buffer, at >>> 0, len >>> 0).set(this.bytes(from, len));
        }),
      failure_text: (to, capacity) => {
        const text = this.failure.subarray(0, capacity >>> 0);
        this.bytes(to, text.length).set(text);
        return text.length;
      },
    };
  }

  bytes(at, len) {
    return new Uint8Array(this.memory.buffer, at >>> 0, len >>> 0);
  }

  compile(bytes) {
    if (!this.runsModules) throw new Error("this thread runs no modules of models");
    const module = new WebAssembly.Module(bytes);
    const [first] = WebAssembly.Module.imports(module);
    if (first) throw new Error(`the module imports \`${first.module}.${first.name}\`; a model may import nothing`);
    return this.keep(this.modules, module);
  }

  instantiate(module, names) {
    const { exports } = new WebAssembly.Instance(this.modules.get(module), {});
    if (!(exports.memory instanceof WebAssembly.Memory)) throw new Error("the module exports no `memory`; it is not an htex model");
    const functions = names.map((name) => {
      if (typeof exports[name] !== "function") {
        throw new Error(`the module exports no function \`${name}\`; it is not an htex model`);
      }
      return exports[name];
    });
    return this.keep(this.instances, { memory: exports.memory, functions });
  }

  call(instance, index, types, slots, len, returns, result) {
    const guest = this.instances.get(instance);
    const view = new DataView(this.memory.buffer);
    const values = [];
    for (let i = 0; i < len; i++) {
      const at = (slots >>> 0) + 8 * i;
      const type = view.getUint8((types >>> 0) + i);
      values.push(
        type === I32 ? view.getInt32(at, true) : type === I64 ? view.getBigInt64(at, true) : view.getFloat64(at, true),
      );
    }
    const returned = guest.functions[index](...values);
    // `view` is still valid: the guest cannot reach the core's memory, so the call cannot have
    // grown it.
    if (returns === I32) view.setBigUint64(result >>> 0, BigInt(returned >>> 0), true);
    else if (returns === I64) view.setBigInt64(result >>> 0, BigInt(returned), true);
    else if (returns === F64) view.setFloat64(result >>> 0, Number(returned), true);
  }

  keep(map, value) {
    this.last += 1;
    map.set(this.last, value);
    return this.last;
  }

  /** Returns a handle, or 0 and the text of the failure. */
  attempt(make) {
    try {
      return make();
    } catch (error) {
      this.failure = encode(String(error?.message ?? error));
      return 0;
    }
  }

  /** Returns 0, or 1 and the text of the failure. */
  status(run) {
    return this.attempt(() => (run(), -1)) === 0 ? 1 : 0;
  }
}

// The UTF-8 conversions are written here, because audio worklets have no functions for them.

export function encode(text) {
  const bytes = [];
  for (const character of text) {
    const code = character.codePointAt(0);
    if (code < 0x80) bytes.push(code);
    else if (code < 0x800) bytes.push(0xc0 | (code >> 6), 0x80 | (code & 63));
    else if (code < 0x10000) bytes.push(0xe0 | (code >> 12), 0x80 | ((code >> 6) & 63), 0x80 | (code & 63));
    else {
      bytes.push(0xf0 | (code >> 18), 0x80 | ((code >> 12) & 63), 0x80 | ((code >> 6) & 63), 0x80 | (code & 63));
    }
  }
  return Uint8Array.from(bytes);
}

/** Decodes valid UTF-8. */
export function decode(bytes) {
  let text = "";
  for (let i = 0; i < bytes.length; ) {
    const first = bytes[i++];
    const more = first < 0x80 ? 0 : first < 0xe0 ? 1 : first < 0xf0 ? 2 : 3;
    let code = more === 0 ? first : first & (0x3f >> more);
    for (let k = 0; k < more; k++) code = (code << 6) | (bytes[i++] & 0x3f);
    text += String.fromCodePoint(code);
  }
  return text;
}
