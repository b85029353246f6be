"""Tables of numbers in CSV (scene-1.md sections 3 and 4; recording-findings.md)."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable


class NotATable(ValueError):
    pass


def read_table(data: bytes, is_used: Callable[[str], bool] = lambda _: True) -> tuple[list[str], list[list[float]]]:
    """Names of the columns and the numbers of those that are used; lines that begin with `#` are comments."""
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise NotATable(str(error)) from None
    lines = [line for line in io.StringIO(text) if line.strip() and not line.startswith("#")]
    rows = list(csv.reader(lines))
    if len(rows) < 2:
        raise NotATable("no rows")
    names = [name.strip() for name in rows[0]]
    columns: list[list[float]] = [[] for _ in names]
    for row in rows[1:]:
        if len(row) != len(names):
            raise NotATable("a row with another number of columns")
        for name, column, cell in zip(names, columns, row):
            if not is_used(name):
                continue
            try:
                number = float(cell)
            except ValueError:
                raise NotATable(f"no number: {cell}") from None
            if not math.isfinite(number):
                raise NotATable("a number that is not finite")
            column.append(number)
    return names, columns
