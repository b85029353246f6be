// Save: name the texture, then save it as a file, keep it on the shelf, or share it.

import { computed } from "@preact/signals";

import { theAuthor, author } from "../author.ts";
import { complete, copyLink, isUnsaved, keepOnShelf, labelOf, link, saveBlock, savePlayer, saveSound, saveTexture, SOUND_S, takeFocus, write, type Label } from "../giving.ts";
import { Appearance } from "../parts/appearance.tsx";
import { Exports } from "../parts/exports.tsx";
import { documents } from "../history.ts";
import { Icon } from "../parts/icons.tsx";
import { Qr } from "../parts/qr.tsx";
import { TextField } from "../parts/text-field.tsx";
import { fileName } from "../save.ts";
import { fail, history, origin, present, say, settle } from "../state.ts";
import { webPage } from "../web-snippet.ts";

const LICENCES = ["CC0-1.0", "CC-BY-4.0", "CC-BY-SA-4.0", "CC-BY-NC-4.0", "MIT"];

/** The name of the texture that was opened. */
const openedName = computed(() => documents(history.value).find(({ id }) => id === origin.value?.id)?.name);

/** Completes the label, and then does something with the texture. */
const after = (then: () => unknown) => () => complete().then(then).catch(fail);

/** What is typed is written at once, so it is there on the other screens, and after a reload. */
function LabelForm() {
  const { name, license, author: by, tags, description } = labelOf();
  const field = (part: keyof Label) => ({ onText: (text: string) => write({ [part]: text }).catch(fail), onSettled: settle });
  return (
    <div class="panel stack save-label">
      <TextField label="Name" isRequired value={name} {...field("name")} />
      <TextField label="Licence" list="licences" value={license} {...field("license")} />
      <datalist id="licences">
        {LICENCES.map((one) => (
          <option key={one} value={one} />
        ))}
      </datalist>
      <TextField label="Tags, with commas" value={tags} {...field("tags")} />
      <TextField label="Description" rows={2} value={description} {...field("description")} />
      <TextField label="Author" value={by} {...field("author")} />
      <Appearance />
    </div>
  );
}

function Report() {
  const bytes = present.value?.bytes;
  const made = author.value;
  if (!bytes || !made) return null;
  const { valid, findings } = made.validate(bytes);
  return (
    <p class="small soft">
      {valid ? "The file passes validation" : "The file does not pass validation"}
      {findings.length > 0 ? `: ${findings.map(({ message }) => message).join("; ")}` : "."}
    </p>
  );
}

function Actions() {
  return (
    <div class="save-actions">
      <button class="button strong" ref={takeFocus} onClick={after(saveTexture)}>
        <Icon name="give" />
        <span>
          Save <small>.htex</small>
        </span>
      </button>
      <button class="button" onClick={after(keepOnShelf)}>
        Keep on the shelf
      </button>
      <p class="small soft">
        Only this browser has the shelf. A file works in every program that plays htex.
        {isUnsaved.value && present.value?.name === openedName.value && " The texture that you opened has the same name; another name tells them apart."}
      </p>
    </div>
  );
}

/** One way to share: what it is, and the button. */
function Way({ name, onChoose, children }: { name: string; onChoose: () => void; children: preact.ComponentChildren }) {
  return (
    <li>
      <button class="button" onClick={onChoose}>
        {name}
      </button>
      <p class="small soft">{children}</p>
    </li>
  );
}

function Share() {
  const isFile = location.protocol === "file:";
  const kB = Math.ceil(link().length / 100) / 10;
  return (
    <div class="panel stack save-share">
      <h2>Share</h2>
      <ul class="ways">
        <Way name="Copy the link" onChoose={after(copyLink)}>
          The link contains the whole texture after <code>#t=</code> ({kB} kB). Browsers do not send this part to a server.
          {isFile && " You opened this page from a file, so the link works only on this computer. To share links, put the studio's folder on a web server."}
        </Way>
        <Way name="Save a player page" onChoose={after(savePlayer)}>
          One file with a pad that plays this texture in any browser, without a network.
        </Way>
        <Way name="Save as WAV" onChoose={after(saveSound)}>
          {SOUND_S} s of sound at the speed and force of the sliders.
        </Way>
        <Way name="Save a microcontroller block" onChoose={after(saveBlock)}>
          A C header for the player on microcontrollers, at one recorded condition. For several conditions, use <code>htex bake</code>.
        </Way>
      </ul>
    </div>
  );
}

async function copy(text: string, what: string) {
  await navigator.clipboard.writeText(text);
  say(`${what} is copied.`, "good");
}

function InPage() {
  const text = webPage(fileName(present.value?.name ?? "texture", "htex"));
  return (
    <details class="panel">
      <summary>
        <h2>In your own web page</h2>
      </summary>
      <div class="stack">
        <pre class="snippet" tabIndex={0} aria-label="Web page">
          {text}
        </pre>
        <div class="row">
          <button class="button" onClick={() => copy(text, "The web page").catch(fail)}>
            Copy
          </button>
          <span class="small soft">The page Languages of the documentation shows how to play it in Rust, C, C#, Python and Node.js.</span>
        </div>
      </div>
    </details>
  );
}

export function Give() {
  if (!author.value) theAuthor().catch(fail);
  return (
    <section aria-labelledby="give-title">
      <header class="screen-head">
        <div>
          <h1 id="give-title">Save</h1>
          <p>The file has {present.value?.bytes.length} bytes. It plays for any length of time, at any speed and force.</p>
        </div>
      </header>
      <div class="save">
        <LabelForm />
        <Actions />
        <Share />
        <Qr />
        <Exports first={complete} />
        <InPage />
        <Report />
      </div>
    </section>
  );
}
