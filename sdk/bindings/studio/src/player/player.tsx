// A player of one texture, in one file: the library and the texture are in the page, compressed and as base64.

import { render } from "preact";
import { useMemo } from "preact/hooks";
import { open, setLibrary, type Texture } from "htex";

import "../styles/base.css";
import "../styles/frame.css";
import "../styles/controls.css";
import "../styles/knobs.css";
import "../styles/lamp.css";
import "../styles/windows.css";
import "./player.css";
import { slideGhost } from "../ghost.ts";
import { toLink } from "../link.ts";
import { finger, pilotForce, pilotSpeed, rest } from "../motion.ts";
import { Name } from "../parts/name.tsx";
import type { PlayerOptions } from "./options.ts";
import { Controls, Pad, bytesOf, inflated, textOf } from "./parts.tsx";
import { failure, isAwake, startSound } from "./sound.ts";

function About({ texture: { name, manifest } }: { texture: Texture }) {
  const { author, license, description } = manifest;
  return (
    <header>
      <h1>
        <Name>{name}</Name>
      </h1>
      {(author || license) && (
        <p class="soft">
          {author && (
            <>
              By <Name>{author}</Name>.{" "}
            </>
          )}
          {license && <>Licence: {license}.</>}
        </p>
      )}
      {description && (
        <p>
          <Name>{description}</Name>
        </p>
      )}
    </header>
  );
}

function Player({ texture, bytes, options: { model, file, studio } }: { texture: Texture; bytes: Uint8Array<ArrayBuffer>; options: PlayerOptions }) {
  const address = useMemo(() => URL.createObjectURL(new Blob([bytes], { type: "application/octet-stream" })), [bytes]);
  return (
    <main class="player">
      <About texture={texture} />
      <Pad texture={texture} model={model} />
      <Controls texture={texture} model={model} />
      <footer>
        <a class="button" href={address} download={file}>
          Save the texture
        </a>
        {studio && (
          <a class="button" href={toLink(bytes, studio)} target="_blank" rel="noopener">
            Open in the studio
          </a>
        )}
      </footer>
    </main>
  );
}

async function start() {
  setLibrary(await inflated(bytesOf("library")));
  const bytes = bytesOf("texture");
  const texture = await open(bytes);
  const options = JSON.parse(textOf("options")) as PlayerOptions;
  [pilotSpeed.value, pilotForce.value] = [options.speed, options.force];
  const place = document.getElementById("app");
  if (place) render(<Player texture={texture} bytes={bytes} options={options} />, place);
  addEventListener("keydown", (event) => event.key === "Escape" && rest());
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && rest());
  slideGhost(() => isAwake.peek() || finger.peek().force > 0);
  await startSound(texture, options.model);
  document.documentElement.dataset["ready"] = "yes";
}

start().catch((error) => {
  failure.value = String(error.message ?? error);
  document.getElementById("app")?.append(failure.value);
});
