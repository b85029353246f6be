// The frame: what stands above, the screens with their tabs, and the pad, which is always there.

import { lazy, Suspense } from "preact/compat";
import { useEffect, useErrorBoundary, useRef } from "preact/hooks";

import { Details } from "./parts/details.tsx";
import { Dock, showPad } from "./parts/dock.tsx";
import { Icon, type IconName } from "./parts/icons.tsx";
import { Opening } from "./parts/opening.tsx";
import { Top } from "./parts/top.tsx";
import { SCRIPTS } from "./screens/scripts.ts";
import { Shelf } from "./screens/shelf.tsx";
import { spoken } from "./spoken.ts";
import { fail, notice, screen, type Screen } from "./state.ts";
import { troubleOf } from "./trouble.ts";

type Shown = () => preact.JSX.Element;

const SCREENS: { id: Screen; name: string; icon: IconName; show: Shown }[] = [
  { id: "shelf", name: "Shelf", icon: "shelf", show: Shelf },
  { id: "shape", name: "Shape", icon: "shape", show: lazy(SCRIPTS.shape) },
  { id: "mix", name: "Mix", icon: "mix", show: lazy(SCRIPTS.mix) },
  { id: "vary", name: "Vary", icon: "vary", show: lazy(SCRIPTS.vary) },
  { id: "compare", name: "Compare", icon: "compare", show: lazy(SCRIPTS.compare) },
  { id: "record", name: "Record", icon: "record", show: lazy(SCRIPTS.record) },
  { id: "give", name: "Save", icon: "give", show: lazy(SCRIPTS.give) },
];

function Tabs() {
  return (
    <nav class="tabs" aria-label="Screens">
      {SCREENS.map(({ id, name, icon }) => (
        <button key={id} class="tab" aria-current={screen.value === id ? "page" : undefined} onClick={() => (screen.value = id)}>
          <Icon name={icon} />
          <span>{name}</span>
        </button>
      ))}
    </nav>
  );
}

/** The message, in the page's only live region. Screen readers say only what is added to it. */
function Notice() {
  const now = notice.value;
  const undo = useRef<HTMLButtonElement>(null);
  useEffect(() => {
    // What was pressed may be gone, such as the button on a card: the keyboard goes on here.
    if (document.activeElement === document.body) undo.current?.focus({ preventScroll: true });
  }, [now]);
  const back = () => {
    document.getElementById("screen")?.focus({ preventScroll: true });
    Promise.resolve(now?.undo?.()).catch(fail);
  };
  return (
    <div class={`notice ${now?.kind ?? ""}`} role="status" aria-live="polite" aria-atomic="false">
      {now && (
        <>
          {now.kind === "bad" && <Icon name="warn" />}
          {now.kind === "good" && <Icon name="check" />}
          <span class="notice-text">{now.text}</span>
          {now.undo && (
            <button class="button" ref={undo} onClick={back}>
              Undo
            </button>
          )}
          {now.details && <Details key={now.details} text={now.details} />}
          <button class="icon-button" aria-label="Close this message" onClick={() => (notice.value = null)}>
            <Icon name="close" />
          </button>
        </>
      )}
      <span class="hidden">{spoken}</span>
    </div>
  );
}

/** A screen that fails says so, and the others stay. */
function Safely({ children }: { children: preact.ComponentChildren }) {
  const [error] = useErrorBoundary(fail);
  if (!error) return <>{children}</>;
  const { text, details } = troubleOf(error);
  return (
    <section>
      <h1>This screen stopped working</h1>
      <p class="empty">Your texture is unchanged. Open another screen, or undo the last step.</p>
      <Details text={details ?? text} />
    </section>
  );
}

/** Moves the keyboard past the top and the tabs. `onSkip` shows the place, if it is hidden. */
function Skip({ to, name, onSkip }: { to: string; name: string; onSkip?: () => void }) {
  const skip = async (event: Event) => {
    // The address stays, because it may contain a texture.
    event.preventDefault();
    onSkip?.();
    // What was hidden can have the focus once it is drawn.
    await Promise.resolve();
    document.querySelector<HTMLElement>(to)?.focus();
  };
  return (
    <a class="skip" href={to} onClick={skip}>
      {name}
    </a>
  );
}

export function App() {
  const Shown = SCREENS.find(({ id }) => id === screen.value)?.show ?? Shelf;
  const place = useRef<HTMLElement>(null);
  const isFirst = useRef(true);
  useEffect(() => {
    place.current?.scrollTo(0, 0);
    // The keyboard goes on in the screen that was opened.
    if (!isFirst.current && !place.current?.contains(document.activeElement)) place.current?.focus({ preventScroll: true });
    isFirst.current = false;
  }, [screen.value]);
  return (
    <div class="frame">
      <Skip to="#screen" name="Skip to the screen" />
      <Skip to="#pad" name="Skip to the pad" onSkip={showPad} />
      <Top />
      <Tabs />
      <main class="screen" id="screen" tabIndex={-1} ref={place}>
        <Safely key={screen.value}>
          <Suspense fallback={<p class="empty">…</p>}>
            <Shown />
          </Suspense>
        </Safely>
      </main>
      <Dock>
        <Opening />
        <Notice />
      </Dock>
    </div>
  );
}
