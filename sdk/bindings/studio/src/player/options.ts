// What the studio writes into a player page beside the texture.

export interface PlayerOptions {
  /** Id of the model that plays. */
  readonly model: string;
  /** Name of the texture's file. */
  readonly file: string;
  /** Address of the studio that made the page; null if others cannot open it. */
  readonly studio: string | null;
  /** Speed, mm/s, and force, N, that the sliders begin with. */
  readonly speed: number;
  readonly force: number;
}
