// Whether a motion was recorded, and how it is played if not, in words.

import type { Coverage as Told } from "htex";

/** A change of the level or of the frequencies by less than this, in decibels or parts, is not worth a word. */
const LEAST_DB = 0.5;
const LEAST_PART = 0.02;

/** How a motion lies to what was recorded, in a word. */
function beyond({ kind, asked = 0, recorded = 0 }: Told["speed"], less: string, more: string) {
  return kind === "outside" ? `${asked < recorded ? less : more} than recorded` : "";
}

/** How a motion is played, in a sentence. */
export function coverageText({ kind, speed, force, frequencyFactor, levelFactor }: Told): string {
  if (kind === "silent") return "The finger rests, so nothing plays.";
  if (kind !== "outside") return "This speed and force are within the recorded range.";
  const ways = [beyond(speed, "slower", "faster"), beyond(force, "lighter", "harder")].filter(Boolean);
  const db = 20 * Math.log10(Math.max(levelFactor, 1e-6));
  const level = Math.abs(db) < LEAST_DB ? "" : `${Math.abs(db).toFixed(1)} dB ${db > 0 ? "stronger" : "weaker"}`;
  const pitch = Math.abs(frequencyFactor - 1) < LEAST_PART ? "" : `its frequencies ${frequencyFactor.toFixed(2)} times as high`;
  const how = [level, pitch].filter(Boolean).join(", ") || "as at the nearest recorded motion";
  const text = `${ways.join(" and ") || "outside the recorded range"}: it plays ${how}.`;
  return text.charAt(0).toUpperCase() + text.slice(1);
}
