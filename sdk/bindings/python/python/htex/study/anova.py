"""Repeated-measures ANOVA by orthonormal contrasts. Tests sphericity (Mauchly), and corrects for
its violation (Greenhouse and Geisser, Huynh and Feldt).

pingouin has the same tests, but under the GPL. So it is not used here; only the unit tests compare
the results with pingouin's.
"""

from __future__ import annotations

import numpy as np
from scipy import stats

from .notes import Notes, Undefined, complete, need_levels, need_participants, negligible, no_error_variance
from .results import AnovaResult

_TEST = "a repeated-measures ANOVA"
#: If the test of an assumption has a p-value below this level, the violated assumption is reported
#: next to the result.
LEVEL = 0.05


def one_way(table: np.ndarray, group: str, notes: Notes) -> AnovaResult | None:
    """Test whether the columns of a table differ. The table has a row for each participant.

    Rows with a missing value are left out.
    """
    return notes.take(group, lambda: _one_way(complete(table), group, notes))


def two_way(means: np.ndarray, group: str, notes: Notes) -> dict[str, AnovaResult]:
    """Test the effects of textures, of models and of their interaction.

    The means are indexed by participant, texture, model.
    """
    return notes.take(group, lambda: _two_way(means, group, notes)) or {}


def _one_way(table: np.ndarray, group: str, notes: Notes) -> AnovaResult:
    _check(len(table), table.shape[1])
    return _effect(table @ helmert(table.shape[1]).T, float(np.abs(table).max()), 1, group, notes)


def _two_way(means: np.ndarray, group: str, notes: Notes) -> dict[str, AnovaResult]:
    people, textures, models = means.shape
    rows = complete(means.reshape(people, -1))
    _check(len(rows), min(textures, models))
    cells, largest = rows.reshape(-1, textures, models), float(np.abs(rows).max())
    a, b = helmert(textures), helmert(models)
    scores = {
        "texture": (cells.mean(axis=2) @ a.T, models),
        "model": (cells.mean(axis=1) @ b.T, textures),
        "texture * model": (rows @ np.kron(a, b).T, 1),
    }
    return {name: _effect(s, largest, averaged, f"{group}.{name}", notes) for name, (s, averaged) in scores.items()}


def _check(participants: int, levels: int) -> None:
    need_levels(_TEST, levels)
    need_participants(_TEST, participants)


def helmert(levels: int) -> np.ndarray:
    """Return orthonormal contrasts: each condition against the mean of the conditions before it."""
    rows = np.tril(np.ones((levels, levels)), -1) - np.diag(np.arange(levels))
    return np.asarray(rows[1:] / np.linalg.norm(rows[1:], axis=1, keepdims=True))


def _effect(scores: np.ndarray, largest: float, averaged: int, group: str, notes: Notes) -> AnovaResult:
    """Test an effect. ``scores`` are the scores of its contrasts, which were computed from means of
    ``averaged`` values each.
    """
    people, size = scores.shape
    centred = scores - scores.mean(axis=0)
    products = centred.T @ centred
    effect = averaged * people * float((scores.mean(axis=0) ** 2).sum())
    error = averaged * float(np.trace(products))
    if negligible(error / averaged, largest, people * (size + 1)):
        raise no_error_variance(_TEST)
    df = (float(size), float(size * (people - 1)))
    f = (effect / df[0]) / (error / df[1])
    gg = greenhouse_geisser(products)
    hf = huynh_feldt(gg, size, people)
    p, p_gg, p_hf = (float(stats.f.sf(f, df[0] * epsilon, df[1] * epsilon)) for epsilon in (1.0, gg, hf))
    result = AnovaResult(
        f=f, df=df, p=p, p_gg=p_gg, p_hf=p_hf, eps_gg=gg, eps_hf=hf, partial_eta_squared=effect / (effect + error)
    )
    sphericity = notes.take(group, lambda: mauchly(products, people))
    if sphericity:
        w, chi2, p_pingouin, p_r = sphericity
        result.update({"mauchly_w": w, "mauchly_chi2": chi2, "mauchly_p": p_pingouin, "mauchly_p_r": p_r})
        if p_pingouin < LEVEL:
            result["assumptions"] = [f"sphericity fails (Mauchly's p = {p_pingouin:.3g}): read p_gg or p_hf, not p"]
    return result


def greenhouse_geisser(products: np.ndarray) -> float:
    """Return Greenhouse and Geisser's epsilon (1959), 1 / df to 1: (tr S)^2 / (df tr S^2), where S
    is the covariance of the contrasts. ``products`` is any multiple of S."""
    size = len(products)
    return float(np.clip(np.trace(products) ** 2 / (size * (products**2).sum()), 1 / size, 1))


def huynh_feldt(gg: float, size: int, people: int) -> float:
    """Return Huynh and Feldt's epsilon for one group (1976, equation 4), e to 1: (n df e - 2) / (df
    (n - 1 - df e)), where e is Greenhouse and Geisser's epsilon."""
    below = size * (people - 1 - size * gg)
    return float(np.clip((people * size * gg - 2) / below, gg, 1)) if below > 0 else 1.0


def mauchly(products: np.ndarray, people: int) -> tuple[float, float, float, float]:
    """Return Mauchly's W (1940), its test statistic, and two p-values: as pingouin computes it, and
    as R computes it.

    Both p-values use two terms of Box's expansion (Anderson 2003, section 10.7.4). They differ
    because pingouin 0.7 uses the number of conditions in one of the terms, instead of the number of
    contrasts.
    """
    d, n = len(products), people - 1
    if d < 2:
        raise Undefined(
            "SPHERICITY_TRIVIAL", "there is one difference between the conditions, so that sphericity always holds"
        )
    factor = 1 - (2 * d * d + d + 2) / (6 * d * n)
    if people <= d or factor <= 0 or np.linalg.matrix_rank(products, tol=1e-12 * np.trace(products)) < d:
        raise Undefined(
            "SPHERICITY_UNDEFINED",
            f"Mauchly's test is not defined for {people} participants and {d} differences between conditions: it needs more "
            "participants than differences, and none that depends on the others; use the corrected p-values",
        )
    log_w = min(0.0, float(np.linalg.slogdet(products)[1] - d * np.log(np.trace(products) / d)))
    chi2 = -n * factor * log_w
    df = d * (d + 1) / 2 - 1
    first, second = stats.chi2.sf(chi2, [df, df + 4])

    def p(last: int) -> float:
        cubic = 2 * d**3 + 6 * d**2 + 3 * last + 2
        weight = (d + 2) * (d - 1) * (d - 2) * cubic / (288 * (d * n * factor) ** 2)
        return float(np.clip(first + weight * (second - first), 0, 1))

    return float(np.exp(log_w)), float(chi2), p(d + 1), p(d)
