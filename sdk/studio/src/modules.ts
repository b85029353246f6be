// Where the WASM modules are, and the scripts of workers: beside the page, or in it.

import { setAuthorLibrary, setLibrary } from "htex";
import { authorWorker, guardedWorker } from "virtual:workers";

import authorAddress from "../.htex/htex-author.wasm?url";
import libraryAddress from "../.htex/htex.wasm?url";

export { libraryAddress };

export function setModules() {
  const absolute = (address: string) => new URL(address, location.href).href;
  setLibrary(absolute(libraryAddress), guardedWorker ? { worker: guardedWorker } : {});
  const script = authorWorker;
  setAuthorLibrary(absolute(authorAddress), script ? { worker: () => new Worker(script, { type: "module" }) } : {});
}
