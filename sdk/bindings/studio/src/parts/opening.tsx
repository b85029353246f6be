// The bar that is shown while files are opened.

import { opening, stopOpening } from "../opening.ts";
import { Name } from "./name.tsx";

export function Opening() {
  const now = opening.value;
  if (!now) return null;
  const { text, done, of } = now;
  return (
    <div class="opening" role="group" aria-label="Opening files">
      <span class="opening-text">
        {(done + 1).toLocaleString("en")} of {of.toLocaleString("en")}: <Name>{text}</Name>
      </span>
      <progress max={of} value={done} aria-label="Files that are opened" />
      <button class="button" onClick={stopOpening}>
        Stop
      </button>
    </div>
  );
}
