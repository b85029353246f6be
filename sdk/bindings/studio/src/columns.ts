// The map of a recording's columns: which signal each is, and the factor to the signal's unit. It is a text, as the command takes it
// (`--map`), of which a table shows what it can.

import type { Columns, RecordedQuantity } from "htex";

export interface Entry {
  readonly role: string;
  /** A column or an expression, as it stands in the map. */
  readonly values: string;
  /** Factor to the role's unit; null where the column's name states its unit. */
  readonly scale: number | null;
}

type Column = Columns["columns"][number];

/** Entries of a map; what is not one is left out. */
export function entriesOf(map: string): Entry[] {
  const parts = map.match(/(?:"[^"]*"|'[^']*'|[^,"'])+/g) ?? [];
  return parts.flatMap((part) => {
    const [, role, values, scale] = /^\s*(\w+)\s*=\s*(.*?)\s*(?::\s*([-+]?[\d.]+(?:e[-+]?\d+)?))?\s*$/i.exec(part) ?? [];
    return role && values ? [{ role, values, scale: scale === undefined ? null : Number(scale) }] : [];
  });
}

export const textOf = (entries: readonly Entry[]) => entries.map(({ role, values, scale }) => `${role}=${values}${scale === null ? "" : `:${scale}`}`).join(",");

/** Whether an entry is of this column alone. */
export function isOf({ values }: Entry, { name }: Column, index: number) {
  return values === `#${index + 1}` || values.replace(/^(["'])(.*)\1$/, "$2").toLowerCase() === name.toLowerCase();
}

/** A column in a map: by its name, which another recording shares, or by its number if the name is not clear. */
function reference({ columns }: Columns, index: number) {
  const name = columns[index]?.name ?? "";
  const isClear = !/["#]/.test(name) && columns.filter((other) => other.name.toLowerCase() === name.toLowerCase()).length === 1;
  return isClear ? `"${name}"` : `#${index + 1}`;
}

/** The entries in force: the map's, or those that the reader found. */
function inForce(map: string, columns: Columns): Entry[] {
  if (map) return entriesOf(map);
  return columns.columns.flatMap(({ role, scale }, i) => (role ? [{ role, values: reference(columns, i), scale: scale === 1 ? null : scale }] : []));
}

/** The map with another role or factor of a column. A role goes from the column that had it. */
export function withColumn(map: string, columns: Columns, index: number, { role, scale }: { role: string; scale: number | null }) {
  const column = columns.columns[index];
  const others = inForce(map, columns).filter((entry) => entry.role !== role && !(column && isOf(entry, column, index)));
  return textOf(role ? [...others, { role, values: reference(columns, index), scale }] : others);
}

/** Roles of the signal, and of what else is recorded. */
const SIGNALS: Readonly<Record<RecordedQuantity, readonly string[]>> = {
  lateral_force: ["lateral", "lateral_x", "lateral_y"],
  normal_force: [],
  acceleration: ["signal", "signal_x", "signal_y", "signal_z"],
  velocity: ["signal", "signal_x", "signal_y", "signal_z"],
  displacement: ["signal", "signal_x", "signal_y", "signal_z"],
};

export const rolesOf = (quantity: RecordedQuantity) => [...SIGNALS[quantity], "normal", "time", "x", "y", "speed"];

/** What roles are called on the page. */
export const ROLE_NAMES: Readonly<Record<string, string>> = {
  lateral: "lateral force",
  lateral_x: "lateral force, x",
  lateral_y: "lateral force, y",
  signal: "signal",
  signal_x: "signal, x",
  signal_y: "signal, y",
  signal_z: "signal, z",
  normal: "normal force",
  time: "time",
  x: "position, x",
  y: "position, y",
  speed: "speed",
};

/** Units of quantities, as they are written. */
export const QUANTITIES: readonly { id: RecordedQuantity; name: string; unit: string }[] = [
  { id: "lateral_force", name: "Lateral force", unit: "N" },
  { id: "normal_force", name: "Normal force", unit: "N" },
  { id: "acceleration", name: "Acceleration", unit: "m/s²" },
  { id: "velocity", name: "Velocity", unit: "m/s" },
  { id: "displacement", name: "Displacement", unit: "m" },
];

export const unitOf = (quantity: RecordedQuantity) => QUANTITIES.find(({ id }) => id === quantity)?.unit ?? "";

/** The unit that a role's numbers have once they are multiplied by the factor. */
export function roleUnit(role: string, quantity: RecordedQuantity) {
  if (role.startsWith("signal")) return unitOf(quantity);
  return { time: "s", x: "mm", y: "mm", speed: "mm/s" }[role] ?? "N";
}

/** Units that a column may have, with their factors to the unit that is read. */
export const UNITS: Readonly<Record<string, Readonly<Record<string, number>>>> = {
  N: { N: 1, mN: 1e-3, "µN": 1e-6, kN: 1e3 },
  "m/s²": { "m/s²": 1, "cm/s²": 1e-2, "mm/s²": 1e-3, g: 9.80665 },
  "m/s": { "m/s": 1, "cm/s": 1e-2, "mm/s": 1e-3, "µm/s": 1e-6 },
  m: { m: 1, cm: 1e-2, mm: 1e-3, "µm": 1e-6, nm: 1e-9 },
  "mm/s": { "mm/s": 1, "cm/s": 10, "m/s": 1e3 },
  mm: { mm: 1, cm: 10, m: 1e3, "µm": 1e-3 },
  s: { s: 1, ms: 1e-3, "µs": 1e-6 },
};
