// The QR code of the texture's link, with which a phone opens the texture.

import { useEffect, useState } from "preact/hooks";

import { complete, saveTexture } from "../giving.ts";
import { toLink } from "../link.ts";
import { withoutControls } from "../names.ts";
import { MOST_CHARACTERS, entered, isSecure, keepEntered, obstacle, pageForPhone, problem, readEntered } from "../phone.ts";
import type { Code } from "../qr.ts";
import { fileName, save } from "../save.ts";
import { fail, present, say } from "../state.ts";
import { Icon } from "./icons.tsx";
import { useSpoken } from "./spoken.tsx";
import { TextField } from "./text-field.tsx";

/** About how wide a code is on the page, and the least width of one of its modules, CSS pixels. Modules are whole pixels. */
const [WIDTH, MODULE] = [480, 3];
/** Milliseconds for which the texture rests before its code is made. A label changes with each key. */
const SETTLES_MS = 300;

interface Made {
  readonly link: string;
  readonly code: Code;
  readonly svg: string;
}

/** The code of a link, as soon as it is made. Until then, it is the one before. */
function useCode(link: string | null) {
  const [made, setMade] = useState<Made | null>(null);
  useEffect(() => {
    if (link === null) return setMade(null);
    const make = async () => {
      const { toCode, toSvg } = await import("../qr.ts");
      const code = toCode(link);
      setMade({ link, code, svg: toSvg(code) });
    };
    const timer = setTimeout(() => make().catch(fail), made ? SETTLES_MS : 0);
    return () => clearTimeout(timer);
  }, [link]);
  return made;
}

async function savePng(code: Code, name: string) {
  save(await (await import("../qr.ts")).toPng(code), fileName(`${name} code`, "png"), "image/png");
}

function CopyLink({ link }: { link: string }) {
  const copy = async () => {
    await navigator.clipboard.writeText(link);
    say("The link for the phone is copied.", "good");
  };
  return (
    <button class="button" onClick={() => copy().catch(fail)}>
      Copy the phone's link
    </button>
  );
}

/** The image. One of another texture is not seen while the new one is made. */
function Image({ made, isNow, name }: { made: Made; isNow: boolean; name: string }) {
  const size = made.code.length;
  const width = size * Math.max(Math.floor(WIDTH / size), MODULE);
  return <img class={isNow ? "qr" : "qr stale"} src={`data:image/svg+xml,${encodeURIComponent(made.svg)}`} width={width} height={width} alt={`QR code of the link to ${withoutControls(name)}`} />;
}

function Saves({ made: { code, svg }, isNow, name }: { made: Made; isNow: boolean; name: string }) {
  const saveSvg = () => save(new TextEncoder().encode(svg), fileName(`${name} code`, "svg"), "image/svg+xml");
  return (
    <>
      <button class="button" disabled={!isNow} onClick={() => savePng(code, name).catch(fail)}>
        Save as PNG
      </button>
      <button class="button" disabled={!isNow} onClick={saveSvg}>
        Save as SVG
      </button>
    </>
  );
}

function Problem({ text }: { text: string }) {
  useSpoken(text);
  return (
    <p class="problem">
      <Icon name="warn" /> {text}
    </p>
  );
}

function TooLarge({ link, bytes }: { link: string; bytes: number }) {
  const number = (count: number) => count.toLocaleString("en");
  const text = `This texture is too large for a QR code. It has ${number(bytes)} bytes, so its link has ${number(link.length)} characters, and a code holds at most ${number(MOST_CHARACTERS)}. Give the link or the file instead.`;
  return <Problem text={text} />;
}

/** Where the phone finds the studio, if it cannot open this page. */
function Address({ why }: { why: string }) {
  const [isSettled, settle] = useState(true);
  useEffect(() => void readEntered().catch(() => {}), []);
  const type = (text: string) => {
    entered.value = text;
    settle(false);
  };
  const end = () => {
    settle(true);
    // If it fails, the store's `refusal` says so.
    keepEntered().catch(() => {});
  };
  const wrong = problem.value ?? (isSecure.value ? null : "Browsers run the studio only at addresses that begin with https://. Over http, the phone shows an error.");
  return (
    <>
      <p class="finding warning">
        <Icon name="warn" />
        {why} Enter an address at which the phone can open the studio, for example https://example.org/studio/. This browser stores the address. The page cannot check it, because it sends no requests.
      </p>
      <TextField label="The studio's address for the phone" value={entered.value} onText={type} onSettled={end} />
      {isSettled && entered.value.trim() !== "" && wrong && <Problem text={wrong} />}
    </>
  );
}

export function Qr() {
  const [wanted, show] = useState(false);
  const [why, page, document] = [obstacle(), pageForPhone(), present.value];
  const link = wanted && page && document ? toLink(document.bytes, page) : null;
  const isTooLarge = link !== null && link.length > MOST_CHARACTERS;
  const made = useCode(isTooLarge ? null : link);
  const name = document?.name ?? "";
  const toggle = () => complete().then(() => show(!wanted));
  return (
    <div class="panel qr-panel">
      <div class="stack">
        <h2>QR code</h2>
        <p class="small soft">Scan the code with a phone to open this texture there. The code contains the whole texture, as the link does. This page sends nothing.</p>
        {why && <Address why={why} />}
        <div class="row">
          <button class="button" aria-expanded={link !== null} disabled={!page} onClick={() => toggle().catch(fail)}>
            {link ? "Hide the code" : "Show the code"}
          </button>
          {made && <Saves made={made} isNow={made.link === link} name={name} />}
          {link && <CopyLink link={link} />}
          {isTooLarge && (
            <button class="button" onClick={saveTexture}>
              Save the file
            </button>
          )}
        </div>
        {link && isTooLarge && <TooLarge link={link} bytes={document?.bytes.length ?? 0} />}
      </div>
      {made && <Image made={made} isNow={made.link === link} name={name} />}
    </div>
  );
}
