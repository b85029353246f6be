// The voices of an audio worklet or of a worker: one core for all, and each texture opened once while a voice of it plays.

import { Core } from "./core.js";
import { Texture } from "./texture.js";

/** Seconds after which a voice rests whose finger is lifted: the ramp of the contact, and a little. */
const RESTS_S = 0.025;

export class Stage {
  constructor() {
    this.core = null;
    this.textures = new Map();
  }

  /** Makes the voice of a description: `{ library, key, bytes, open, voice, rests }`. */
  voice({ library, key, bytes, open, voice: options, rests }) {
    this.core ??= Core.now(library);
    const kept = this.textures.get(key) ?? { texture: new Texture(this.core, bytes, { ...open, trusted: true }), voices: 0 };
    this.textures.set(key, kept);
    kept.voices += 1;
    try {
      const voice = kept.texture.voice(options);
      if (rests) rest(voice, options.rate);
      return this.counted(voice, key, kept);
    } catch (error) {
      this.release(key, kept);
      throw error;
    }
  }

  /** The voice; its texture is freed with the last one of it. */
  counted(voice, key, kept) {
    const free = voice.free.bind(voice);
    voice.free = () => {
      if (!voice.isFreed) this.release(key, kept);
      free();
    };
    return voice;
  }

  release(key, kept) {
    kept.voices -= 1;
    if (kept.voices > 0) return;
    this.textures.delete(key);
    kept.texture.free();
  }
}

/** Lifts the finger of a new voice and lets the samples until it rests go by. */
function rest(voice, rate) {
  voice.setMotion(0, 0);
  voice.render(Math.ceil(RESTS_S * rate));
}
