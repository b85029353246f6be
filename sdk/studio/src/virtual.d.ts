declare module "virtual:workers" {
  /** Scripts as `data:` addresses, in the page of one file; undefined where they are files. */
  export const authorWorker: string | undefined;
  export const guardedWorker: string | undefined;
}

declare module "virtual:player" {
  /** Address of the page of a player, to be filled in. */
  const address: string;
  export default address;
}
