"""Tests of normality, pairs and ranks."""

from __future__ import annotations

import warnings
from collections.abc import Callable
from itertools import combinations
from typing import Any

import numpy as np
from scipy import stats

from .anova import LEVEL
from .notes import (
    Notes,
    Undefined,
    complete,
    is_constant,
    need_levels,
    need_participants,
    need_values,
    negligible,
    no_error_variance,
)
from .results import FriedmanResult, Normality, PairResult, RankPair

#: Names the values of the second test in `normality`. It is reported next to the test of the
#: residuals, for comparison with the paper.
CELL_MEANS = "cell means, z-scored with n-1"


def pairs(table: np.ndarray, names: list[str], group: str, notes: Notes) -> list[PairResult]:
    """Compare every pair of columns of a table.

    Participants who lack one of the two values are left out.
    """
    results = []
    for i, j in combinations(range(len(names)), 2):
        both = complete(table[:, [i, j]])
        if len(both):
            where = f"{group}.{names[i]}.{names[j]}"
            result = PairResult(a=names[i], b=names[j], mean_difference=float((both[:, 0] - both[:, 1]).mean()))
            result.update(notes.take(where, lambda both=both: paired_t(*both.T)) or {})  # type: ignore[misc]
            results.append(result)
    tested = [result for result in results if "p" in result]
    for result, b, h in zip(tested, *corrections([result["p"] for result in tested]), strict=True):
        result["p_bonferroni"], result["p_holm"] = b, h
    return results


def paired_t(a: np.ndarray, b: np.ndarray) -> PairResult:
    """Run a paired t-test. Also return its effect sizes, and whether the differences are normally
    distributed."""
    n, test = len(a), "a paired t-test"
    need_participants(test, n)
    differences = a - b
    squares = float(((differences - differences.mean()) ** 2).sum())
    if negligible(squares, float(np.abs([a, b]).max()), n):
        raise no_error_variance(test)
    found = stats.ttest_rel(a, b)
    low, high = found.confidence_interval(0.95)
    result = PairResult(t=float(found.statistic), df=n - 1, p=float(found.pvalue), ci95=(float(low), float(high)))
    mean = float(differences.mean())
    result["cohen_dz"] = mean / float(differences.std(ddof=1))
    average = float(np.sqrt((a.var(ddof=1) + b.var(ddof=1)) / 2))
    if average > 0:
        result["cohen_d_av"] = mean / average
        result["hedges_g"] = result["cohen_d_av"] * (1 - 3 / (8 * n - 9))
    if n >= 3:
        result["shapiro_p"] = float(stats.shapiro(differences).pvalue)
        if result["shapiro_p"] < LEVEL:
            said = f"the differences are not normal (Shapiro-Wilk p = {result['shapiro_p']:.3g}): read Wilcoxon's test"
            result["assumptions"] = [said]
    return result


def corrections(p: list[float]) -> tuple[list[float], list[float]]:
    """Return p-values corrected by Bonferroni, and by Holm (1979). Holm's p-values are never larger
    than Bonferroni's and have the same guarantee.

    >>> corrections([0.01, 0.04, 0.03])[1]
    [0.03, 0.06, 0.06]
    """
    values, count = np.array(p), len(p)
    order = np.argsort(values, kind="stable")
    holm = np.empty(count)
    holm[order] = np.maximum.accumulate(np.minimum(values[order] * (count - np.arange(count)), 1))
    return np.minimum(values * count, 1).tolist(), holm.tolist()


def friedman(table: np.ndarray) -> FriedmanResult:
    """Run Friedman's test on the columns of a table, and compute Kendall's W."""
    rows, test = exact_ties(complete(table)), "Friedman's test"
    need_levels(test, rows.shape[1], 3)
    need_participants(test, len(rows))
    if (rows == rows[:, :1]).all():
        message = "every participant rated all conditions alike, so there are no ranks to compare"
        raise Undefined("ALL_TIED", message)
    found = stats.friedmanchisquare(*rows.T)
    chi2, df = float(found.statistic), rows.shape[1] - 1
    return FriedmanResult(chi2=chi2, df=float(df), p=float(found.pvalue), kendall_w=min(1.0, chi2 / (len(rows) * df)))


def nemenyi(table: np.ndarray, names: list[str]) -> list[RankPair]:
    """Run Nemenyi's test on every pair of columns, after Friedman's test."""
    from scikit_posthocs import posthoc_nemenyi_friedman

    rows = exact_ties(complete(table))
    need_levels("Nemenyi's test", rows.shape[1], 3)
    need_participants("Nemenyi's test", len(rows))
    p = posthoc_nemenyi_friedman(rows).to_numpy()
    return [RankPair(a=names[i], b=names[j], p=float(p[i, j])) for i, j in combinations(range(len(names)), 2)]


def exact_ties(means: np.ndarray) -> np.ndarray:
    """Return means without the rounding errors of their sums, so that equal means tie."""
    return means.round(9)


def normality(values: np.ndarray, on: str, group: str, notes: Notes) -> Normality:
    """Run three tests of normality on values that were standardised by their own mean and standard
    deviation."""
    values = values[~np.isnan(values)].ravel()
    result = Normality(count=len(values), on=on)
    scores = notes.take(group, lambda: z_scores(values))
    if scores is None:
        return result
    for (statistic, p), needed, test in _NORMALITY:
        found = notes.take(group, lambda n=needed, t=test: _tested(scores, n, t))  # type: ignore[misc]
        if found:
            result.update({statistic: found[0], p: found[1]})  # type: ignore[misc]
    return result


def residuals(table: np.ndarray) -> np.ndarray:
    """Return the residuals of a table of participants by conditions, after removing the effects of
    both."""
    rows = complete(table)
    return rows - rows.mean(axis=0) - rows.mean(axis=1, keepdims=True) + rows.mean() if len(rows) else rows


def z_scores(values: np.ndarray) -> np.ndarray:
    """Return values minus their mean, divided by their standard deviation (n - 1)."""
    need_values("a z-score", len(values), 2)
    if is_constant(values):
        raise Undefined("CONSTANT", "all values are equal, so a z-score is not defined")
    return np.asarray((values - values.mean()) / values.std(ddof=1))


def _tested(scores: np.ndarray, needed: int, test: Callable[[np.ndarray], Any]) -> tuple[float, float]:
    need_values("a test of normality", len(scores), needed)
    with warnings.catch_warnings():
        # SciPy warns that Shapiro and Wilk's p-value is approximate above 5000 values.
        warnings.simplefilter("ignore")
        statistic, p = test(scores)
    return float(statistic), float(p)


def _kolmogorov(scores: np.ndarray) -> Any:
    return stats.kstest(scores, "norm")


def _lilliefors(scores: np.ndarray) -> Any:
    from statsmodels.stats.diagnostic import lilliefors

    return lilliefors(scores, dist="norm", pvalmethod="table")


_NORMALITY: list[tuple[tuple[str, str], int, Callable[[np.ndarray], Any]]] = [
    (("ks_d", "ks_p"), 1, _kolmogorov),
    (("lilliefors_d", "lilliefors_p"), 5, _lilliefors),
    (("shapiro_w", "shapiro_p"), 3, stats.shapiro),
]
