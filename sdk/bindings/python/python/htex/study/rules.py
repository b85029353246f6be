"""Findings: problems in tables of ratings and spectra. This module lists all rules, and collects
the findings of a table.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import NamedTuple

#: Largest number of findings that are kept for one table. Further findings are only counted.
MOST = 100


class Rule(NamedTuple):
    """A rule that findings refer to by its code. A code never changes its meaning."""

    code: str
    #: ``error``, ``warning`` or ``info``: a table with an error is not analysed.
    severity: str
    summary: str
    explanation: str
    fix: str


class Finding(NamedTuple):
    """A problem that was found in a table."""

    code: str
    severity: str
    #: Where the problem is: line and column, such as ``/12/rating``. Lines count from 1 and include
    #: the header. Empty for the whole table.
    pointer: str
    message: str

    def __str__(self) -> str:
        """Return the code, the place and the message."""
        place = f" at {self.pointer}" if self.pointer else ""
        return f"{self.code}{place}: {self.message}"


class TableError(ValueError):
    """Raised for a table that cannot be analysed. It has all findings of the table."""

    def __init__(self, table: str, findings: list[Finding]) -> None:
        self.table = table
        self.findings = findings
        lines = "".join(f"\n  {finding.severity} {finding}" for finding in findings)
        super().__init__(f"{table}: this table cannot be analysed (`htex explain CODE` says more){lines}")


@dataclass
class Findings:
    """The findings of one table. Only the first hundred are kept."""

    table: str
    kept: list[Finding] = field(default_factory=list)
    dropped: int = 0
    failed: bool = False

    def add(self, code: str, pointer: str, message: str) -> None:
        """Add a finding for the rule with this code."""
        rule = _BY_CODE[code]
        self.failed = self.failed or rule.severity == "error"
        if len(self.kept) < MOST:
            self.kept.append(Finding(code, rule.severity, pointer, message))
        else:
            self.dropped += 1

    def at(self, code: str, line: int, column: int, name: str, message: str) -> None:
        """Add a finding about a field. Columns count from 0."""
        pointer = f"/{line}/{name.replace('~', '~0').replace('/', '~1')}"
        self.add(code, pointer, f"line {line}, column {column + 1} (`{name}`): {message}")

    def list(self) -> list[Finding]:
        """Return all findings that were kept. If some were dropped, the last one states how
        many."""
        if not self.dropped:
            return self.kept
        message = f"{self.dropped} more findings are not shown"
        return [*self.kept, Finding("FINDINGS_TRUNCATED", "info", "", message)]

    def check(self) -> None:
        """Raise if one of the findings is an error."""
        if self.failed:
            raise TableError(self.table, self.list())


def explain(code: str) -> str | None:
    """Return the meaning of a code and how to solve the problem, or None if it is not a code of
    tables."""
    rule = _BY_CODE.get(code.upper())
    return rule and f"{rule.code}: {rule.summary}\n\n{rule.explanation}\n\nWhat to do: {rule.fix}\n"


def findings_page() -> str:
    """Return the page with all rules: ``spec/analysis-findings.md``."""
    rows = [f"| [{r.code}](#{r.code.lower()}) | {r.severity} | {r.summary} |\n" for r in RULES]
    texts = [
        f"\n## {r.code}\n\n{r.severity}: {r.summary}\n\n{r.explanation}\n\n**What to do:** {r.fix}\n" for r in RULES
    ]
    return _HEAD + "".join(rows) + "".join(texts)


_HEAD = """\
# Findings in tables of ratings and of spectra

Generated from the table of rules in `sdk/bindings/python/python/htex/study/rules.py` by
`HTEX_GENERATE=1 pytest sdk/bindings/python -k generated`.

`htex study analyse` checks its tables. A finding has a code, a severity, a pointer and a message. The pointer is the line
of the file, counted from 1 with the header, and the column by name: `/12/rating`; it is empty for the file as a whole. A table
with an error is not analysed. Codes never change their meaning.

| code | severity | what was found |
|---|---|---|
"""

RULES = (
    Rule(
        "TABLE_TOO_LARGE",
        "error",
        "The file is larger than 256 MiB.",
        "A reader limits what it reads from an untrusted file.",
        "Name the table of ratings or of spectra; a study of a thousand people takes a few megabytes.",
    ),
    Rule(
        "TABLE_NOT_UTF8",
        "error",
        "The file is not text in UTF-8.",
        "Names with other encodings would be read as other names.",
        "Save it as CSV in UTF-8, or as .xlsx.",
    ),
    Rule(
        "TABLE_EMPTY",
        "error",
        "The table has no rows.",
        "There is nothing to analyse.",
        "Name a table with a header line and a line for each answer.",
    ),
    Rule(
        "TABLE_COLUMN_MISSING",
        "error",
        "A column is missing.",
        "Columns are found by the names of the first line.",
        "Name the columns as the message lists them, or say which is which (`--map rating=Bewertung`).",
    ),
    Rule(
        "TABLE_COLUMN_DUPLICATE",
        "error",
        "Two columns have the same name.",
        "It is undefined which of them holds the values.",
        "Remove or rename one.",
    ),
    Rule(
        "TABLE_COLUMN_UNKNOWN",
        "info",
        "A column is not used.",
        "Tables may hold more than the analysis needs.",
        "Nothing, unless its name is misspelt.",
    ),
    Rule(
        "TABLE_FIELDS",
        "error",
        "A line has another number of fields than the header.",
        "Its values would be read from the wrong columns.",
        "Correct the line; a field with the separator in it is written in quotation marks.",
    ),
    Rule(
        "TABLE_XLSX_INVALID",
        "error",
        "The file is not a workbook that can be read.",
        "Its name ends in .xlsx, and its bytes are no such workbook.",
        "Save it again as .xlsx, or as CSV in UTF-8.",
    ),
    Rule(
        "TABLE_NAME_EMPTY",
        "error",
        "A name is empty.",
        "Every value belongs to a participant, a texture and a model.",
        "Fill it in, or remove the line.",
    ),
    Rule(
        "RATING_INVALID",
        "error",
        "A rating is not a number.",
        "A missing answer cannot be guessed.",
        "Write a number; leave the field empty, or write `NA`, where an answer was not given.",
    ),
    Rule(
        "RATING_MISSING",
        "info",
        "A rating is missing.",
        "An empty field, `NA`, `NaN` and the like say that an answer was not given.",
        "Nothing; tests use the answers that were given.",
    ),
    Rule(
        "RATING_OFF_SCALE",
        "error",
        "A rating is not on the scale that was given (--scale).",
        "It is a slip of typing, or the rating of another study.",
        "Correct it, or remove the line; give the study's scale as in `--scale 0-6`.",
    ),
    Rule(
        "RATING_DUPLICATE",
        "error",
        "The same trial is rated twice.",
        "Participant, texture, model and repetition name one trial; it is undefined which of its ratings counts.",
        "Remove one of the lines, or number the repetitions.",
    ),
    Rule(
        "RATINGS_CELL_MISSING",
        "warning",
        "A participant has not rated a model in a texture.",
        "A test of repeated measures compares conditions within each participant: it uses those who rated all that it compares, and the mixed model uses every rating.",
        "State it where the results are published; `--leave-out-incomplete` leaves such participants out of everything.",
    ),
    Rule(
        "RATINGS_LEFT_OUT",
        "warning",
        "A participant with missing ratings was left out.",
        "It was asked for. Results hold for those who completed the study.",
        "State it where the results are published.",
    ),
    Rule(
        "RATINGS_NONE_COMPLETE",
        "error",
        "No rating is left to analyse.",
        "Nothing is left to compare.",
        "Check the names of textures and models for variants of spelling; without --leave-out-incomplete, incomplete participants stay.",
    ),
    Rule(
        "RATINGS_TOO_MANY_CONDITIONS",
        "error",
        "There are more than 1000 combinations of textures and models.",
        "A limit for untrusted files; the tests compare all conditions with one another.",
        "Analyse a part of the study.",
    ),
    Rule(
        "RATINGS_UNBALANCED",
        "warning",
        "Conditions have different numbers of repetitions.",
        "Tests use the mean of each condition, and those of fewer repetitions vary more.",
        "Complete the study, or state it where the results are published.",
    ),
    Rule(
        "RATINGS_PARTICIPANT_CONSTANT",
        "warning",
        "A participant gave all conditions the same rating.",
        "Such answers tell no condition from another; their z-scores are taken as 0.",
        "Check whether the participant understood the scale.",
    ),
    Rule(
        "RATINGS_ATTRIBUTES",
        "error",
        "The table has ratings of several attributes.",
        "Ratings of roughness and of similarity cannot be averaged.",
        "Export one attribute (`htex study export --attribute`), or keep the lines of one.",
    ),
    Rule(
        "RATINGS_HIDDEN_REFERENCE",
        "info",
        "Lines of hidden references are not analysed.",
        "A hidden reference is the real texture compared with itself; it shows who can rate, and is no model.",
        "Nothing.",
    ),
    Rule(
        "RATINGS_SIMULATED",
        "warning",
        "Ratings are of simulated participants.",
        "They show that a study works, and nothing about people.",
        "Do not publish them as results.",
    ),
    Rule(
        "SPECTRA_GRID_INVALID",
        "error",
        "The columns of magnitudes are not 20, 25, ..., 1000 Hz.",
        "Spectra are compared bin by bin.",
        "Write a column for each frequency from 20 to 1000 Hz in steps of 5, named by its number.",
    ),
    Rule(
        "SPECTRA_MAGNITUDE_INVALID",
        "error",
        "A magnitude is not a number of at least 0.",
        "Magnitudes of a texture spectrum are forces in newtons, or all in another unit.",
        "Correct it, or remove the line.",
    ),
    Rule(
        "SPECTRA_MAGNITUDE_MISSING",
        "warning",
        "A magnitude is missing, and its line is not used.",
        "Spectra are compared over all bins.",
        "Measure it again, or state it where the results are published.",
    ),
    Rule(
        "SPECTRA_DUPLICATE",
        "error",
        "A spectrum is given twice.",
        "It is undefined which of them was felt.",
        "Remove one, or number them in a column `repetition`: their magnitudes are averaged.",
    ),
    Rule(
        "SPECTRA_RECORDED_MISSING",
        "error",
        "The recorded spectrum of a texture is missing.",
        "Felt spectra are compared with that of the real texture.",
        "Add a line with `recorded` as participant and as model.",
    ),
    Rule(
        "SPECTRA_CELL_MISSING",
        "warning",
        "The felt spectrum of a rated condition is missing.",
        "Correlation and regression use the conditions that have both ratings and spectra.",
        "Add it, or state it where the results are published.",
    ),
    Rule(
        "SPECTRA_UNRATED",
        "info",
        "A felt spectrum has no rating and is not used.",
        "Conditions are those of the ratings.",
        "Nothing, unless its names are misspelt.",
    ),
)

_BY_CODE = {rule.code: rule for rule in RULES}
