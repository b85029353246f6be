// Warnings and notes of what was made.

import type { Notice } from "htex";

export function Notices({ notices, kind }: { notices: readonly Notice[]; kind: string }) {
  return notices.map(({ text }) => (
    <li key={text} class="finding">
      <b>{kind}:</b> {text}
    </li>
  ));
}
