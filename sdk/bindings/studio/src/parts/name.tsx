// A name that other people wrote: it wraps, and changes the direction of no text around it.

import { withoutControls } from "../names.ts";

export function Name({ children }: { children: string }) {
  return <bdi class="name">{withoutControls(children)}</bdi>;
}
