"""Tables of coded assets (htex-coded-1.md section 1)."""

from __future__ import annotations

from .findings import Refused, escape

CODED = "org.htex.coded/1"
MOST_ROWS = 262144


def replace_tables(manifest: dict) -> None:
    """Replaces the tables of a coded manifest by the arrays for which they stand."""
    required = manifest.get("extensions_required")
    if not isinstance(required, list) or CODED not in required:
        return
    left = [MOST_ROWS]
    if isinstance(manifest.get("conditions"), dict):
        manifest["conditions"] = rows_of_table(manifest["conditions"], "/conditions", left)
    representations = manifest.get("representations")
    for index, representation in enumerate(representations if isinstance(representations, list) else []):
        if not isinstance(representation, dict) or not isinstance(representation.get("at"), dict):
            continue
        rows = rows_of_table(representation["at"], f"/representations/{index}/at", left)
        for i, row in enumerate(rows):
            row.setdefault("condition", float(i))
        representation["at"] = rows


def refuse(pointer: str, why: str):
    raise Refused("JSON_TYPE", pointer, why)


def rows_of_table(table: dict, pointer: str, left: list[int]) -> list[dict]:
    columns = columns_of(table, pointer)
    full = [values for key in in_order(columns) if (values := full_column(columns[key])) is not None]
    if not full:
        refuse(pointer, "no column has a value for each row")
    return rows_of(columns, len(full[0]), pointer, left)


def full_column(column) -> list | None:
    if isinstance(column, dict):
        column = None if "rows" in column else column.get("values")
    return column if isinstance(column, list) else None


def in_order(columns: dict) -> list[str]:
    return sorted(columns, key=lambda key: key.encode("utf-8", "surrogatepass"))


def columns_of(table: dict, pointer: str) -> dict:
    if not isinstance(table.get("columns"), dict):
        refuse(pointer, "no columns")
    return table["columns"]


def rows_of(columns: dict, count: int, pointer: str, left: list[int]) -> list[dict]:
    left[0] -= count
    if left[0] < 0:
        refuse(pointer, "too many rows")
    rows: list[dict] = [{} for _ in range(count)]
    for key in in_order(columns):
        here, column = f"{pointer}/columns/{escape(key)}", columns[key]
        places = list(range(count))
        if isinstance(column, list):
            values = column
        elif isinstance(column, dict):
            if "rows" in column:
                places = indices(column["rows"], count, here + "/rows")
            if "values" in column:
                values = divided_values(column, here)
            else:
                values = rows_of(columns_of(column, here), len(places), here, left)
        else:
            refuse(here, "neither an array nor an object")
        if len(values) != len(places):
            refuse(here, "another number of values than rows")
        for place, value in zip(places, values):
            rows[place][key] = value
    return rows


def divided_values(column: dict, pointer: str) -> list:
    values = column["values"]
    if not isinstance(values, list):
        refuse(pointer + "/values", "no array")
    if "per" not in column:
        return values
    per = column["per"]
    if not isinstance(per, float) or not 1 <= per <= 1e6:
        refuse(pointer + "/per", "no number from 1 to 1000000")

    def divided(value):
        if isinstance(value, list):
            return [divided(inner) for inner in value]
        if not isinstance(value, float):
            refuse(pointer + "/values", "neither a number nor an array of numbers")
        return float(value) / per

    return [divided(value) for value in values]


def indices(rows, count: int, pointer: str) -> list[int]:
    if not isinstance(rows, list) or not all(isinstance(row, float) and row >= 0 and row % 1 == 0 for row in rows):
        refuse(pointer, "no indices")
    if any(row >= count for row in rows) or any(a >= b for a, b in zip(rows, rows[1:])):
        refuse(pointer, "no ascending indices of rows")
    return [int(row) for row in rows]
