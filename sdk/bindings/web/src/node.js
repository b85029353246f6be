// A texture as a node of the Web Audio API.

import { HtexError } from "./core.js";
import { GuardedWorker, checkTexture, describe } from "./guarded.js";
import { compiled, files, libraryBytes, resolved } from "./library.js";
import { Loops, checkLoop } from "./loop.js";
import { VOICE, checked } from "./options.js";
import { Texture } from "./texture.js";

/** Default RMS at which a node plays, as a fraction of full scale: -20 dB. */
const LEVEL = 0.1;
/**
 * Milliseconds between two checks whether a stopped node is silent. It is silent if its context no
 * longer renders, or if the context has rendered for this many seconds (the second constant)
 * without a reported end.
 */
const LOOK_MS = 200;
const SILENT_S = 1;

const { rate: _, gain, ...VOICE_OF_NODE } = VOICE;
const LOAD = { ...VOICE_OF_NODE, gain, trusted: "boolean" };
const NODE = { ...LOAD, worker: "object", limit: "number", pitch: "number" };

const LOOP = { gain: "number" };

/** Whether a node plays a loop instead of a texture. */
function isLoop(given) {
  return given?.samples !== undefined && !(given instanceof Texture);
}

/**
 * Returns the gain at which a texture or a loop plays at the default level. It uses the level that
 * the file states, because no model runs here.
 */
export function usualGain(texture, model) {
  if (isLoop(texture)) return texture.level_rms > 0 ? LEVEL / texture.level_rms : 0;
  const chosen = texture.chosenModel(model);
  const { at } = texture.manifest.representations.find((representation) => representation.model === chosen);
  const condition = texture.defaultCondition(chosen);
  const level = at.find((one) => one.condition === condition)?.level_rms ?? 0;
  return level > 0 ? LEVEL / level : 0;
}

/** For each context, the promise that loads the worklet, and how often loading failed. */
const loading = new WeakMap();
const failures = new WeakMap();
const prepared = new WeakSet();

/** Prepares a context for nodes. Await it before `new HtexNode`. */
export async function prepare(context) {
  checkContext(context, "prepare");
  if (!loading.has(context)) loading.set(context, load(context));
  try {
    await loading.get(context);
    prepared.add(context);
  } catch (error) {
    loading.delete(context);
    throw error;
  }
}

async function load(context) {
  const url = new URL(resolved(files.processor ?? new URL("./processor.js", import.meta.url)).href);
  const failed = failures.get(context) ?? 0;
  // A context remembers an address that failed, so a retry needs another address.
  if (failed > 0 && url.protocol !== "data:") url.searchParams.set("retry", failed);
  const added = context.audioWorklet.addModule(url).catch((error) => {
    failures.set(context, failed + 1);
    throw new HtexError(`the worklet ${url} cannot be loaded (${error.message}); check that it is there, and call prepare again`, "io");
  });
  await Promise.all([added, compiled()]);
}

function checkContext(context, call) {
  if (typeof globalThis.BaseAudioContext === "undefined") throw absent();
  if (!(context instanceof BaseAudioContext)) throw new HtexError(`${call} takes an AudioContext, such as new AudioContext()`, "invalid-argument");
  if (context.audioWorklet) return;
  const where = globalThis.isSecureContext === false ? `this page came from ${globalThis.location?.origin}` : "this browser has none";
  throw new HtexError(`audio worklets need https or localhost; ${where}: serve the page by https, or open it from http://localhost`, "unsupported");
}

function absent() {
  return new HtexError("there is no Web Audio API here; render with `texture.voice()`", "unsupported");
}

function checkNode(context, texture, options) {
  if (options.rate !== undefined) throw new HtexError("new HtexNode: the rate comes from the context; leave `rate` out", "invalid-argument");
  checked(options, NODE, "HtexNode");
  checkContext(context, "new HtexNode");
  if (!prepared.has(context)) throw new HtexError("new HtexNode: call `await prepare(context)` first, once for each context", "invalid-argument");
  checkTexture(texture, "new HtexNode");
}

/** Returns what is needed to make a node's voice. Without a motion it begins at rest. */
function describeFor(context, texture, { gain, trusted, worker, limit, pitch = 1, ...voice }) {
  return describe(texture, { ...voice, rate: context.sampleRate / pitch }, !voice.motion);
}

const Base = globalThis.AudioWorkletNode ?? class {
  constructor() {
    throw absent();
  }
};

/**
 * An audio node that plays a texture. Its parameters are `speed` (mm/s), `force` (N) and `gain`.
 * Models in WASM modules play in a worker. If a call takes too long, the worker is terminated, the
 * node falls silent, and it fires an `error` event.
 */
export class HtexNode extends Base {
  constructor(context, texture, options = {}) {
    checkNode(context, texture, options);
    const { trusted = texture.options.trusted || !texture.hasModules, worker, limit } = options;
    const gain = options.gain ?? usualGain(texture, options.model);
    const voice = { id: 0, description: describeFor(context, texture, options), gain };
    const shape = (load) => ({
      numberOfInputs: 0,
      numberOfOutputs: 1,
      outputChannelCount: [1],
      processorOptions: { gain, load },
      parameterData: { speed: 0, force: 0, gain },
    });
    let isSent = trusted;
    try {
      super(context, "htex", shape(trusted ? voice : null));
    } catch (error) {
      // Browsers that cannot pass a compiled library to a worklet get its bytes below.
      if (error.name !== "DataCloneError") throw error;
      super(context, "htex", shape(null));
      isSent = false;
    }
    Object.assign(this, { missed: 0, onerror: null, onenvelope: null, limit, sharedWorker: worker, loads: new Map(), lastLoad: 0, loops: new Loops() });
    /**
     * The options that a later `load` keeps, the gain for the texture's default level, and the
     * voice in a worker.
     */
    Object.assign(this, { bands: options.bands, pitch: options.pitch, usual: usualGain(texture, options.model), playing: null, texture });
    this.port.onmessage = ({ data }) => this.receive(data);
    this.onprocessorerror = (event) => this.workletFailed(event);
    /** Resolves when the voice has been made. */
    this.ready = isSent ? Promise.resolve() : this.send(voice, { trusted });
    /** The voice that was sent last, and the voice that was sent together with the library. */
    Object.assign(this, { sent: voice, withLibrary: isSent ? voice.id : this.withLibrary });
    this.ready.catch(() => {});
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

  /**
   * Place on the surface, mm, as `{ x, y }`; null if unknown. Only models that map a surface use
   * it.
   */
  set place(place) {
    this.port.postMessage({ place: place ? [place.x, place.y] : [NaN, NaN] });
  }

  /** Edges of the bands of the envelopes, Hz. */
  get envelopeEdges() {
    const [low, high] = this.texture.band;
    return this.bands > 0 ? Float64Array.from({ length: this.bands + 1 }, (_, k) => low * (high / low) ** (k / this.bands)) : new Float64Array(0);
  }

  /**
   * Fades to another texture, or to a loop. If several calls are made at the same time, only the
   * last one takes effect. The ratio of the gain to the default gain is kept.
   */
  async load(texture, options = {}) {
    if (isLoop(texture)) {
      checked(options, LOOP, "node.load of a loop");
      checkLoop(texture, "node.load");
    } else {
      checked(options, LOAD, "node.load");
      checkTexture(texture, "node.load");
    }
    if (this.isStopped) throw new HtexError("node.load: the node was stopped; make a new one", "invalid-argument");
    // Throws if there is no such representation.
    this.wanted = { texture, options, usual: usualGain(texture, options.model) };
    this.changing ??= this.change().finally(() => (this.changing = null));
    return this.changing;
  }

  /** Loads the requested texture, and then any texture requested in the meantime. */
  async change() {
    while (this.wanted) {
      const { texture, options, usual } = this.wanted;
      this.wanted = null;
      const before = this.gain.value;
      const gain = options.gain ?? (this.usual > 0 ? (usual * before) / this.usual : usual);
      await (isLoop(texture) ? this.changeToLoop(texture, gain) : this.changeTo(texture, options, gain));
      this.usual = usual;
      // Until now the old texture played with the old gain. If the gain was changed in the
      // meantime, the new value is kept.
      if (this.gain.value === before) this.gain.value = gain;
    }
  }

  async changeTo(texture, options, gain) {
    const bands = options.bands ?? this.bands;
    const { trusted = texture.options.trusted || !texture.hasModules } = options;
    const description = describeFor(this.context, texture, { ...options, bands, pitch: this.pitch });
    await this.send({ id: this.nextId(), description, gain }, { trusted });
    Object.assign(this, { texture, bands });
  }

  async changeToLoop(loop, gain) {
    const described = this.loops.describe(loop, { contextRate: this.context.sampleRate, pitch: this.pitch });
    const id = this.nextId();
    await this.begun(id, () => this.port.postMessage({ load: { id, loop: described, gain } }));
    this.playing?.forget();
    this.playing = null;
  }

  nextId() {
    this.lastLoad += 1;
    return this.lastLoad;
  }

  /** Makes a voice and fades to it. The promise resolves when the fade starts. */
  async send(voice, { trusted }) {
    const { id, description, gain } = voice;
    let playing = null;
    await this.begun(id, () => {
      if (trusted) return void this.post(voice);
      const { port1, port2 } = new MessageChannel();
      this.port.postMessage({ load: { id, samples: port1, gain } }, [port1]);
      playing = this.guarded().play(description, port2, (error) => this.workerFailed(id, error));
      playing.ready.catch(() => {});
    });
    this.playing?.forget();
    this.playing = playing;
  }

  /** Posts a load message. The promise resolves when the fade starts. */
  async begun(id, post) {
    const started = new Promise((resolve, reject) => this.loads.set(id, { resolve, reject }));
    post();
    try {
      await started;
    } finally {
      this.loads.delete(id);
    }
  }

  /**
   * Posts a voice to the worklet, with the library's bytes if the compiled library cannot be sent.
   * A worklet that has played a voice already has the library.
   */
  post(voice) {
    this.sent = voice;
    if (this.hasLibrary) {
      const { library, ...description } = voice.description;
      return void this.port.postMessage({ load: { ...voice, description } });
    }
    this.withLibrary = voice.id;
    try {
      this.port.postMessage({ load: voice });
    } catch (error) {
      if (error.name !== "DataCloneError") throw error;
      this.postWithBytes(voice);
    }
  }

  postWithBytes(voice) {
    const send = (library) => this.port.postMessage({ load: { ...voice, description: { ...voice.description, library } } });
    libraryBytes().then(send).catch((error) => this.receive({ id: voice.id, error }));
  }

  /** Returns this node's own worker, or the worker that it shares with other nodes. */
  guarded() {
    if (this.worker && !this.worker.ended) return this.worker;
    this.worker = this.sharedWorker ?? new GuardedWorker({ limit: this.limit });
    return this.worker;
  }

  receive({ id, started, unusable, error, missed, envelope, ended }) {
    if (missed) this.missed += missed;
    if (envelope) this.onenvelope?.(envelope);
    if (started) this.started(id);
    if (unusable) this.postWithBytes(this.sent);
    if (ended) this.end();
    if (!error) return;
    const failure = new HtexError(error.message, error.code ?? "internal");
    const load = this.loads.get(id);
    if (load) load.reject(failure);
    // If a load fails, its promise reports it, and the previous texture plays on.
    if (!load || id === 0) this.failed(failure);
  }

  started(id) {
    this.hasLibrary ||= id === this.withLibrary;
    this.loads.get(id)?.resolve();
  }

  workerFailed(id, error) {
    this.loads.get(id)?.reject(error);
    if (id > 0 && this.loads.has(id)) return;
    this.port.postMessage({ alone: true });
    this.failed(error);
  }

  /**
   * Handles an error of the worklet. Chromium's event for it also has the type `error`, like the
   * events of this node.
   */
  workletFailed(event) {
    if (event.error instanceof HtexError) return;
    event.stopImmediatePropagation();
    this.failed(new HtexError(`the audio worklet failed: ${event.message ?? "it stopped"}`, "internal"));
  }

  failed(error) {
    if (this.isStopped) return;
    this.error = error;
    const event = Object.assign(new Event("error"), { error });
    this.onerror?.(event);
    this.dispatchEvent(event);
  }

  /** Fades out and ends the voice. The node cannot be used again. */
  stop() {
    if (this.isStopped) return;
    this.isStopped = true;
    const isHeard = this.context.state === "running" || this.isOffline;
    this.port.postMessage({ stop: true, isHeard });
    if (!isHeard) this.end();
    else if (!this.isOffline) this.endWhenSilent(this.context.currentTime + SILENT_S);
  }

  /**
   * Ends the node if the worklet does not report that it has faded out. If the audio thread is
   * late, this waits, so that the fade is not cut off.
   */
  endWhenSilent(until) {
    const { state, currentTime } = this.context;
    if (state !== "running" || currentTime > until) this.end();
    else if (!this.isEnded) setTimeout(() => this.endWhenSilent(until), LOOK_MS);
  }

  /** Whether the context is offline. An offline context runs only while it renders. */
  get isOffline() {
    return typeof OfflineAudioContext !== "undefined" && this.context instanceof OfflineAudioContext;
  }

  end() {
    if (this.isEnded) return;
    this.isEnded = true;
    this.disconnect();
    this.playing?.forget();
    if (!this.sharedWorker) this.worker?.end();
  }
}

if (Symbol.dispose) {
  HtexNode.prototype[Symbol.dispose] = function () {
    this.stop();
  };
}
