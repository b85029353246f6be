// The voices of an audio worklet or of a worker: one core for all, and each texture opened once.

import { Core } from "./core.js";
import { Texture } from "./texture.js";

export class Stage {
  constructor() {
    this.core = null;
    this.textures = new Map();
  }

  /** Makes the voice of a description: `{ module, key, bytes, open, voice }`. */
  voice({ module, key, bytes, open, voice }) {
    this.core ??= Core.now(module);
    let texture = this.textures.get(key);
    if (!texture) {
      texture = new Texture(this.core, bytes, open);
      this.textures.set(key, texture);
    }
    return texture.voice(voice);
  }
}
