"""Read tables of spectra. The columns are participant, texture, model, and a magnitude at each of
20, 25, ..., 1000 Hz."""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Mapping
from typing import Any

import numpy as np

from .ratings import ONLY, Ratings
from .rules import Finding, Findings
from .tables import Row, Sheet, is_missing, number, read_sheet, require

#: The frequencies of spectra, hertz.
GRID_HZ = np.arange(20.0, 1001.0, 5.0)
#: Name that stands in the columns participant and model if a line has the spectrum of a real
#: texture.
RECORDED = "recorded"
_KEYS = ("participant", "texture", "model")
_LARGEST = 1e9


class Spectra:
    """The felt spectra of the rated conditions, and the recorded spectrum of each texture."""

    def __init__(self, recorded: np.ndarray, felt: np.ndarray, findings: list[Finding]) -> None:
        #: Recorded spectra, indexed by texture, then frequency bin.
        self.recorded = recorded
        #: Felt spectra, indexed by participant, texture, model, then frequency bin; NaN where a
        #: spectrum is missing.
        self.felt = felt
        self.findings = findings


def read_spectra(
    table: Any, ratings: Ratings, name: str = "spectra", *, renamed: Mapping[str, str] | None = None
) -> Spectra:
    """Read and check a table of spectra for the conditions of ``ratings``: a file, its bytes, or a
    data frame.

    If a condition has several lines, the table needs a column ``repetition``, and the magnitudes of
    these lines are averaged.
    """
    sheet = read_sheet(table, name, renamed, all_there=False)
    for factor in ("texture", "model"):
        if factor not in sheet.names and ratings.levels(factor) == [ONLY]:
            sheet.names.append(factor)
            for row in sheet.rows:
                is_recorded = factor == "model" and row.fields[sheet.names.index("participant")] == RECORDED
                row.fields.append(RECORDED if is_recorded else ONLY)
    require(sheet, _KEYS)
    grid = _grid_columns(sheet)
    sheet.findings.check()
    lines: dict[tuple[str, ...], dict[str, np.ndarray]] = defaultdict(dict)
    for row in sheet.rows:
        _read_row(sheet, row, grid, lines)
    sheet.findings.check()
    return _select(
        {cell: np.mean(list(each.values()), axis=0) for cell, each in lines.items()}, ratings, sheet.findings
    )


def _grid_columns(sheet: Sheet) -> list[int]:
    """Return the columns of the grid, in the grid's order."""
    found: dict[float, int] = {}
    for index, name in enumerate(sheet.names):
        if name in _KEYS or name == "repetition":
            continue
        frequency = number(name.removesuffix("hz").strip())
        if frequency is None or frequency < 0 or not frequency.is_integer():
            sheet.findings.at("SPECTRA_GRID_INVALID", 1, index, name, "it is no frequency in hertz")
        else:
            found[frequency] = index
    columns = [found[hz] for hz in GRID_HZ if hz in found]
    if len(columns) != len(GRID_HZ) or len(found) != len(GRID_HZ):
        message = f"line 1: {len(columns)} of {len(found)} frequencies are on the grid of {len(GRID_HZ)} from 20 to 1000 Hz in steps of 5"
        sheet.findings.add("SPECTRA_GRID_INVALID", "/1", message)
    return columns


def _read_row(sheet: Sheet, row: Row, grid: list[int], lines: dict[tuple[str, ...], dict[str, np.ndarray]]) -> None:
    participant, texture, model = (sheet.text(row, key) for key in _KEYS)
    magnitudes = []
    for column in grid:
        text, name = row.fields[column], sheet.names[column]
        if is_missing(text):
            sheet.findings.at(
                "SPECTRA_MAGNITUDE_MISSING", row.line, column, name, "it is missing; the line is not used"
            )
            return
        value = number(text)
        if value is None or not 0.0 <= value <= _LARGEST:
            message = f"`{text}` is not a number of at least 0; correct it, or remove the line"
            sheet.findings.at("SPECTRA_MAGNITUDE_INVALID", row.line, column, name, message)
            return
        magnitudes.append(value)
    cell = lines[(RECORDED if model == RECORDED else participant, texture, model)]
    numbered = sheet.column("repetition")
    repetition = "" if numbered is None else row.fields[numbered]
    if repetition in cell:
        message = "an earlier line has the same spectrum; remove one, or number them in a column `repetition`"
        sheet.findings.at("SPECTRA_DUPLICATE", row.line, sheet.names.index("participant"), "participant", message)
    cell[repetition] = np.array(magnitudes)


def _select(spectra: dict[tuple[str, ...], np.ndarray], ratings: Ratings, findings: Findings) -> Spectra:
    """Pick the spectra of the rated conditions."""
    none = np.full(len(GRID_HZ), np.nan)
    recorded = []
    for texture in ratings.textures:
        if (cell := (RECORDED, texture, RECORDED)) not in spectra:
            message = f"there is no recorded spectrum of texture {texture}; add a line with `recorded` as participant and as model"
            findings.add("SPECTRA_RECORDED_MISSING", "", message)
        recorded.append(spectra.pop(cell, none))
    felt = np.full((*ratings.means.shape, len(GRID_HZ)), np.nan)
    for index in map(tuple, np.argwhere(~np.isnan(ratings.means))):
        cell = (ratings.participants[index[0]], ratings.textures[index[1]], ratings.models[index[2]])
        if cell not in spectra:
            message = f"there is no spectrum that participant {cell[0]} felt of model {cell[2]} in texture {cell[1]}"
            findings.add("SPECTRA_CELL_MISSING", "", message)
        felt[index] = spectra.pop(cell, none)
    for participant, texture, model in spectra:
        message = f"the spectrum of participant {participant}, texture {texture}, model {model} has no rating"
        findings.add("SPECTRA_UNRATED", "", message)
    findings.check()
    return Spectra(np.array(recorded), felt, findings.list())
