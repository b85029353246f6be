// Give: the texture leaves as a file, as sound, as a link, or in a page of its own.

import { useState } from "preact/hooks";

import { theAuthor, author } from "../author.ts";
import { complete, keepOnShelf, labelOf, link, saveBlock, savePlayer, saveSound, saveTexture, write, type Label } from "../giving.ts";
import { Icon } from "../parts/icons.tsx";
import { TextField } from "../parts/text-field.tsx";
import { pilotForce, pilotSpeed } from "../motion.ts";
import { fileName } from "../save.ts";
import { snippets } from "../snippets.ts";
import { fail, present, say, settle } from "../state.ts";

const LICENCES = ["CC0-1.0", "CC-BY-4.0", "CC-BY-SA-4.0", "CC-BY-NC-4.0", "MIT"];

/** What is typed is written at once, so it is there on the other screens, and after a reload. */
function LabelForm() {
  const { name, license, author: by, tags, description } = labelOf();
  const field = (part: keyof Label) => ({ onText: (text: string) => write({ [part]: text }).catch(fail), onSettled: settle });
  return (
    <div class="panel stack">
      <h2>Label</h2>
      <TextField label="Name" isRequired value={name} {...field("name")} />
      <TextField label="Licence" list="licences" value={license} {...field("license")} />
      <datalist id="licences">
        {LICENCES.map((one) => (
          <option key={one} value={one} />
        ))}
      </datalist>
      <TextField label="Author" value={by} {...field("author")} />
      <TextField label="Tags, with commas" value={tags} {...field("tags")} />
      <TextField label="Description" rows={2} value={description} {...field("description")} />
    </div>
  );
}

async function copy(text: string, what: string) {
  await navigator.clipboard.writeText(text);
  say(`${what} is copied.`, "good");
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

function Snippets() {
  const [language, choose] = useState("HTML");
  const all = snippets(fileName(present.value?.name ?? "texture", "htex"), pilotSpeed.value, pilotForce.value);
  const shown = all.find((one) => one.language === language) ?? all[0];
  return (
    <div class="panel stack">
      <h2>In your program</h2>
      <div class="segments" role="group" aria-label="Language">
        {all.map((one) => (
          <button key={one.language} aria-pressed={one.language === language} onClick={() => choose(one.language)}>
            {one.language}
          </button>
        ))}
      </div>
      <pre class="snippet" tabIndex={0} aria-label={`Program in ${language}`}>
        {shown?.text}
      </pre>
      <button class="button" onClick={() => copy(shown?.text ?? "", "The program").catch(fail)}>
        Copy
      </button>
    </div>
  );
}

function Link() {
  const address = link();
  const isFile = location.protocol === "file:";
  return (
    <div class="panel stack">
      <h2>Link</h2>
      <p class="small soft">
        The texture itself is in the part after <code>#t=</code>, {Math.ceil(address.length / 100) / 10} kB; no server sees it.
        {isFile && " This page is a file of yours: the link opens for whoever has the same file at the same place. Serve the folder for links to others."}
      </p>
      <button class="button" onClick={() => complete().then(() => copy(link(), "The link")).catch(fail)}>
        Copy the link
      </button>
    </div>
  );
}

export function Give() {
  if (!author.value) theAuthor().catch(fail);
  const after = (then: () => unknown) => () => complete().then(then).catch(fail);
  return (
    <section aria-labelledby="give-title">
      <header class="screen-head">
        <div>
          <h1 id="give-title">Give away</h1>
          <p>{present.value?.bytes.length} bytes: a file that plays for any length of time, at any speed and force.</p>
        </div>
        <button class="button strong" onClick={after(saveTexture)}>
          <Icon name="give" /> Save .htex
        </button>
      </header>
      <div class="columns">
        <LabelForm />
        <div class="stack">
          <div class="panel stack">
            <h2>Files</h2>
            <div class="row">
              <button class="button" onClick={after(keepOnShelf)}>Keep on my shelf</button>
              <button class="button" onClick={after(saveSound)}>Save as WAV</button>
              <button class="button" onClick={after(savePlayer)}>Save a player page</button>
              <button class="button" onClick={after(saveBlock)}>Save as C block</button>
            </div>
            <p class="small soft">
              The player page is one file that plays this texture, without a network. The C block is a header for the player on microcontrollers, at the default condition; <code>htex bake</code> makes blocks of several.
            </p>
            <Report />
          </div>
          <Link />
        </div>
      </div>
      <div class="below">
        <Snippets />
      </div>
    </section>
  );
}
