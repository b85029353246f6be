"""Read tables as laboratories store them: CSV files, Excel workbooks, data frames.

CSV files may use ``,``, ``;`` or tabs, and decimal commas. All tables are converted to text, with
the position of each field.
"""

from __future__ import annotations

import csv
import io
import math
import os
import re
import zipfile
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from .rules import Findings

#: Largest file that is read, bytes.
LARGEST = 256 << 20
#: Texts that mark a missing value.
MISSING = {"", "na", "n/a", "nan", "null", "none", "missing", "-", "."}
_DECIMAL_COMMA = re.compile(r"[+-]?\d*,\d+([eE][+-]?\d+)?")


@dataclass
class Row:
    """A line of a table: its line number in the file, starting at 1, and its fields."""

    line: int
    fields: list[str]


@dataclass
class Sheet:
    """A table as text, with column names in lower case."""

    names: list[str]
    rows: list[Row]
    findings: Findings

    def column(self, name: str) -> int | None:
        """Return the index of a column, if it exists."""
        return self.names.index(name) if name in self.names else None

    def text(self, row: Row, name: str) -> str:
        """Return a name from a line. Add a finding if the name is empty."""
        column = self.names.index(name)
        text = row.fields[column]
        if not text:
            self.findings.at("TABLE_NAME_EMPTY", row.line, column, name, "it is empty; fill it in, or remove the line")
        return text


def read_sheet(table: Any, name: str, renamed: Mapping[str, str] | None = None, *, all_there: bool = True) -> Sheet:
    """Read a file or a data frame.

    ``renamed`` maps htex's column names to the column names in the table. All of these must exist,
    unless ``all_there`` is false.
    """
    findings = Findings(name)
    rows = [row for row in _rows(table, findings) if any(row.fields)]
    findings.check()
    if len(rows) < 2:
        findings.add("TABLE_EMPTY", "", "there is no line after the header")
        findings.check()
    header, *rows = rows
    sheet = Sheet(_names(header, renamed or {}, all_there, findings), rows, findings)
    for row in rows:
        if len(row.fields) != len(header.fields):
            message = f"line {row.line}: it has {len(row.fields)} fields, and the header has {len(header.fields)}"
            findings.add("TABLE_FIELDS", f"/{row.line}", message)
    findings.check()
    return sheet


def require(sheet: Sheet, needed: tuple[str, ...]) -> None:
    """Raise if a table lacks required columns."""
    for name in needed:
        if name not in sheet.names:
            found = ", ".join(sheet.names)[:200]
            message = f"line 1: there is no column `{name}`; needed are {', '.join(needed)}, and there are: {found}"
            sheet.findings.add("TABLE_COLUMN_MISSING", f"/1/{name}", message)
    sheet.findings.check()


def is_missing(text: str) -> bool:
    """Return whether the text of a field marks a missing value."""
    return text.lower() in MISSING


def number(text: str) -> float | None:
    """Parse a finite number with a decimal point or a decimal comma. Return None for any other
    text."""
    if _DECIMAL_COMMA.fullmatch(text):
        text = text.replace(",", ".")
    try:
        value = float(text) if "_" not in text else math.nan
    except ValueError:
        return None
    return value if math.isfinite(value) else None


def _names(header: Row, renamed: Mapping[str, str], all_there: bool, findings: Findings) -> list[str]:
    ours = {theirs.strip().lower(): own for own, theirs in renamed.items()}
    found = [name.lower() for name in header.fields]
    for theirs, own in ours.items():
        if all_there and theirs not in found:
            message = (
                f"line 1: there is no column `{theirs}`, which --map calls `{own}`; there are: {', '.join(found)[:200]}"
            )
            findings.add("TABLE_COLUMN_MISSING", f"/1/{theirs}", message)
    names = [ours.get(name, name) for name in found]
    for index, name in enumerate(names):
        earlier = names.index(name)
        if name and earlier < index:
            findings.at("TABLE_COLUMN_DUPLICATE", header.line, index, name, f"column {earlier + 1} also has this name")
    return names


def _rows(table: Any, findings: Findings) -> Iterator[Row]:
    if hasattr(table, "columns") and hasattr(table, "itertuples"):
        return _frame_rows(table)
    data = table if isinstance(table, bytes) else _file(os.fspath(table), findings)
    if data.startswith(b"PK\x03\x04"):
        return _workbook_rows(data, findings)
    return _csv_rows(data, findings)


def _file(path: str, findings: Findings) -> bytes:
    if (size := os.stat(path).st_size) > LARGEST:
        findings.add("TABLE_TOO_LARGE", "", f"it has {size} bytes, and {LARGEST} are the limit")
        findings.check()
    with open(path, "rb") as file:
        return file.read()


def _csv_rows(data: bytes, findings: Findings) -> Iterator[Row]:
    try:
        text = data.decode("utf-16" if data[:2] in (b"\xff\xfe", b"\xfe\xff") else "utf-8-sig")
    except UnicodeDecodeError as error:
        line = 1 + data[: error.start].count(b"\n")
        findings.add("TABLE_NOT_UTF8", f"/{line}", f"line {line}: a byte is not UTF-8")
        return
    reader = csv.reader(io.StringIO(text, newline=""), delimiter=_delimiter(text))
    start = 1
    try:
        for fields in reader:
            yield Row(start, [field.strip() for field in fields])
            start = reader.line_num + 1
    except csv.Error as error:
        findings.add("TABLE_FIELDS", f"/{start}", f"line {start}: {error}")


def _delimiter(text: str) -> str:
    """Return the delimiter of a CSV text: the one that occurs most often, outside quotation marks,
    in the first line that contains a delimiter.
    """
    header = next((line for line in text.splitlines() if line.strip()), "")
    plain = re.sub(r'"[^"]*"', "", header)
    return max(",;\t", key=plain.count)


def _workbook_rows(data: bytes, findings: Findings) -> Iterator[Row]:
    """Return the rows of the first sheet of a workbook."""
    from openpyxl import load_workbook

    try:
        with zipfile.ZipFile(io.BytesIO(data)) as parts:
            size = sum(part.file_size for part in parts.infolist())
        if size > LARGEST:
            findings.add("TABLE_TOO_LARGE", "", f"it unpacks to {size} bytes, and {LARGEST} are the limit")
            return
        first = load_workbook(io.BytesIO(data), read_only=True, data_only=True).worksheets[0]
        rows = [[_shown(value) for value in row] for row in first.iter_rows(values_only=True)]
    except Exception as error: # openpyxl raises any exception of its parsers.
        findings.add("TABLE_XLSX_INVALID", "", f"it is no workbook: {error}")
        return
    width = max((index + 1 for row in rows for index, field in enumerate(row) if field), default=0)
    for line, row in enumerate(rows, start=1):
        yield Row(line, (row + [""] * width)[:width])


def _frame_rows(frame: Any) -> Iterator[Row]:
    if any(name is not None for name in frame.index.names):
        frame = frame.reset_index()
    yield Row(1, [_shown(name) for name in frame.columns])
    for line, values in enumerate(frame.itertuples(index=False, name=None), start=2):
        yield Row(line, [_shown(value) for value in values])


def _shown(value: Any) -> str:
    """Return a value from a workbook or a data frame as text, as a table would show it. A missing
    value becomes an empty text.
    """
    if value is None or value != value or type(value).__name__ in ("NAType", "NaTType"):
        return ""
    if isinstance(value, float) and value.is_integer() and abs(value) < 1e15:
        return str(int(value))
    return str(value).strip()
