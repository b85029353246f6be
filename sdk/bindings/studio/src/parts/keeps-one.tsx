// Says before an edit that only one of the texture's models will stay.

import { texture } from "../state.ts";

export function KeepsOne() {
  const count = texture.value?.models.length ?? 0;
  if (count < 2) return null;
  return (
    <p class="keeps-one soft small">
      This texture has {count} models. If you edit it or take a variation, only one model stays, because the others would describe the texture before the change. Undo brings them back.
    </p>
  );
}
