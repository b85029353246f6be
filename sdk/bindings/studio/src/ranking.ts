// Models of a texture in order: by what is felt of their errors, or by their shape where the level is not known.

import type { FeltError, FitReport } from "htex";

import { words } from "./parts/difference.tsx";

type Report = Pick<FitReport, "ranked"> & { readonly models: readonly Model[] };
type Model = Pick<FitReport["models"][number], "model" | "felt" | "at">;

/** Errors of the shape alone, dB RMS over nine bands: the levels are matched. */
function shapeError({ at }: Model) {
  const errors = at.map(({ quality }) => quality?.["band_error_matched_rms_db"] ?? quality?.["band_error_rms_db"]).filter((db) => typeof db === "number");
  return errors.length > 0 ? Math.max(...errors) : null;
}

function feltWords(felt: FeltError | null, isRecorded: boolean) {
  if (!felt) return "Not measured.";
  return words(felt) + (isRecorded && felt.within_repeatability ? " A second recording could differ as much." : "");
}

function shapeWords(db: number | null) {
  return db === null ? "Not measured." : `Its shape is ${db.toFixed(1)} dB from the recording's.`;
}

/** The ids of the models, the best first, and what is said of each. `isRecorded`: they were fitted to a touch, which another touch would differ from. */
export function rankedBy({ ranked, models }: Report, isLevelKnown: boolean, isRecorded = true) {
  const of = (id: string) => models.find(({ model }) => model === id);
  if (isLevelKnown) return { ranked, told: (id: string) => feltWords(of(id)?.felt ?? null, isRecorded) };
  const error = (id: string) => {
    const model = of(id);
    return model ? shapeError(model) : null;
  };
  const byShape = [...ranked].sort((a, b) => (error(a) ?? Infinity) - (error(b) ?? Infinity));
  return { ranked: byShape, told: (id: string) => shapeWords(error(id)) };
}
