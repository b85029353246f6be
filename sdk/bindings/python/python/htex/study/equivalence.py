"""Test whether two conditions are equally good. A test that finds no difference does not show this,
but two one-sided tests can.
"""

from __future__ import annotations

from itertools import combinations

import numpy as np
from scipy import stats

from .notes import Notes, complete, need_participants, negligible, no_error_variance
from .results import Equivalence, EquivalencePair
from .tests import exact_ties

#: Default bound: half a step on a scale of whole numbers. A study should state its own bound before
#: anyone looks at the data.
BOUND = 0.5


def equivalence(table: np.ndarray, names: list[str], bound: float, group: str, notes: Notes) -> Equivalence:
    """Run two one-sided tests for every pair of columns, and Wilcoxon's test on the same
    differences.
    """
    results = []
    for i, j in combinations(range(len(names)), 2):
        a, b = complete(table[:, [i, j]]).T
        where = f"{group}.{names[i]}.{names[j]}"
        tested = notes.take(where, lambda a=a, b=b: tost(a, b, bound))  # type: ignore[misc]
        if tested:
            result = EquivalencePair(a=names[i], b=names[j], equivalent=tested["p_tost"] < 0.05, **tested)
            result["wilcoxon_w"], result["wilcoxon_p"] = wilcoxon(exact_ties(a) - exact_ties(b))
            results.append(result)
    return Equivalence(bound=bound, pairs=results)


def tost(a: np.ndarray, b: np.ndarray, bound: float) -> EquivalencePair:
    """Run two one-sided paired t-tests (Schuirmann 1987). Return the larger p-value, and the 90 %
    confidence interval of the difference, which leads to the same decision.
    """
    differences = a - b
    n, test = len(differences), "an equivalence test"
    need_participants(test, n)
    mean, sd = float(differences.mean()), float(differences.std(ddof=1))
    if negligible(sd * sd * (n - 1), float(np.abs([a, b]).max()), n):
        raise no_error_variance(test)
    error = sd / n**0.5
    p = max(stats.t.sf((mean + bound) / error, n - 1), stats.t.cdf((mean - bound) / error, n - 1))
    half = float(stats.t.ppf(0.95, n - 1)) * error
    return EquivalencePair(p_tost=float(p), ci90=(mean - half, mean + half))


def wilcoxon(differences: np.ndarray) -> tuple[float, float]:
    """Return Wilcoxon's W and its two-sided p-value, the same numbers as from SciPy's ``wilcoxon``.

    If there are up to 13 differences with ties, SciPy takes seconds for the permutations. This
    function computes all combinations of signs at once.
    """
    kept = differences[differences != 0]
    ranks = stats.rankdata(np.abs(kept))
    if len(differences) > 13 or len(kept) == len(np.unique(ranks)) == len(differences):
        found = stats.wilcoxon(differences)
        return float(found.statistic), float(found.pvalue)
    signs = (np.arange(2 ** len(kept))[:, None] >> np.arange(len(kept))) & 1
    sums, found_sum = signs @ ranks, float(ranks[kept > 0].sum())
    p = 2 * min((sums <= found_sum + 1e-9).mean(), (sums >= found_sum - 1e-9).mean())
    return min(found_sum, float(ranks.sum()) - found_sum), min(1.0, float(p))
