/**
 * Types of the browser. Programs for Node.js are compiled without these types, so each becomes
 * `unknown` if it does not exist.
 */

type Instance<Name extends string> = typeof globalThis extends { [N in Name]: { prototype: infer T } } ? T : unknown;

export type AudioContextLike = Instance<"BaseAudioContext">;
export type AudioParamLike = Instance<"AudioParam">;
export type ElementLike = Instance<"Element">;
export type EventLike = Instance<"Event">;
export type WorkerLike = Instance<"Worker">;
export type SignalLike = Instance<"AbortSignal">;

/** The type of `AudioWorkletNode`. If it does not exist, a class that cannot be instantiated. */
export declare const NodeBase: typeof globalThis extends { AudioWorkletNode: infer T extends abstract new (...values: any) => any }
  ? T
  : abstract new () => object;

/** A function like `fetch`. */
export type Fetch = typeof globalThis extends { fetch: infer T } ? T : (url: any, options?: any) => Promise<any>;
