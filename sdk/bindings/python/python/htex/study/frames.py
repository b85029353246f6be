"""Convert an analysis to data frames, which are also saved as its CSV tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from typing import Any

import pandas as pd

from .results import AnalysisDict

_EFFECTS = (
    "test texture effect statistic df1 df2 p p_gg p_hf eps_gg eps_hf partial_eta_squared kendall_w mauchly_w mauchly_p assumptions"
).split()
_PAIRS = (
    "texture a b mean_difference t df p p_bonferroni p_holm ci95_low ci95_high cohen_dz cohen_d_av hedges_g shapiro_p "
    "p_nemenyi assumptions"
).split()
_EQUIVALENCE = "texture a b bound p_tost ci90_low ci90_high equivalent wilcoxon_w wilcoxon_p".split()
_MEANS = "texture model count mean sd".split()
_BANDS = (
    "filters r2 adjusted_r2 cross_validated_r2 f df1 df2 p rmse aic bic within_f within_df1 within_df2 within_p"
).split()


def frames(result: AnalysisDict) -> dict[str, pd.DataFrame]:
    """Return all tables by name. Undefined values are NaN."""
    means = [*result["means"], *result["means_model"], *result.get("means_texture", [])]
    found = {
        "cell-means": pd.DataFrame(result["cell_means"], columns="participant texture model repetitions mean".split()),
        "means": _frame(means, _MEANS),
        "pairs": _frame(_pairs(result), _PAIRS),
        "equivalence": _frame(_equivalence(result), _EQUIVALENCE),
        "effects": _frame(_effects(result), _EFFECTS),
    }
    if "spectral_correlation" in result:
        correlation = result["spectral_correlation"]
        found["spectral-correlation"] = _frame([*correlation["means"], *correlation["means_model"]], _MEANS)
        found["bands"] = _frame(result.get("bands", []), _BANDS)
    return found


def _frame(rows: Iterable[Mapping[str, Any]], columns: list[str]) -> pd.DataFrame:
    return pd.DataFrame([_flat(row) for row in rows], columns=columns)


def _flat(row: Mapping[str, Any]) -> dict[str, Any]:
    """Return a result as column values. Intervals, degrees of freedom and sentences are spread over
    several columns.
    """
    flat: dict[str, Any] = {}
    for key, value in row.items():
        if key in ("ci95", "ci90"):
            flat[f"{key}_low"], flat[f"{key}_high"] = value
        elif key == "df" and isinstance(value, tuple):
            flat["df1"], flat["df2"] = value
        elif key == "within":
            flat.update({f"within_{name}": v for name, v in _flat(value).items()})
        else:
            flat[key] = "; ".join(value) if key == "assumptions" else value
    return flat


def _pairs(result: AnalysisDict) -> Iterable[dict[str, Any]]:
    overall = [*result["pairs_model"], *result.get("pairs_texture", [])]
    groups = [("", overall, result.get("nemenyi", []))]
    groups += [(t, pairs, result["nemenyi_by_texture"].get(t, [])) for t, pairs in result["pairs_by_texture"].items()]
    for texture, pairs, ranked in groups:
        p = {(pair["a"], pair["b"]): pair["p"] for pair in ranked}
        for pair in pairs:
            yield {"texture": texture, **pair, "p_nemenyi": p.get((pair["a"], pair["b"]))}


def _equivalence(result: AnalysisDict) -> Iterable[dict[str, Any]]:
    for texture, tested in {"": result["equivalence"], **result["equivalence_by_texture"]}.items():
        for pair in tested["pairs"]:
            yield {"texture": texture, "bound": tested["bound"], **pair}


def _effects(result: AnalysisDict) -> Iterable[dict[str, Any]]:
    for texture, effect, test in effects(result):
        yield {"test": "anova", "texture": texture, "effect": effect, "statistic": test["f"], **test}
    for texture, effect, test in ranks(result):
        numbers = {"statistic": test["chi2"], "df1": test["df"], "p": test["p"], "kendall_w": test["kendall_w"]}
        yield {"test": "friedman", "texture": texture, "effect": effect, **numbers}
    for effect, test in result.get("mixed_model", {}).get("effects", {}).items():
        yield {"test": "mixed model", "texture": "", "effect": effect, "statistic": test["f"], **test}


def effects(result: AnalysisDict) -> Iterable[tuple[str, str, Any]]:
    """Yield each ANOVA as a tuple of texture (empty for all textures together), effect and test."""
    for factor in ("model", "texture"):
        if f"anova_{factor}" in result:
            yield "", factor, result[f"anova_{factor}"]  # type: ignore[literal-required]
    for effect, test in result.get("anova_two_way", {}).items():
        if effect != "model":
            yield "", effect, test
    for texture, test in result["anova_by_texture"].items():
        yield texture, "model", test


def ranks(result: AnalysisDict) -> Iterable[tuple[str, str, Any]]:
    """Yield each of Friedman's tests as a tuple of texture (empty for all textures together),
    effect and test."""
    for key, factor in (("friedman", "model"), ("friedman_texture", "texture")):
        if key in result:
            yield "", factor, result[key]  # type: ignore[literal-required]
    for texture, test in result["friedman_by_texture"].items():
        yield texture, "model", test
