"""Read tables of ratings: long or wide, with one factor or two, complete or incomplete."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
import pandas as pd

from .rules import Finding, Findings
from .tables import Row, Sheet, is_missing, number, read_sheet, require

FACTORS = ("texture", "model")
#: The level of a factor that a table does not have.
ONLY = "all"
_KEYS = ["participant", "texture", "model"]
_KNOWN = {*_KEYS, "repetition", "rating", "simulated", "hidden_reference", "attribute"}
#: Columns that studies export but the analysis ignores.
_UNUSED = {"response_ms", "gain_db"}
_MOST_CONDITIONS = 1000
#: Largest absolute rating. Sums of squares of larger ratings would lose digits.
_LARGEST = 1e9
#: Characters that may separate a texture from a model in column names.
_SEPARATORS = ("/", ":", "|")


class Ratings:
    """Checked ratings: each answer, and the mean for each participant, texture and model."""

    def __init__(self, answers: pd.DataFrame, simulated: set[str], findings: list[Finding]) -> None:
        self.answers = answers
        cells = answers.groupby(_KEYS)["rating"].agg(["mean", "count"]).reset_index()
        self.cells = cells.rename(columns={"count": "repetitions"})
        self.participants, self.textures, self.models = (sorted(set(cells[key])) for key in _KEYS)
        self.simulated = sorted(simulated & set(self.participants))
        self.repetitions = int(self.cells["repetitions"].max())
        self.findings = findings
        every = pd.MultiIndex.from_product([self.participants, self.textures, self.models], names=_KEYS)
        shape = (len(self.participants), len(self.textures), len(self.models))
        #: Means by participant, texture and model; NaN where there is no answer.
        self.means = self.cells.set_index(_KEYS)["mean"].reindex(every).to_numpy(dtype=float).reshape(shape)

    def levels(self, factor: str) -> list[str]:
        """The levels of a factor, ``texture`` or ``model``."""
        return self.textures if factor == "texture" else self.models

    @property
    def factor(self) -> str:
        """Return the factor of the simplest comparisons: ``model``, or ``texture`` if there is only
        one model.
        """
        return "texture" if len(self.models) == 1 and len(self.textures) > 1 else "model"

    def marginal(self, factor: str) -> np.ndarray:
        """Return a table with a row for each participant and a column for each level of a factor,
        averaged over the other factor. A value is NaN if any of the averaged values is missing.
        """
        return np.asarray(self.means.mean(axis=2 if factor == "texture" else 1))

    def name_missing(self, leave_out: bool, findings: Findings) -> set[str]:
        """Add a finding that names the participants with missing conditions."""
        missing = np.isnan(self.means)
        incomplete = set()
        for index, participant in enumerate(self.participants):
            cells = np.argwhere(missing[index])
            if not len(cells):
                continue
            incomplete.add(participant)
            texture, model = cells[0]
            more = f" and {len(cells) - 1} others" if len(cells) > 1 else ""
            what = "the participant is left out" if leave_out else "tests that need it leave the participant out"
            findings.add(
                "RATINGS_LEFT_OUT" if leave_out else "RATINGS_CELL_MISSING",
                "",
                f"participant {participant} has no rating of model {self.models[model]} in texture {self.textures[texture]}{more}; {what}",
            )
        return incomplete


def read_ratings(
    table: Any,
    name: str = "ratings",
    *,
    renamed: Mapping[str, str] | None = None,
    scale: tuple[float, float] | None = None,
    leave_out_incomplete: bool = False,
) -> Ratings:
    """Read and check a table of ratings: a file, its bytes, or a data frame."""
    sheet = _long(read_sheet(table, name, renamed))
    require(sheet, ("participant", *FACTORS, "rating"))
    findings = sheet.findings
    _name_columns(sheet)
    answers, simulated = _answers(sheet, scale)
    findings.check()
    if answers.empty:
        findings.add("RATINGS_NONE_COMPLETE", "", "no line has a rating that can be analysed")
    if (size := answers["texture"].nunique() * answers["model"].nunique()) > _MOST_CONDITIONS:
        findings.add("RATINGS_TOO_MANY_CONDITIONS", "", f"there are {size} conditions")
    findings.check()
    ratings = Ratings(answers, simulated, findings.kept)
    incomplete = ratings.name_missing(leave_out_incomplete, findings)
    if leave_out_incomplete and incomplete:
        answers = answers[~answers["participant"].isin(incomplete)]
        if answers.empty:
            findings.add("RATINGS_NONE_COMPLETE", "", "no participant has rated every model in every texture")
        findings.check()
        ratings = Ratings(answers, simulated, findings.kept)
    _judge(ratings, findings)
    ratings.findings = findings.list()
    return ratings


def _long(sheet: Sheet) -> Sheet:
    """Convert a wide table, with a column for each condition, to a long table.

    If the table has only one factor, add the other factor with a single level.
    """
    absent = [factor for factor in FACTORS if factor not in sheet.names]
    if "rating" in sheet.names:
        return _with_only(sheet, absent) if len(absent) == 1 else sheet
    if "participant" not in sheet.names or not absent:
        return sheet
    conditions = [i for i, name in enumerate(sheet.names) if name and name not in _KNOWN | _UNUSED]
    split = {i: _condition(sheet.names[i], absent) for i in conditions}
    if len({len(levels) for levels in split.values()}) != 1:
        return sheet
    keys = [i for i, name in enumerate(sheet.names) if name in _KNOWN | _UNUSED]
    added = absent if len(next(iter(split.values()))) == len(absent) else [absent[-1]]
    rows = [
        Row(row.line, [*(row.fields[i] for i in keys), *levels, row.fields[i]])
        for row in sheet.rows
        for i, levels in split.items()
    ]
    long = Sheet([*(sheet.names[i] for i in keys), *added, "rating"], rows, sheet.findings)
    return _with_only(long, [factor for factor in FACTORS if factor not in long.names])


def _condition(name: str, absent: list[str]) -> tuple[str, ...]:
    """Return the levels that a column's name stands for: ``vinyl/ar`` if both factors are absent,
    otherwise one level.
    """
    if len(absent) == 2:
        for separator in _SEPARATORS:
            if name.count(separator) == 1:
                first, second = name.split(separator)
                return (first.strip(), second.strip())
    return (name,)


def _with_only(sheet: Sheet, absent: list[str]) -> Sheet:
    rows = [Row(row.line, [*row.fields, *[ONLY] * len(absent)]) for row in sheet.rows]
    return Sheet([*sheet.names, *absent], rows, sheet.findings)


def _name_columns(sheet: Sheet) -> None:
    for index, name in enumerate(sheet.names):
        if name not in _KNOWN | _UNUSED:
            sheet.findings.at("TABLE_COLUMN_UNKNOWN", 1, index, name, "it is not used")
    column = sheet.column("attribute")
    if column is None:
        return
    first = sheet.rows[0].fields[column]
    for row in sheet.rows:
        if row.fields[column] != first:
            message = f"it is `{row.fields[column]}`, and `{first}` in the first line; keep the lines of one attribute"
            sheet.findings.at("RATINGS_ATTRIBUTES", row.line, column, "attribute", message)
            return


def _answers(sheet: Sheet, scale: tuple[float, float] | None) -> tuple[pd.DataFrame, set[str]]:
    """Return the answers as a table with one answer per line, and the participants whose answers
    are simulated."""
    answers: dict[tuple[str, ...], float] = {}
    counts: dict[tuple[str, ...], int] = {}
    simulated, hidden, missing = set(), 0, 0
    repetition = sheet.column("repetition")
    for row in sheet.rows:
        if _is_yes(sheet, row, "hidden_reference"):
            hidden += 1
            continue
        cell = tuple(sheet.text(row, key) for key in _KEYS)
        if _is_yes(sheet, row, "simulated"):
            simulated.add(cell[0])
        counts[cell] = counts.get(cell, 0) + 1
        trial = str(counts[cell]) if repetition is None else sheet.text(row, "repetition")
        text = row.fields[sheet.names.index("rating")]
        missing += is_missing(text)
        value = None if is_missing(text) else _rating(sheet, row, text, scale)
        if value is not None and (*cell, trial) in answers:
            message = "an earlier line rates the same participant, texture, model and repetition; remove one"
            sheet.findings.at("RATING_DUPLICATE", row.line, repetition or 0, "repetition", message)
        if value is not None:
            answers[*cell, trial] = value
    if hidden:
        sheet.findings.add("RATINGS_HIDDEN_REFERENCE", "", f"{hidden} lines are hidden references and are not analysed")
    if missing:
        sheet.findings.add("RATING_MISSING", "", f"{missing} ratings are missing")
    rows = [(*key, value) for key, value in sorted(answers.items())]
    return pd.DataFrame(rows, columns=[*_KEYS, "repetition", "rating"]), simulated


def _is_yes(sheet: Sheet, row: Row, name: str) -> bool:
    column = sheet.column(name)
    return column is not None and row.fields[column].lower() in ("yes", "true", "1")


def _rating(sheet: Sheet, row: Row, text: str, scale: tuple[float, float] | None) -> float | None:
    column = sheet.names.index("rating")
    value = number(text)
    if value is None or abs(value) > _LARGEST:
        message = f"`{text}` is not a number; correct it, or remove the line"
        sheet.findings.at("RATING_INVALID", row.line, column, "rating", message)
        return None
    if scale is not None and not scale[0] <= value <= scale[1]:
        message = f"{value:g} is not on the scale from {scale[0]:g} to {scale[1]:g}; correct it, or remove the line"
        sheet.findings.at("RATING_OFF_SCALE", row.line, column, "rating", message)
    return value


def _judge(ratings: Ratings, findings: Findings) -> None:
    """Find problems that do not prevent the analysis."""
    fewest = int(ratings.cells["repetitions"].min())
    if fewest < ratings.repetitions:
        findings.add("RATINGS_UNBALANCED", "", f"conditions have {fewest} to {ratings.repetitions} repetitions")
    for participant, means in ratings.cells.groupby("participant")["mean"]:
        if len(means) > 1 and means.nunique() == 1:
            message = f"participant {participant} gave every condition the rating {means.iloc[0]:g}"
            findings.add("RATINGS_PARTICIPANT_CONSTANT", "", message)
    if ratings.simulated:
        message = f"{len(ratings.simulated)} of {len(ratings.participants)} participants are simulated"
        findings.add("RATINGS_SIMULATED", "", message)
