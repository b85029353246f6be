// The shelf: textures to touch, and to begin with.

import { batch, signal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";

import { endAudition, onLook } from "../audition.ts";
import { OPENED, take } from "../drop.ts";
import { isolated } from "../names.ts";
import { Icon } from "../parts/icons.tsx";
import { Name } from "../parts/name.tsx";
import { NoPicture, Picture } from "../parts/picture.tsx";
import { chosenTag, forget, found, items, search, tags, type Item } from "../shelf.ts";
import { begin, fail, present, say, screen } from "../state.ts";
import { isTouch } from "../theme.ts";

async function choose(item: Item) {
  const name = isolated(item.name);
  await begin(item.bytes, `open ${name}`);
  say(`${name} is on the pad. Slide over it, or change it in Shape.`);
}

/** Arrow keys go through the cards. */
function arrows(event: KeyboardEvent) {
  const grid = event.currentTarget as HTMLElement;
  const cards = [...grid.querySelectorAll<HTMLElement>(".card")];
  const at = cards.indexOf(document.activeElement as HTMLElement);
  if (at < 0) return;
  const top = cards[0]?.offsetTop;
  const columns = Math.max(cards.findIndex((card) => card.offsetTop !== top), 1);
  const step = { ArrowLeft: -1, ArrowRight: 1, ArrowUp: -columns, ArrowDown: columns }[event.key];
  if (step === undefined) return;
  event.preventDefault();
  cards[Math.min(Math.max(at + step, 0), cards.length - 1)]?.focus();
}

function Card({ item }: { item: Item }) {
  const isHere = present.value?.bytes === item.bytes;
  const opened = item.opened.value;
  const looks = onLook(() => item.open().then((now) => ({ ...now, own: true }), () => null));
  useEffect(item.see, [item]);
  return (
    <li>
      <button class={isHere ? "card here" : "card"} aria-pressed={isHere} {...looks} onClick={() => choose(item).catch(fail)} onDblClick={() => (screen.value = "shape")}>
        {opened ? <Picture {...opened} /> : <NoPicture />}
        <span class="card-name">
          <Name>{item.name}</Name>
        </span>
        {!item.isKept.value && <span class="card-lost">Not stored: save it as a file</span>}
        <span class="card-tags">{isHere ? "● on the pad" : item.tags.slice(0, 3).join(" · ")}</span>
      </button>
      {item.isOwn && (
        <button class="card-forget" aria-label={`Forget ${item.name}`} onClick={() => (endAudition(), forget(item).catch(fail))}>
          <Icon name="close" />
        </button>
      )}
    </li>
  );
}

function Files() {
  const input = useRef<HTMLInputElement>(null);
  const chosen = () => take([...(input.current?.files ?? [])]).catch(fail);
  return (
    <>
      <input ref={input} type="file" multiple hidden accept={OPENED} onChange={chosen} />
      <button class="button" onClick={() => input.current?.click()}>
        <Icon name="folder" /> Open files
      </button>
    </>
  );
}

/** Cards that are there at once, which are more than the studio brings along, and cards that are added where the end comes near. */
const [FIRST, MORE] = [48, 16];
const shown = signal(FIRST);
/** How near, in CSS pixels. */
const NEAR_PX = 800;

/** Another search begins with its first cards. */
function narrow(change: () => void) {
  batch(() => {
    shown.value = FIRST;
    change();
  });
}

function Cards() {
  const end = useRef<HTMLLIElement>(null);
  const [all, count] = [found.value, shown.value];
  const isMore = all.length > count;
  useEffect(() => {
    const element = end.current;
    if (!element) return;
    const more = (seen: IntersectionObserverEntry[]) => seen.some(({ isIntersecting }) => isIntersecting) && (shown.value = count + MORE);
    const observer = new IntersectionObserver(more, { root: element.closest(".screen"), rootMargin: `${NEAR_PX}px` });
    observer.observe(element);
    return () => observer.disconnect();
  }, [count, isMore]);
  return (
    <ul class="cards" onKeyDown={arrows}>
      {all.slice(0, count).map((item) => (
        <Card key={item.id} item={item} />
      ))}
      {isMore && <li key="end" ref={end} class="cards-end" aria-hidden="true" />}
    </ul>
  );
}

/** Most tags that are offered; a search finds the others. */
const MOST_TAGS = 24;

function Tags() {
  const chosen = chosenTag.value;
  const offered = tags.value.filter((tag, i) => i < MOST_TAGS || tag === chosen);
  return (
    <div class="chips" role="group" aria-label="Tags">
      {offered.map((tag) => (
        <button key={tag} class="chip" aria-pressed={chosen === tag} onClick={() => narrow(() => (chosenTag.value = chosen === tag ? null : tag))}>
          {tag}
        </button>
      ))}
    </div>
  );
}

export function Shelf() {
  const leave = () => {
    endAudition();
    shown.value = FIRST;
  };
  useEffect(() => leave, []);
  return (
    <section aria-labelledby="shelf-title">
      <header class="screen-head">
        <div>
          <h1 id="shelf-title">Shelf</h1>
          <p>
            {isTouch.value
              ? "Tap a texture to hear it and to load it onto the pad."
              : "Hover over a texture to hear it. Click to load it onto the pad. Drop your own files anywhere on the page."}
          </p>
        </div>
        <Files />
      </header>
      <div class="filters">
        <label class="search">
          <Icon name="search" />
          <input type="search" placeholder="Search" aria-label="Search textures" value={search.value} onInput={(event) => narrow(() => (search.value = event.currentTarget.value))} />
        </label>
        <Tags />
      </div>
      <Cards />
      {items.value.length > 0 && found.value.length === 0 && <p class="empty">No texture matches. Try fewer words.</p>}
    </section>
  );
}
