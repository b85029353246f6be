// The module of imports and exports. It is loaded when it is first needed.

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
