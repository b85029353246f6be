// Messages between the tabs of this page: what they have stored anew.

type Told = "work" | "own";

/** A browser may refuse the channel, for example to a page from disk. Tabs then look when they are shown. */
function open() {
  try {
    return new BroadcastChannel("htex-studio");
  } catch {
    return null;
  }
}

const channel = open();

/** Tells the other tabs that something was stored. */
export function tell(what: Told) {
  channel?.postMessage(what);
}

/** Runs when another tab has stored something, and when this tab is shown again. */
export function onTold(what: Told, run: () => void) {
  channel?.addEventListener("message", ({ data }) => data === what && run());
  document.addEventListener("visibilitychange", () => document.visibilityState === "visible" && run());
  // A page that the browser kept in memory has missed what was told.
  addEventListener("pageshow", ({ persisted }) => persisted && run());
}
