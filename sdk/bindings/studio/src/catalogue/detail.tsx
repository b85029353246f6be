// The page of a texture: its pad, what is known of it, how to name its author, and its file.

import { useEffect, useMemo, useState } from "preact/hooks";
import type { Library, Texture } from "htex";

import { near, recordedRange } from "../conditions.ts";
import { withModel, type Opened } from "../item.ts";
import { fineSpectrum } from "../look/spectrum-line.ts";
import { pilotForce, pilotSpeed, rest } from "../motion.ts";
import { Icon } from "../parts/icons.tsx";
import { Name } from "../parts/name.tsx";
import { Controls, Pad } from "../player/parts.tsx";
import { failure, startSound } from "../player/sound.ts";
import { SpectrumChart } from "./spectrum-chart.tsx";

/** What is opened at the moment, with its bytes. */
interface Shown extends Opened {
  readonly name: string;
  readonly bytes: Uint8Array<ArrayBuffer>;
}

const number = (x: number | null | undefined, digits: number) => (x === null || x === undefined || Number.isNaN(x) ? "unknown" : Number(x.toFixed(digits)).toString());

/** The sentence that names the author and the licence, as most licences demand. */
function attribution({ name, manifest: { author, license, doi } }: Texture, library: Library) {
  const { homepage, version } = library.metadata;
  const from = [library.name || "a library of textures", version].filter(Boolean).join(" ");
  const parts = [`"${name}"`, author && `by ${author}`, `from ${from}`, homepage && `(${homepage})`];
  return `${parts.filter(Boolean).join(" ")}. ${license ? `Licence: ${license}.` : "It states no licence."}${doi ? ` doi:${doi}` : ""}`;
}

function Attribution({ text }: { text: string }) {
  const [isCopied, setCopied] = useState(false);
  const copy = () => navigator.clipboard.writeText(text).then(() => setCopied(true), () => setCopied(false));
  return (
    <section aria-labelledby="attribution-title">
      <h2 id="attribution-title">Attribution</h2>
      <p class="attribution">
        <Name>{text}</Name>
      </p>
      <button class="button" onClick={copy}>
        <Icon name={isCopied ? "check" : "copy"} /> {isCopied ? "Copied" : "Copy"}
      </button>
    </section>
  );
}

function Conditions({ texture, model }: Opened) {
  const { representations, conditions } = texture.manifest;
  const all = representations.find((one) => one.model === model)?.at ?? [];
  const at = all.filter(({ condition }) => conditions[condition]?.segments !== 0);
  const rows = at.slice(0, 100);
  return (
    <section>
      <h2 id="conditions-title">Recorded conditions</h2>
      <div class="scrolls" tabIndex={0} role="region" aria-labelledby="conditions-title">
        <table class="table">
          <thead>
            <tr>
              <th scope="col">Speed, mm/s</th>
              <th scope="col">Force, N</th>
              <th scope="col">Level, {texture.unit} RMS</th>
            </tr>
          </thead>
          <tbody>
            {rows.map(({ condition, level_rms: level }) => {
              const { speed, force } = texture.conditions[condition] ?? { speed: null, force: null };
              return (
                <tr key={condition}>
                  <td>{number(speed, 1)}</td>
                  <td>{number(force, 3)}</td>
                  <td>{level.toPrecision(3)}</td>
                </tr>
              );
            })}
          </tbody>
        </table>
      </div>
      {at.length > rows.length && <p class="soft small">and {at.length - rows.length} more</p>}
    </section>
  );
}

function Facts({ texture, bytes }: Shown) {
  const { quantity, unit, models, manifest } = texture;
  const { tags = [], source, doi, sensor, finger, contact } = manifest;
  const rows: [string, string | undefined][] = [
    ["Quantity", `${quantity.replaceAll("_", " ")}, ${unit}`],
    ["Contact", contact],
    ["Finger or tool", finger],
    ["Sensor", sensor],
    ["Source", source],
    ["DOI", doi],
    ["Models", models.map((id) => id.split(".").at(-1)).join(", ")],
    ["Tags", tags.join(", ")],
    ["Size", `${bytes.length} bytes`],
  ];
  return (
    <section aria-labelledby="facts-title">
      <h2 id="facts-title">Facts</h2>
      <dl class="facts">
        {rows.map(
          ([name, value]) =>
            value && (
              <div key={name}>
                <dt>{name}</dt>
                <dd>
                  <Name>{value}</Name>
                </dd>
              </div>
            ),
        )}
      </dl>
    </section>
  );
}

function TexturePage({ library, shown }: { library: Library; shown: Shown }) {
  const { texture, model, name, bytes } = shown;
  const { author, license, description } = texture.manifest;
  const file = `${name.split("/").at(-1)}.htex`;
  const address = useMemo(() => URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" })), [bytes]);
  useEffect(() => () => URL.revokeObjectURL(address), [address]);
  const { at } = near(texture, model, { speed: pilotSpeed.value, force: pilotForce.value });
  return (
    <>
      <header>
        <h1>
          <Name>{texture.name}</Name>
        </h1>
        <p class="soft">
          {author && (
            <>
              By <Name>{author}</Name>.{" "}
            </>
          )}
          {license ? `Licence: ${license}.` : "It states no licence: only its author may pass it on."}
        </p>
        {description && (
          <p>
            <Name>{description}</Name>
          </p>
        )}
      </header>
      <Pad texture={texture} model={model} />
      <Controls texture={texture} model={model} />
      <p>
        <a class="button strong" href={address} download={file}>
          Save {file}
        </a>
      </p>
      <SpectrumChart magnitudes={fineSpectrum(texture, model, at)} unit={texture.unit} speed={at.speed} force={at.force} />
      <div class="columns">
        <Facts {...shown} />
        <Conditions {...shown} />
        <Attribution text={attribution(texture, library)} />
      </div>
    </>
  );
}

/** Begins with the motion of the default condition. */
function setSliders({ texture, model }: Opened) {
  const { at } = near(texture, model, { speed: pilotSpeed.peek(), force: pilotForce.peek() });
  const { speed, force } = recordedRange(texture, model);
  if (speed) pilotSpeed.value = at.speed;
  if (force) pilotForce.value = at.force;
}

export function Detail({ library, name }: { library: Library; name: string }) {
  const [shown, setShown] = useState<Shown | null>(null);
  const [problem, setProblem] = useState("");
  useEffect(() => {
    let isGone = false;
    setProblem("");
    const open = async () => {
      const bytes = (await library.bytes(name)) as Uint8Array<ArrayBuffer>;
      const own = withModel(await library.texture(name));
      if (isGone) return own.texture.free();
      setSliders(own);
      setShown({ ...own, name, bytes });
      // Without sound, the rest of the page still works.
      await startSound(own.texture, own.model).catch((error) => (failure.value = String(error.message ?? error)));
    };
    open().catch((error) => setProblem(String(error.message ?? error)));
    scrollTo(0, 0);
    return () => {
      isGone = true;
      rest();
    };
  }, [library, name]);
  return (
    <article class="player" aria-busy={!shown && !problem}>
      <p>
        <a class="button" href="#">
          All textures
        </a>
      </p>
      {problem && <p class="problem">{problem}</p>}
      {shown?.name === name && <TexturePage key={name} library={library} shown={shown} />}
    </article>
  );
}
