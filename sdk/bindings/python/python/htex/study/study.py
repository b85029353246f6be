"""Analyse the tables of a study, and return data frames, figures, text, JSON and a page."""

from __future__ import annotations

import errno
import json
import os
import pathlib
import tempfile
from collections.abc import Mapping
from functools import cached_property
from typing import Any

import pandas as pd
from matplotlib.figure import Figure

from htex import __version__

from .analysis import compute
from .equivalence import BOUND
from .figures import figures, to_pdf
from .frames import frames
from .ratings import Ratings, read_ratings
from .report import Picture, picture, to_html
from .results import AnalysisDict
from .rules import Finding
from .spectra import Spectra, read_spectra
from .text import to_text


class Analysis:
    """The analysis of a study. ``str()`` returns it as text."""

    def __init__(self, ratings: Ratings, spectra: Spectra | None, bound: float) -> None:
        self.ratings = ratings
        self.spectra = spectra
        self.result: AnalysisDict = compute(ratings, spectra, bound, f"htex {__version__}")

    def __str__(self) -> str:
        """Return the analysis as text: tables and sentences."""
        return to_text(self.result)

    @property
    def findings(self) -> list[Finding]:
        """The problems that were found in the tables. None of them is an error, because a table
        with an error is not analysed."""
        return [*self.ratings.findings, *(self.spectra.findings if self.spectra else [])]

    @cached_property
    def frames(self) -> dict[str, pd.DataFrame]:
        """The tables: ``means``, ``pairs``, ``equivalence``, ``effects``, ``bands`` and others."""
        return frames(self.result)

    @cached_property
    def figures(self) -> dict[str, Figure]:
        """The figures, by name."""
        return figures(self.result)

    @cached_property
    def _pictures(self) -> dict[str, Picture]:
        return {name: picture(name, figure) for name, figure in self.figures.items()}

    def to_dict(self) -> AnalysisDict:
        """Return the analysis as a dict that follows its JSON Schema (``htex schema
        study-analysis``)."""
        return self.result

    def to_json(self, indent: int | None = None) -> str:
        """The analysis as JSON."""
        separators = (",", ":") if indent is None else None
        return json.dumps(self.result, ensure_ascii=False, allow_nan=False, indent=indent, separators=separators)

    def to_html(self, command: str = "") -> str:
        """Return the report as an HTML page in a single file. ``command`` is the command that made
        it, and is shown on the page."""
        return to_html(self.result, self._pictures, command)

    def files(self, command: str = "") -> dict[str, bytes]:
        """Return the files that :meth:`save` writes."""
        texts = {"report.html": self.to_html(command), "analysis.json": self.to_json(indent=2) + "\n"}
        texts.update(
            {
                f"{name}.csv": _marked(frame).to_csv(index=False, lineterminator="\n")
                for name, frame in self.frames.items()
            }
        )
        files = {name: text.encode() for name, text in texts.items()}
        for name, figure in self.figures.items():
            stem = f"figures/{_file_name(name)}"
            while f"{stem}.svg" in files:
                stem += "_"
            files[f"{stem}.svg"] = self._pictures[name].svg.encode()
            files[f"{stem}.pdf"] = to_pdf(figure)
        return files

    def save(self, folder: str | os.PathLike[str], command: str = "") -> None:
        """Write report.html, analysis.json, the tables as CSV, and the figures as SVG and PDF."""
        for name, data in self.files(command).items():
            path = pathlib.Path(folder, name)
            # The user chose the folder, but its contents may come from somebody else. So no link
            # inside it is followed.
            if path.parent != pathlib.Path(folder) and path.parent.is_symlink():
                problem = "it is a symbolic link, and nothing is written through one here; remove it"
                raise PermissionError(errno.EPERM, problem, str(path.parent))
            path.parent.mkdir(parents=True, exist_ok=True)
            with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as beside:
                beside.write(data)
            os.chmod(beside.name, 0o644)
            os.replace(beside.name, path)


def _marked(frame: pd.DataFrame) -> pd.DataFrame:
    """Mark values as text if a spreadsheet would take them for a formula."""

    def mark(cell: object) -> object:
        is_formula = isinstance(cell, str) and cell.startswith(("=", "+", "-", "@", "\t", "\r"))
        return f"'{cell}" if is_formula else cell

    return frame.apply(lambda column: column.map(mark)).rename(columns=mark)


def analyse(
    ratings: Any,
    spectra: Any = None,
    *,
    scale: tuple[float, float] | None = None,
    bound: float = BOUND,
    columns: Mapping[str, str] | None = None,
    leave_out_incomplete: bool = False,
) -> Analysis:
    """Analyse ratings and, optionally, felt spectra. Each table is a data frame, the path of a CSV
    or .xlsx file, or the bytes of such a file.

    The table of ratings has the columns ``participant``, ``texture``, ``model`` and ``rating``, and
    ``repetition`` if conditions were rated several times. Instead of ``rating``, it may have a
    column for each condition (``vinyl/ar``), or for each model. ``columns`` maps these names to the
    names in your table. The table of spectra has the columns ``participant``, ``texture``,
    ``model``, and a magnitude at each of 20, 25, ..., 1000 Hz. Lines with the model ``recorded``
    contain the spectra of the real textures. Ratings outside ``scale`` are errors. Two conditions
    count as equally good if their ratings differ by at most ``bound``.
    """
    if not 0 < bound < float("inf"):
        raise ValueError(f"the bound is {bound:g}; it is above 0")
    names = [
        str(table) if isinstance(table, (str, os.PathLike)) else name
        for table, name in ((ratings, "ratings"), (spectra, "spectra"))
    ]
    rated = read_ratings(ratings, names[0], renamed=columns, scale=scale, leave_out_incomplete=leave_out_incomplete)
    felt = None
    if spectra is not None:
        shared = {own: theirs for own, theirs in (columns or {}).items() if own in ("participant", "texture", "model")}
        felt = read_spectra(spectra, rated, names[1], renamed=shared)
    return Analysis(rated, felt, bound)


def _file_name(name: str) -> str:
    """Return a file name that is valid on every system, because textures may have any name."""
    kept = "".join(c if c.isalnum() or c in "-_ ." else "_" for c in name)
    return kept.strip(" .")[:80] or "_"
