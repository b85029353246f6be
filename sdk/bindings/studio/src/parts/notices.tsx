// Warnings and notes of what was made.

import type { Notice } from "htex";

import { ToSettings } from "./to-settings.tsx";

/** `isAdvised`: the settings that would help have fields on the screen. */
export function Notices({ notices, kind, isAdvised = false }: { notices: readonly Notice[]; kind: string; isAdvised?: boolean }) {
  return notices.map(({ text, settings }) => (
    <li key={text} class="finding">
      <b>{kind}:</b> {text}
      {isAdvised && <ToSettings names={settings} />}
    </li>
  ));
}
