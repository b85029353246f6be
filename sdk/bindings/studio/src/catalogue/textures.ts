// Opens textures of the library.

import type { Library, Texture } from "htex";

/** An open texture, and the model that plays. */
export interface Opened {
  readonly texture: Texture;
  readonly model: string;
}

export async function opened(library: Library, name: string): Promise<Opened> {
  const texture = await library.texture(name);
  try {
    const voice = texture.voice();
    const { model } = voice;
    voice.free();
    return { texture, model };
  } catch (error) {
    texture.free();
    throw error;
  }
}
