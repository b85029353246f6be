// The scripts of the screens other than the shelf, which the page shows first.

/** They load once the shelf has been drawn, so that it is drawn sooner. */
export const SCRIPTS = {
  shape: () => import("./shape.tsx").then(({ Shape }) => ({ default: Shape })),
  mix: () => import("./mix.tsx").then(({ Mix }) => ({ default: Mix })),
  vary: () => import("./vary.tsx").then(({ Vary }) => ({ default: Vary })),
  compare: () => import("./compare.tsx").then(({ Compare }) => ({ default: Compare })),
  give: () => import("./give.tsx").then(({ Give }) => ({ default: Give })),
  record: () => import("./record.tsx").then(({ Record }) => ({ default: Record })),
};

/**
 * Loads the scripts, so that each screen is there when it is opened. The screen of recordings loads when it is opened: what draws
 * its curves is as large as all others together.
 */
export async function loadScreens() {
  const { record: _, ...others } = SCRIPTS;
  await Promise.all(Object.values(others).map((load) => load()));
}
