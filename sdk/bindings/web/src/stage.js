// The voices of an audio worklet or of a worker. They all share one instance of the library. A
// texture is opened only once, however many of its voices play.

import { Core } from "./core.js";
import { Texture } from "./texture.js";

/**
 * Time after which a voice is silent once the finger is lifted, seconds: the ramp at contact plus a
 * margin.
 */
const RESTS_S = 0.025;

export class Stage {
  constructor() {
    this.core = null;
    this.textures = new Map();
  }

  /** Makes the voice for a description: `{ library, key, bytes, open, voice, rests }`. */
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

  /** Makes `free` of a voice also free the texture, if it is the texture's last voice. */
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

/** Lifts the finger of a new voice, and discards the samples until the voice is silent. */
function rest(voice, rate) {
  voice.setMotion(0, 0);
  voice.render(Math.ceil(RESTS_S * rate));
}
