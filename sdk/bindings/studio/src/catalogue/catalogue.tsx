// A catalogue of a library. The page contains the player of the npm package, and reads the library by ranges. A small library is in the
// page itself, so that the page also works from a disk.

import { render } from "preact";
import { Library, setLibrary } from "htex";

import "../styles/base.css";
import "../styles/frame.css";
import "../styles/controls.css";
import "../styles/knobs.css";
import "../styles/lamp.css";
import "../styles/screens.css";
import "../styles/windows.css";
import "../player/player.css";
import "./catalogue.css";
import { rest } from "../motion.ts";
import { Name } from "../parts/name.tsx";
import { bytesOf, inflated, textOf } from "../player/parts.tsx";
import { Build } from "./build.tsx";
import { Cards } from "./cards.tsx";
import { Detail } from "./detail.tsx";
import type { CatalogueOptions } from "./options.ts";
import { BUILD, addressOf, licenses, readEntries, route } from "./state.ts";

/** A text that somebody wrote; a link if it is the address of a web page. */
function Linked({ text }: { text: string }) {
  const isAddress = /^https?:\/\//i.test(text) && URL.canParse(text);
  return isAddress ? (
    <a href={text} rel="noopener">
      <Name>{text}</Name>
    </a>
  ) : (
    <Name>{text}</Name>
  );
}

function About({ library, address }: { library: Library; address: string | null }) {
  const { version, description, authors = [], homepage, source, changelog, date } = library.metadata;
  const rows: [string, string | undefined][] = [
    ["Authors", authors.join(", ")],
    ["Homepage", homepage],
    ["Source", source],
    ["Changes", changelog],
    ["Licences", licenses.value.map(([name, count]) => `${name || "none stated"} ${count}`).join(", ")],
    ["BLAKE3", library.blake3],
  ];
  return (
    <header class="catalogue-head">
      <h1>
        <Name>{library.name || "Textures"}</Name>
      </h1>
      {(version || date) && (
        <p class="soft">
          {version && (
            <>
              Version <Name>{version}</Name>
            </>
          )}
          {date && ` of ${date}`}
        </p>
      )}
      {description && (
        <p class="description">
          <Name>{description}</Name>
        </p>
      )}
      <details>
        <summary>About this library</summary>
        <dl class="facts">
          {rows.map(
            ([name, text]) =>
              text && (
                <div key={name}>
                  <dt>{name}</dt>
                  <dd>
                    <Linked text={text} />
                  </dd>
                </div>
              ),
          )}
        </dl>
        {address && (
          <p>
            <a class="button" href={address} download="">
              Save the library
            </a>
          </p>
        )}
      </details>
    </header>
  );
}

function Tabs({ here }: { here: string }) {
  const tab = (address: string, name: string) => (
    <a class="button" href={addressOf(address)} aria-current={here === address ? "page" : undefined}>
      {name}
    </a>
  );
  return (
    <nav class="catalogue-tabs" aria-label="Pages">
      {tab("", "Textures")}
      {tab(BUILD, "Build")}
    </nav>
  );
}

function Catalogue({ library, address, options: { report } }: { library: Library; address: string | null; options: CatalogueOptions }) {
  const here = route.value;
  const isList = here === "" || (here === BUILD && report !== null);
  return (
    <main class="catalogue">
      {isList && <About library={library} address={address} />}
      {isList && report && <Tabs here={here} />}
      {here === "" && <Cards library={library} />}
      {here === BUILD && report && <Build report={report} />}
      {!isList && <Detail library={library} name={here} />}
    </main>
  );
}

async function start() {
  setLibrary(await inflated(bytesOf("library")));
  const options = JSON.parse(textOf("options")) as CatalogueOptions;
  const own = bytesOf("textures");
  const isFile = location.protocol === "file:";
  if (own.length === 0 && isFile) {
    throw new Error("A browser reads no library from a disk that is not in the page itself. Serve this folder by a web server that answers requests for ranges, and open its address.");
  }
  const address = new URL(options.library, location.href);
  const library = await Library.open(own.length > 0 ? own : address);
  const place = document.getElementById("app");
  if (place) render(<Catalogue library={library} address={isFile ? null : address.href} options={options} />, place);
  addEventListener("keydown", (event) => event.key === "Escape" && rest());
  document.addEventListener("visibilitychange", () => document.visibilityState === "hidden" && rest());
  await readEntries(library);
  document.documentElement.dataset["ready"] = "yes";
}

start().catch((error) => {
  const problem = Object.assign(document.createElement("p"), { className: "problem", textContent: String(error.message ?? error) });
  problem.setAttribute("role", "alert");
  document.getElementById("app")?.prepend(problem);
});
