// The recordings that are looked at.

import { signal } from "@preact/signals";

export interface Recording {
  readonly name: string;
  readonly bytes: Uint8Array;
}

export const recordings = signal<readonly Recording[]>([]);
