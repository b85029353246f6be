// Warnings and notes of what was made.

import type { Notice } from "htex";

import { Icon } from "./icons.tsx";
import { ToSettings } from "./to-settings.tsx";

/**
 * A warning looks like one, and notes do not. `isAdvised`: the settings that would help have fields
 * on the screen.
 */
export function Notices({ notices, kind, isAdvised = false }: { notices: readonly Notice[]; kind: string; isAdvised?: boolean }) {
  return notices.map(({ text, settings }) => (
    <li key={text} class={kind === "Warning" ? "finding warning" : "finding"}>
      {kind === "Warning" && <Icon name="warn" />}
      <b>{kind}:</b> {text}
      {isAdvised && <ToSettings names={settings} />}
    </li>
  ));
}
