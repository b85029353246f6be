"""Intraclass correlations (McGraw and Wong 1996). They show whether participants agree with each
other, and whether repeated ratings agree.
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from .notes import Notes, Undefined, complete, need_levels, negligible
from .ratings import Ratings
from .results import Icc, Reliability


def reliability(ratings: Ratings, notes: Notes) -> Reliability:
    """The intraclass correlations of a study."""
    result = Reliability()
    conditions = ratings.means.reshape(len(ratings.participants), -1)
    found = notes.take("reliability.participants", lambda: icc(complete(conditions).T))
    if found:
        result["participants"] = found
    keys = ["participant", "texture", "model"]
    repeated = ratings.answers.pivot_table(index=keys, columns="repetition", values="rating").to_numpy(dtype=float)
    found = notes.take("reliability.repetitions", lambda: icc(complete(repeated)))
    if found:
        result["repetitions"] = found
    return result


def icc(table: np.ndarray) -> Icc:
    """Return the intraclass correlations of a table. It has a row for each rated condition and a
    column for each rater.
    """
    n, k = table.shape
    need_levels("an intraclass correlation", n)
    if k < 2:
        raise Undefined("TOO_FEW_VALUES", "1 rating of each is too few: an intraclass correlation needs at least 2")
    means, largest = table.mean(), float(np.abs(table).max())
    by_row = table.mean(axis=1, keepdims=True)
    by_column = table.mean(axis=0, keepdims=True)
    rows = k * float(((by_row - means) ** 2).sum()) / (n - 1)
    columns = n * float(((by_column - means) ** 2).sum()) / (k - 1)
    df = (n - 1) * (k - 1)
    rest = float(((table - by_row - by_column + means) ** 2).sum())
    if negligible(rest, largest, n * k) or negligible(rows, largest, n):
        raise Undefined("NO_ERROR_VARIANCE", "ratings do not vary beside their means, so reliability is not defined")
    error = rest / df
    f = rows / error
    low, high = f / stats.f.ppf(0.975, n - 1, df), f * stats.f.ppf(0.975, df, n - 1)
    return Icc(
        targets=n,
        raters=k,
        icc2=(rows - error) / (rows + (k - 1) * error + k * (columns - error) / n),
        icc2k=(rows - error) / (rows + (columns - error) / n),
        icc3=(rows - error) / (rows + (k - 1) * error),
        icc3k=(rows - error) / rows,
        ci95=(float((low - 1) / (low + k - 1)), float((high - 1) / (high + k - 1))),
        f=f,
        df=(float(n - 1), float(df)),
        p=float(stats.f.sf(f, n - 1, df)),
    )
