// The module of imports: loaded when a file of another haptic format is first opened.

import { loadImporter, type Importer } from "htex/import";

import { setImporter } from "./modules.ts";

let loading: Promise<Importer> | null = null;

export function theImporter(): Promise<Importer> {
  loading ??= setImporter()
    .then(loadImporter)
    .catch((error) => {
      loading = null;
      throw error;
    });
  return loading;
}
