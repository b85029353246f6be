// The list of textures: its filters and cards.

import { batch, signal } from "@preact/signals";
import { useEffect, useRef, useState } from "preact/hooks";
import type { Library, LibraryEntry } from "htex";

import { withModel, type Opened } from "../item.ts";
import { Icon } from "../parts/icons.tsx";
import { Name } from "../parts/name.tsx";
import { NoPicture, Picture } from "../parts/picture.tsx";
import { whenFree } from "../slices.ts";
import { ALL, type Filters } from "./filters.ts";
import { addressOf, entries, filters, found, isWhole, knowsFelt, knowsHeldOut, licenses, quantities, tags } from "./state.ts";

/** Cards that are there at once, and cards that are added where the end comes near. */
const [FIRST, MORE] = [48, 24];
const shown = signal(FIRST);
/** How near, in CSS pixels. */
const NEAR_PX = 800;

/** Another search begins with its first cards. */
function narrow(change: Partial<Filters>) {
  batch(() => {
    shown.value = FIRST;
    filters.value = { ...filters.peek(), ...change };
  });
}

function Card({ library, entry }: { library: Library; entry: LibraryEntry }) {
  const [texture, setTexture] = useState<Opened | null>(null);
  useEffect(() => {
    let isGone = false;
    let own: Opened | null = null;
    const open = async () => {
      own = withModel(await library.texture(entry.name));
      if (isGone) own.texture.free();
      else setTexture(own);
    };
    // What cannot be opened has no picture; its page says why.
    const forget = whenFree(() => open().catch(() => {}));
    return () => {
      isGone = true;
      forget();
      own?.texture.free();
    };
  }, [entry]);
  const { license, held_out_error_db: heldOut, felt_error_rms_db: felt } = entry;
  const facts = [license, heldOut !== undefined && `held-out error ${heldOut.toFixed(1)} dB`, felt !== undefined && `felt error ${felt.toFixed(1)} dB`].filter(Boolean).join(" · ");
  return (
    <li>
      <a class="card" href={addressOf(entry.name)}>
        {texture ? <Picture {...texture} /> : <NoPicture />}
        <span class="card-name">
          <Name>{entry.name}</Name>
        </span>
        <span class="card-tags">{entry.tags.slice(0, 3).join(" · ")}</span>
        <span class="card-facts">{facts}</span>
      </a>
    </li>
  );
}

/** Most tags that are offered; a search finds the others. */
const MOST_TAGS = 24;

function Tags() {
  const chosen = filters.value.tag;
  const offered = tags.value.filter(([tag], i) => i < MOST_TAGS || tag === chosen);
  if (offered.length === 0) return null;
  return (
    <div class="chips" role="group" aria-label="Tags">
      {offered.map(([tag]) => (
        <button key={tag} class="chip" aria-pressed={chosen === tag} onClick={() => narrow({ tag: chosen === tag ? null : tag })}>
          {tag}
        </button>
      ))}
    </div>
  );
}

function Choice({ label, value, options, onValue }: { label: string; value: string | null; options: readonly (readonly [string, number])[]; onValue: (value: string | null) => void }) {
  if (options.length < 2) return null;
  return (
    <label class="field">
      {label}
      <select value={value === null ? "" : `=${value}`} onChange={({ currentTarget: { value: chosen } }) => onValue(chosen === "" ? null : chosen.slice(1))}>
        <option value="">All</option>
        {options.map(([name, count]) => (
          <option key={name} value={`=${name}`}>
            {name.replaceAll("_", " ") || "none stated"} ({count})
          </option>
        ))}
      </select>
    </label>
  );
}

function Most({ label, value, step, onValue }: { label: string; value: number | null; step: number; onValue: (value: number | null) => void }) {
  const set = ({ currentTarget }: { currentTarget: HTMLInputElement }) => onValue(Number.isFinite(currentTarget.valueAsNumber) ? currentTarget.valueAsNumber : null);
  return (
    <label class="field">
      {label}
      <input type="number" min={0} step={step} value={value ?? ""} onInput={set} />
    </label>
  );
}

function Filtering() {
  const now = filters.value;
  return (
    <search class="catalogue-filters" aria-label="Filters">
      <label class="search">
        <Icon name="search" />
        <input type="search" placeholder="Search names and tags" aria-label="Search textures" value={now.search} onInput={(event) => narrow({ search: event.currentTarget.value })} />
      </label>
      <Choice label="Licence" value={now.license} options={licenses.value} onValue={(license) => narrow({ license })} />
      <Choice label="Quantity" value={now.quantity} options={quantities.value} onValue={(quantity) => narrow({ quantity })} />
      <Most label="Recorded at, mm/s" value={now.speed} step={1} onValue={(speed) => narrow({ speed })} />
      {knowsHeldOut.value && <Most label="Held-out error at most, dB" value={now.heldOut} step={0.1} onValue={(heldOut) => narrow({ heldOut })} />}
      {knowsFelt.value && <Most label="Felt error at most, dB" value={now.felt} step={0.1} onValue={(felt) => narrow({ felt })} />}
      <Tags />
    </search>
  );
}

function Count() {
  const [all, here] = [entries.value.length, found.value.length];
  const narrowed = filters.value !== ALL && here !== all;
  return (
    <p class="soft" role="status">
      {narrowed ? `${here} of ${all} textures` : `${all} ${all === 1 ? "texture" : "textures"}`}
      {!isWhole.value && ", reading the list …"}
      {narrowed && (
        <button class="chip" onClick={() => narrow(ALL)}>
          Show all
        </button>
      )}
    </p>
  );
}

export function Cards({ library }: { library: Library }) {
  const end = useRef<HTMLLIElement>(null);
  const [all, count] = [found.value, shown.value];
  const isMore = all.length > count;
  useEffect(() => {
    const element = end.current;
    if (!element) return;
    const more = (seen: IntersectionObserverEntry[]) => seen.some(({ isIntersecting }) => isIntersecting) && (shown.value = count + MORE);
    const observer = new IntersectionObserver(more, { rootMargin: `${NEAR_PX}px` });
    observer.observe(element);
    return () => observer.disconnect();
  }, [count, isMore]);
  return (
    <>
      <Filtering />
      <Count />
      <ul class="cards">
        {all.slice(0, count).map((entry) => (
          <Card key={entry.name} library={library} entry={entry} />
        ))}
        {isMore && <li key="end" ref={end} class="cards-end" aria-hidden="true" />}
      </ul>
      {isWhole.value && all.length === 0 && <p class="empty">No texture matches. Try fewer words.</p>}
    </>
  );
}
