// Undo and redo, the two versions, and the button of the last steps. They are at the top, or below the pad if the window is narrow.

import { fail, redo, redoable, undo, undoable } from "../state.ts";
import { isTouch } from "../theme.ts";
import { Icon } from "./icons.tsx";
import { Slots } from "./slots.tsx";
import { StripButton } from "./strip.tsx";

function History() {
  const [undoKeys, redoKeys] = isTouch.value ? ["", ""] : [" (Ctrl Z)", " (Ctrl Shift Z)"];
  return (
    <div class="group">
      <button class="icon-button" disabled={!undoable.value} title={undoable.value ? `Undo: ${undoable.value}${undoKeys}` : "Nothing to undo"} aria-label="Undo" onClick={() => undo().catch(fail)}>
        <Icon name="undo" />
      </button>
      <button class="icon-button" disabled={!redoable.value} title={redoable.value ? `Redo: ${redoable.value}${redoKeys}` : "Nothing to redo"} aria-label="Redo" onClick={() => redo().catch(fail)}>
        <Icon name="redo" />
      </button>
    </div>
  );
}

export function Versions() {
  return (
    <div class="versions">
      <History />
      <Slots />
      <StripButton />
    </div>
  );
}
