declare module "virtual:workers" {
  /** Scripts as `data:` addresses, in the page of one file; undefined where they are files. */
  export const authorWorker: string | undefined;
  export const guardedWorker: string | undefined;
  export const readingWorker: string | undefined;
}

declare module "virtual:modules" {
  /** Addresses of the WASM modules; undefined in the page of one file, which has them in itself. */
  export const library: string | undefined;
  export const author: string | undefined;
  export const importer: string | undefined;
}

declare module "virtual:player" {
  /** Address of the page of a player, to be filled in. */
  const address: string;
  export default address;
}
