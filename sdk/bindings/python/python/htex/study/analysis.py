"""Compute the whole analysis of a study. The simplest comparisons come first."""

from __future__ import annotations

from typing import Any

import numpy as np

from . import anova, tests
from .equivalence import equivalence
from .methods import METHODS
from .mixed import mixed_model
from .notes import Notes, is_constant
from .planning import power
from .ratings import Ratings
from .regression import bands, correlations, rows_of
from .reliability import reliability
from .results import AnalysisDict, AnovaResult, Mean, Normality, PowerRow, SpectralCorrelation
from .spectra import Spectra

#: Name and version of the JSON format of analyses.
FORM = "htex-study-analysis/1"
#: A medium effect, as Cohen's f (1988). The paper plans its number of participants for this effect.
_MEDIUM_F = 0.25


def compute(ratings: Ratings, spectra: Spectra | None, bound: float, program: str) -> AnalysisDict:
    """Run every test of the study. If the data do not allow a test, add a note that states why."""
    notes = Notes()
    result = _about(ratings, program)
    _of_factor(result, ratings, bound, notes)
    result["anova_two_way"] = anova.two_way(ratings.means, "anova_two_way", notes)
    result["normality"] = _normality(ratings.means, "normality", notes)
    for index, texture in enumerate(ratings.textures if len(ratings.models) > 1 else []):
        _in_texture(result, ratings, index, texture, bound, notes)
    result["mixed_model"] = notes.take("mixed_model", lambda: mixed_model(ratings))  # type: ignore[typeddict-item]
    result["reliability"] = reliability(ratings, notes)
    result["power"] = _power(ratings)
    if spectra is not None:
        result["spectral_correlation"] = _correlation(ratings, spectra, notes)
        result["bands"], result["best_bands"] = bands(rows_of(ratings, spectra), notes)  # type: ignore[typeddict-item]
    result["notes"] = notes.all
    for key in ("mixed_model", "reliability", "spectral_correlation"):
        if result.get(key):
            result[key]["method"] = METHODS[key]
    return _without_absent(result)


def _about(ratings: Ratings, program: str) -> AnalysisDict:
    cells = ratings.cells.to_dict("records")
    result = AnalysisDict(
        analysis=FORM,
        program=program,
        participants=ratings.participants,
        simulated=ratings.simulated,
        textures=ratings.textures,
        models=ratings.models,
        repetitions=ratings.repetitions,
        methods=METHODS,
        notes=[],
        cell_means=cells,
        means_model=_means(ratings.marginal("model"), model=ratings.models),
        means=[
            mean
            for index, texture in enumerate(ratings.textures)
            for mean in _means(ratings.means[:, index], model=ratings.models, texture=texture)
        ],
        pairs_model=[],
        normality_by_texture={},
        normality_of_residuals_by_texture={},
        anova_by_texture={},
        friedman_by_texture={},
        pairs_by_texture={},
        equivalence_by_texture={},
        nemenyi_by_texture={},
    )
    if ratings.factor == "texture":
        result["means_texture"] = _means(ratings.marginal("texture"), texture=ratings.textures)
    return result


def _of_factor(result: AnalysisDict, ratings: Ratings, bound: float, notes: Notes) -> None:
    """Compare the levels of the study's first factor, averaged over the other one."""
    factor = ratings.factor
    table, names = ratings.marginal(factor), ratings.levels(factor)
    friedman = "friedman" if factor == "model" else "friedman_texture"
    keys: dict[str, Any] = result  # type: ignore[assignment]
    keys[f"pairs_{factor}"] = tests.pairs(table, names, f"pairs_{factor}", notes)
    result["equivalence"] = equivalence(table, names, bound, "equivalence", notes)
    on = f"participant x {factor} means less both effects"
    result["normality_of_residuals"] = _normality(tests.residuals(table), "normality_of_residuals", notes, on)
    found = anova.one_way(table, f"anova_{factor}", notes)
    keys[f"anova_{factor}"] = _with_method(found, f"anova_{factor}", result["normality_of_residuals"])
    keys[friedman] = notes.take(friedman, lambda: tests.friedman(table))
    if keys[friedman]:
        keys[friedman]["method"] = METHODS[friedman]
        result["nemenyi"] = tests.nemenyi(table, names)


def _in_texture(result: AnalysisDict, ratings: Ratings, index: int, name: str, bound: float, notes: Notes) -> None:
    """Compare the models in one texture."""
    table, names = ratings.means[:, index], ratings.models
    result["pairs_by_texture"][name] = tests.pairs(table, names, f"pairs_by_texture.{name}", notes)
    group = f"equivalence_by_texture.{name}"
    result["equivalence_by_texture"][name] = equivalence(table, names, bound, group, notes)
    result["normality_by_texture"][name] = _normality(table, f"normality_by_texture.{name}", notes)
    group, on = f"normality_of_residuals_by_texture.{name}", "participant x model means less both effects"
    normality = _normality(tests.residuals(table), group, notes, on)
    result["normality_of_residuals_by_texture"][name] = normality
    if found := anova.one_way(table, f"anova_by_texture.{name}", notes):
        result["anova_by_texture"][name] = _with_method(found, "anova_by_texture", normality)  # type: ignore[assignment]
    if ranked := notes.take(f"friedman_by_texture.{name}", lambda: tests.friedman(table)):
        result["friedman_by_texture"][name] = {**ranked, "method": METHODS["friedman_by_texture"]}
        result["nemenyi_by_texture"][name] = tests.nemenyi(table, names)


def _with_method(test: AnovaResult | None, group: str, normality: Normality) -> AnovaResult | None:
    """Return a test with its method. If its residuals are not normal, state that too."""
    if test is None:
        return None
    p = normality.get("shapiro_p", 1.0)
    if p < anova.LEVEL:
        said = f"residuals are not normal (Shapiro-Wilk p = {p:.3g}): read Friedman's test"
        test["assumptions"] = [*test.get("assumptions", []), said]
    return {**test, "method": METHODS[group]}


def _normality(values: np.ndarray, group: str, notes: Notes, on: str = tests.CELL_MEANS) -> Normality:
    return {**tests.normality(values, on, group, notes), "method": METHODS[group.split(".")[0]]}


def _means(table: np.ndarray, *, model: list[str] | None = None, texture: Any = None) -> list[Mean]:
    """Compute the mean over participants of each column that has a value. Each mean is named by a
    model, a texture, or both.
    """
    results = []
    for index, name in enumerate(model or texture):
        values = table[:, index][~np.isnan(table[:, index])]
        if len(values):
            names = Mean(texture=texture, model=name) if model and texture else Mean()
            if not names:
                names = Mean(model=name) if model else Mean(texture=name)
            sd = float(values.std(ddof=1)) if len(values) > 1 and not is_constant(values) else 0.0
            numbers = Mean(count=len(values), mean=float(values.mean()), sd=sd, by_participant=values.tolist())
            results.append(Mean({**names, **numbers}))
    return results


def _correlation(ratings: Ratings, spectra: Spectra, notes: Notes) -> SpectralCorrelation:
    values, cells = correlations(ratings, spectra, notes)
    counts = (~np.isnan(values)).sum(axis=1)
    overall = np.where(counts > 0, np.nansum(values, axis=1) / np.maximum(counts, 1), np.nan)
    return SpectralCorrelation(
        cells=cells,
        means=[
            mean
            for index, texture in enumerate(ratings.textures)
            for mean in _means(values[:, index], model=ratings.models, texture=texture)
        ],
        means_model=_means(overall, model=ratings.models),
    )


def _power(ratings: Ratings) -> list[PowerRow]:
    """Compute the power for 4 participants (2 in smaller studies) up to the number in the study."""
    people, measurements = len(ratings.participants), len(ratings.textures) * len(ratings.models)
    first = 2 if people < 4 else 4
    rows = []
    for count in range(first, min(max(people, first), first + 200) + 1) if measurements > 1 else ():
        found = power(_MEDIUM_F, measurements, participants=count)
        keys = ("participants", "measurements", "effect_f", "alpha", "correlation", "epsilon", "power")
        rows.append(PowerRow(**{key: getattr(found, key) for key in keys}))  # type: ignore[typeddict-item]
    return rows


def _without_absent(result: AnalysisDict) -> AnalysisDict:
    """Return the analysis without results that are undefined."""
    for effect in result["anova_two_way"].values():
        effect["method"] = METHODS["anova_two_way"]
    empty = ("anova_two_way", "bands", "nemenyi")
    absent = [key for key, value in result.items() if value is None or (key in empty and not value)]
    for key in absent:
        del result[key]  # type: ignore[misc]
    return result
