// The frame: what stands above, the screens with their tabs, and the pad, which is always there.

import { lazy, Suspense } from "preact/compat";
import { useEffect, useErrorBoundary, useRef } from "preact/hooks";

import { Dock } from "./parts/dock.tsx";
import { Icon, type IconName } from "./parts/icons.tsx";
import { Opening } from "./parts/opening.tsx";
import { Top } from "./parts/top.tsx";
import { Compare } from "./screens/compare.tsx";
import { Give } from "./screens/give.tsx";
import { Mix } from "./screens/mix.tsx";
import { Shape } from "./screens/shape.tsx";
import { Shelf } from "./screens/shelf.tsx";
import { Vary } from "./screens/vary.tsx";
import { fail, notice, screen, type Screen } from "./state.ts";

/** The screen of recordings comes when it is first shown: what draws its curves is a third of the page. */
const Record = lazy(() => import("./screens/record.tsx").then(({ Record: shown }) => ({ default: shown })));

const SCREENS: { id: Screen; name: string; icon: IconName; show: () => preact.JSX.Element }[] = [
  { id: "shelf", name: "Shelf", icon: "shelf", show: Shelf },
  { id: "shape", name: "Shape", icon: "shape", show: Shape },
  { id: "mix", name: "Mix", icon: "mix", show: Mix },
  { id: "vary", name: "Vary", icon: "vary", show: Vary },
  { id: "compare", name: "Compare", icon: "compare", show: Compare },
  { id: "record", name: "Record", icon: "record", show: Record },
  { id: "give", name: "Give", icon: "give", show: Give },
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
    <div class={`notice ${now?.kind ?? ""}`} role="status" aria-live="polite">
      {now && (
        <>
          {now.kind === "bad" && <Icon name="warn" />}
          {now.kind === "good" && <Icon name="check" />}
          <span class="name">{now.text}</span>
          {now.undo && (
            <button class="button" ref={undo} onClick={back}>
              Undo
            </button>
          )}
          <button class="icon-button" aria-label="Close this message" onClick={() => (notice.value = null)}>
            <Icon name="close" />
          </button>
        </>
      )}
    </div>
  );
}

/** A screen that fails says so, and the others stay. */
function Safely({ children }: { children: preact.ComponentChildren }) {
  const [error] = useErrorBoundary(fail);
  if (!error) return <>{children}</>;
  return (
    <section>
      <h1>This screen has failed</h1>
      <p class="empty">{String((error as Error).message ?? error)}. The texture is as it was; another screen, or undo, goes on.</p>
    </section>
  );
}

export function App() {
  const Shown = SCREENS.find(({ id }) => id === screen.value)?.show ?? Shelf;
  const place = useRef<HTMLElement>(null);
  const isFirst = useRef(true);
  useEffect(() => {
    place.current?.scrollTo(0, 0);
    // The keyboard goes on in the screen that was opened.
    if (!isFirst.current) place.current?.focus({ preventScroll: true });
    isFirst.current = false;
  }, [screen.value]);
  return (
    <div class="frame">
      <Top />
      <Tabs />
      <main class="screen" id="screen" tabIndex={-1} ref={place}>
        <Safely key={screen.value}>
          <Suspense fallback={<p class="empty">…</p>}>
            <Shown />
          </Suspense>
        </Safely>
      </main>
      <Dock />
      <Opening />
      <Notice />
    </div>
  );
}
