// Whether the level of a texture is one of the thing that was recorded. Where it is not, nothing can be said of what is felt.

import type { Metadata, Texture } from "htex";

const TAG = "level-unknown";

/** What a texture says of itself whose recording's full scale is not known. */
export const LEVEL_UNKNOWN: Metadata = {
  tags: [TAG],
  description: "The full scale of the recording is not known, so the level of this texture is not the level of what was recorded.",
};

export const isLevelKnown = ({ manifest }: Texture) => !manifest.tags?.includes(TAG);
