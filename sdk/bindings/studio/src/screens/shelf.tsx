// The shelf: textures to touch, and to begin with.

import { useEffect, useRef } from "preact/hooks";

import { endAudition, onLook } from "../audition.ts";
import { OPENED, take } from "../drop.ts";
import { Icon } from "../parts/icons.tsx";
import { Sparkline } from "../parts/sparkline.tsx";
import { chosenTag, forget, found, items, search, tags, type Item } from "../shelf.ts";
import { begin, fail, present, say, screen } from "../state.ts";

async function choose(item: Item) {
  await begin(item.bytes, `open ${item.name}`, item.model);
  say(`${item.name} is on the pad. Slide over it, or go on to Shape.`);
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
  const looks = onLook(() => ({ texture: item.texture, model: item.model, own: true }));
  return (
    <li>
      <button class={isHere ? "card here" : "card"} aria-pressed={isHere} {...looks} onClick={() => choose(item).catch(fail)} onDblClick={() => (screen.value = "shape")}>
        <Sparkline texture={item.texture} model={item.model} />
        <span class="card-name">{item.name}</span>

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

export function Shelf() {
  useEffect(() => endAudition, []);
  return (
    <section aria-labelledby="shelf-title">
      <header class="screen-head">
        <div>
          <h1 id="shelf-title">Shelf</h1>
          <p>Pass over a texture to hear it, once something was pressed; press it to put it on the pad. Drop your own files anywhere.</p>
        </div>
        <Files />
      </header>
      <div class="filters">
        <label class="search">
          <Icon name="search" />
          <input type="search" placeholder="Search" aria-label="Search textures" value={search.value} onInput={(event) => (search.value = event.currentTarget.value)} />
        </label>
        <div class="chips" role="group" aria-label="Tags">
          {tags.value.map((tag) => (
            <button key={tag} class="chip" aria-pressed={chosenTag.value === tag} onClick={() => (chosenTag.value = chosenTag.value === tag ? null : tag)}>
              {tag}
            </button>
          ))}
        </div>
      </div>
      <ul class="cards" onKeyDown={arrows}>
        {found.value.map((item) => (
          <Card key={item.id} item={item} />
        ))}
      </ul>
      {items.value.length > 0 && found.value.length === 0 && <p class="empty">No texture has these words. Try fewer.</p>}
    </section>
  );
}
