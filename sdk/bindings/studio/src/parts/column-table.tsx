// The columns of a recording: what each is, in which unit, and by which factor it is multiplied.

import type { Columns } from "htex";

import { entriesOf, isOf, ROLE_NAMES, roleUnit, rolesOf, UNITS, withColumn } from "../columns.ts";
import { state, stated } from "../recordings.ts";
import { Name } from "./name.tsx";

type Column = Columns["columns"][number];

function Row({ columns, column, index }: { columns: Columns; column: Column; index: number }) {
  const { map, quantity } = stated.value;
  const entry = entriesOf(map).find((one) => isOf(one, column, index));
  const role = entry?.role ?? column.role ?? "";
  const scale = entry ? entry.scale : column.role && column.scale !== 1 ? column.scale : null;
  const unit = roleUnit(role, quantity);
  const own = UNITS[unit] ?? {};
  const now = scale ?? (column.role ? column.scale : 1);
  const named = Object.keys(own).find((name) => Math.abs((own[name] ?? 0) / now - 1) < 1e-9);
  const say = (change: { role?: string; scale?: number | null }) => state({ map: withColumn(map, columns, index, { role, scale, ...change }) });
  return (
    <tr>
      <th scope="row">
        <Name>{column.name}</Name>
      </th>
      <td>
        <select aria-label={`Role of ${column.name}`} value={role} onChange={(event) => say({ role: event.currentTarget.value, scale: null })}>
          <option value="">not read</option>
          {rolesOf(quantity).map((id) => (
            <option key={id} value={id}>
              {ROLE_NAMES[id]}
            </option>
          ))}
        </select>
      </td>
      <td>
        {role && (
          <select aria-label={`Unit of ${column.name}`} value={named ?? ""} onChange={(event) => say({ scale: own[event.currentTarget.value] ?? 1 })}>
            {!named && <option value="">by the factor</option>}
            {Object.keys(own).map((name) => (
              <option key={name} value={name}>
                {name}
              </option>
            ))}
          </select>
        )}
      </td>
      <td>
        {role && (
          <label class="factor">
            <input
              type="number"
              step="any"
              aria-label={`Factor of ${column.name} to ${unit}`}
              value={now}
              onChange={(event) => Number.isFinite(event.currentTarget.valueAsNumber) && say({ scale: event.currentTarget.valueAsNumber })}
            />
            {unit}
          </label>
        )}
      </td>
      <td class="soft">{column.first.slice(0, 4).map((x) => Number(x.toPrecision(4))).join(", ")}</td>
    </tr>
  );
}

export function ColumnTable({ columns }: { columns: Columns }) {
  return (
    <div class="stack">
      <div class="scroll-x">
        <table class="table">
          <thead>
            <tr>
              <th scope="col">Column</th>
              <th scope="col">Is read as</th>
              <th scope="col">Its unit</th>
              <th scope="col">Factor</th>
              <th scope="col">First numbers</th>
            </tr>
          </thead>
          <tbody>
            {columns.columns.map((column, i) => (
              <Row key={i} columns={columns} column={column} index={i} />
            ))}
          </tbody>
        </table>
      </div>
      <label class="field">
        Column map, as a text
        <input type="text" data-setting="map" spellcheck={false} placeholder={columns.map} value={stated.value.map} onChange={(event) => state({ map: event.currentTarget.value.trim() })} />
      </label>
      <p class="small soft">One entry for each column that is read, with commas between them: lateral=COLUMN:FACTOR, or a product or sum of columns, such as lateral=friction*force.</p>
    </div>
  );
}
