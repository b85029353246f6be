"""Fit a linear mixed model to all cell means. It also uses participants who have not rated
everything.
"""

from __future__ import annotations

import warnings
from typing import Any

import numpy as np
from scipy import stats

from .notes import Undefined, is_constant, need_levels, need_participants
from .ratings import FACTORS, Ratings
from .results import MixedEffect, MixedModel

_TEST = "a mixed model"


def mixed_model(ratings: Ratings) -> MixedModel:
    """Fit fixed effects of texture, of model and of their interaction. Random effects are the
    participants, and each participant's preferences among textures and among models.
    """
    factors = [factor for factor in FACTORS if len(ratings.levels(factor)) > 1]
    need_levels(_TEST, len(ratings.levels(ratings.factor)))
    need_participants(_TEST, len(ratings.participants))
    cells = ratings.cells
    seen = cells.groupby(factors).size()
    if len(seen) < np.prod([len(ratings.levels(factor)) for factor in factors]):
        raise Undefined("TOO_FEW_VALUES", f"a condition has no rating: {_TEST} needs one of each")
    if is_constant(cells["mean"].to_numpy(dtype=float)):
        raise Undefined("CONSTANT", f"all values are equal, so {_TEST} is not defined")
    fit = _fit(ratings, factors)
    sizes = {factor: len(ratings.levels(factor)) - 1 for factor in factors}
    effects = {}
    for name in [*factors, " * ".join(factors)] if len(factors) > 1 else factors:
        effects[name] = _effect(fit, name.split(" * "), sizes, len(ratings.participants), len(cells))
    variances = dict(zip(fit.model.exog_vc.names, map(float, fit.vcomp), strict=True))
    variances["residual"] = float(fit.scale)
    return MixedModel(effects=effects, variances=variances, means=_means(ratings, fit, factors))


def _fit(ratings: Ratings, factors: list[str]) -> Any:
    from statsmodels.regression.mixed_linear_model import MixedLM

    formula = "mean ~ " + " * ".join(f"C({factor}, Sum)" for factor in factors)
    # All random effects are variance components, because these may be 0. In statsmodels 0.14, a
    # random intercept without variance has no solution.
    components = {"participant": "1"}
    if len(factors) > 1:
        components.update({f"participant * {factor}": f"0 + C({factor})" for factor in factors})
    model = MixedLM.from_formula(formula, ratings.cells, groups="participant", vc_formula=components)
    # The default method, L-BFGS, stops far from the optimum if a component is small. So two other
    # methods are tried, and the fit with the larger likelihood is used.
    found = [fit for method in ("bfgs", "powell") if (fit := _fitted(model, method)) is not None]
    if not found:
        raise Undefined("NOT_CONVERGED", f"{_TEST} has no solution for these ratings")
    return max(found, key=lambda fit: float(fit.llf))


def _fitted(model: Any, method: str) -> Any:
    """Return the fit with an optimisation method, or None if it has no finite solution."""
    with warnings.catch_warnings():
        # A variance at its bound of 0 is a result, not an error.
        warnings.simplefilter("ignore")
        try:
            fit = model.fit(reml=True, method=method)
            errors = np.asarray(fit.bse_fe)
        except (np.linalg.LinAlgError, ValueError, ZeroDivisionError):
            return None
    is_finite = np.isfinite(fit.llf) and fit.scale > 0 and np.isfinite(errors).all() and (errors > 0).all()
    return fit if is_finite else None


def _effect(fit: Any, factors: list[str], sizes: dict[str, int], people: int, cells: int) -> MixedEffect:
    """Run Wald's test of an effect.

    The degrees of freedom of the error are those of the effect's interaction with participants.
    """
    names = [f"C({factor}, Sum)" for factor in factors]
    parts = [set(part.split("[")[0] for part in name.split(":")) for name in fit.model.exog_names]
    chosen = [index for index, part in enumerate(parts) if part == set(names)]
    estimate = np.asarray(fit.fe_params)[chosen]
    covariance = np.asarray(fit.cov_params())[np.ix_(chosen, chosen)]
    df1 = int(np.prod([sizes[factor] for factor in factors]))
    conditions = int(np.prod([size + 1 for size in sizes.values()]))
    df2 = (people - 1) * df1 - (people * conditions - cells if len(factors) == len(sizes) else 0)
    if df2 < 1:
        raise Undefined("TOO_FEW_VALUES", f"{cells} values are too few for {_TEST}")
    f = float(estimate @ np.linalg.solve(covariance, estimate)) / df1
    return MixedEffect(f=f, df=(float(df1), float(df2)), p=float(stats.f.sf(f, df1, df2)))


def _means(ratings: Ratings, fit: Any, factors: list[str]) -> dict[str, float]:
    """Return the mean of each level, averaged over the other factor as if every cell were filled.
    """
    coefficients = dict(zip(fit.model.exog_names, map(float, fit.fe_params), strict=True))
    levels = ratings.levels(ratings.factor)
    effects = [coefficients[f"C({ratings.factor}, Sum)[S.{level}]"] for level in levels[:-1]]
    centre = coefficients["Intercept"]
    return {level: centre + effect for level, effect in zip(levels, [*effects, -sum(effects)], strict=True)}
