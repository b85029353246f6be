"""Notes that state why a result is missing. If the data do not allow a test, the test reports this,
and the analysis collects the reports.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import TypeVar

import numpy as np

from .results import Note

T = TypeVar("T")


class Undefined(Exception):
    """Raised by a test that the data do not allow. A code never changes its meaning."""

    def __init__(self, code: str, message: str) -> None:
        super().__init__(message)
        self.code = code


@dataclass
class Notes:
    """Notes on results that are missing or need care. Each has the key of the result's group."""

    all: list[Note] = field(default_factory=list)

    def add(self, group: str, code: str, message: str) -> None:
        """Add a note."""
        self.all.append(Note(group=group, code=code, message=message))

    def take(self, group: str, test: Callable[[], T]) -> T | None:
        """Return the result of a test. If the data do not allow it, add a note that states why, and
        return None."""
        try:
            return test()
        except Undefined as reason:
            self.add(group, reason.code, str(reason))
            return None


def need_participants(test: str, found: int, needed: int = 2) -> None:
    """Raise if there are fewer participants than a test needs."""
    if found < needed:
        raise Undefined("TOO_FEW_PARTICIPANTS", f"{found} participants are too few: {test} needs at least {needed}")


def need_levels(test: str, found: int, needed: int = 2) -> None:
    """Raise if there are fewer conditions than a test needs."""
    if found < needed:
        raise Undefined("TOO_FEW_LEVELS", f"{found} conditions are too few: {test} compares at least {needed}")


def need_values(test: str, found: int, needed: int) -> None:
    """Raise if there are fewer values than a test needs."""
    if found < needed:
        raise Undefined("TOO_FEW_VALUES", f"{found} values are too few: {test} needs at least {needed}")


def no_error_variance(test: str) -> Undefined:
    """Return the error for a table in which all participants have the same differences."""
    same = "every participant has the same differences between the conditions: there is no error variance"
    return Undefined("NO_ERROR_VARIANCE", f"{same}, so {test} is not defined")


def complete(table: np.ndarray) -> np.ndarray:
    """Return the rows of a table that have no missing value."""
    return np.asarray(table[~np.isnan(table).any(axis=1)])


def negligible(squares: float, largest: float, count: int) -> bool:
    """Return whether a sum of squares can result from rounding alone, for ``count`` values of a
    magnitude up to ``largest``.
    """
    return squares <= (largest * 1e-13) ** 2 * count


def is_constant(values: np.ndarray) -> bool:
    """Return whether values differ by no more than rounding."""
    return negligible(float(((values - values.mean()) ** 2).sum()), float(np.abs(values).max()), len(values))
