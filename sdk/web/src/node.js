// A texture as a node of the Web Audio API.

import { compiled } from "./library.js";
import { GuardedWorker, describe } from "./guarded.js";
import { HtexError } from "./core.js";

/** RMS of full scale that a node plays at by default: -20 dB. */
const LEVEL = 0.1;

/** The gain at which a texture plays at that level. */
function usualGain(texture, model) {
  const level = texture.level({ model });
  return level > 0 ? LEVEL / level : 0;
}

/** Loads the worklet; once for each context. */
const loaded = new WeakMap();

/** Prepares a context for nodes; must have returned before `new HtexNode`. */
export function prepare(context) {
  let promise = loaded.get(context);
  if (!promise) {
    promise = Promise.all([context.audioWorklet.addModule(new URL("./processor.js", import.meta.url)), compiled()]);
    loaded.set(context, promise);
  }
  return promise.then(() => undefined);
}

const Base = globalThis.AudioWorkletNode ?? class {
  constructor() {
    throw new HtexError("there is no Web Audio API here; render with `texture.voice()`", "unsupported");
  }
};

/** Plays a texture: parameters `speed` (mm/s), `force` (N) and `gain`. Models that are modules play in a worker, which is
 * ended when a call takes too long; the node then falls silent and has an `error` event. */
export class HtexNode extends Base {
  constructor(context, texture, options = {}) {
    const { trusted = !texture.hasModules, worker } = options;
    const description = describe(texture, options, context.sampleRate);
    super(context, "htex", {
      numberOfInputs: 0,
      numberOfOutputs: 1,
      outputChannelCount: [1],
      processorOptions: trusted ? { voice: description } : {},
      parameterData: { speed: 0, force: 0, gain: options.gain ?? usualGain(texture, options.model) },
    });
    this.missed = 0;
    this.port.onmessage = ({ data }) => this.receive(data);
    /** Resolves when the voice is made. */
    this.ready = Promise.resolve();
    if (!trusted) {
      this.worker = worker ?? new GuardedWorker(options);
      this.ownWorker = !worker;
      const { port1, port2 } = new MessageChannel();
      this.port.postMessage({ samples: port1 }, [port1]);
      this.ready = this.worker.play(description, port2, (error) => this.failed(error)).then(() => undefined);
      this.ready.catch(() => {});
    }
  }

  get speed() {
    return this.parameters.get("speed");
  }

  get force() {
    return this.parameters.get("force");
  }

  get gain() {
    return this.parameters.get("gain");
  }

  /** Position along the path, mm, for models that follow it. */
  set position(position) {
    this.port.postMessage({ position });
  }

  receive({ error, missed }) {
    if (missed) this.missed += missed;
    if (error) this.failed(new HtexError(error.message, error.code));
  }

  failed(error) {
    this.error = error;
    this.dispatchEvent(Object.assign(new Event("error"), { error }));
  }

  /** Ends the voice; the node cannot be used again. */
  stop() {
    this.port.postMessage({ stop: true });
    this.disconnect();
    if (this.ownWorker) this.worker.end();
  }
}
