"""Write an analysis as text: tables and sentences, with the simplest comparisons first, then the
methods and the notes.
"""

from __future__ import annotations

from collections import defaultdict
from collections.abc import Iterable, Mapping
from typing import Any

from .frames import effects, ranks
from .results import AnalysisDict

Table = list[list[str]]

PAIR_HEADS = ["difference", "t", "df", "p", "p Bonferroni", "p Holm", "95 % interval", "d_z", "g"]
EQUIVALENCE_HEADS = ["p TOST", "90 % interval", "equivalent", "Wilcoxon W", "p Wilcoxon", "p Nemenyi"]
BAND_HEADS = ["r2", "adjusted", "cross-validated", "F within", "p within", "RMSE", "AIC", "BIC"]
ICC_HEADS = ["rated", "ratings", "ICC(A,1)", "ICC(A,k)", "ICC(C,1)", "95 % interval", "ICC(C,k)", "p"]


def to_text(result: AnalysisDict) -> str:
    """Return the whole analysis as text."""
    parts = [heading(result) + "\n"]
    for title, body in _sections(result):
        if body:
            parts.append(f"\n{title}\n{body}")
    return "".join(parts)


def _sections(result: AnalysisDict) -> Iterable[tuple[str, str]]:
    names, by_texture, overall = level_names(result)
    said = f"averaged over {'textures' if 'model' in overall else 'models'}, "
    said = "" if len(result["textures"]) == 1 or overall == "pairs_texture" else said
    yield (
        "Ratings: mean (standard deviation between participants)",
        aligned(means_table(result, result["means"], result["means_model"])),
    )
    yield f"{names} compared, {said}paired t-tests", aligned(pair_table(result[overall])) + _significant(result)  # type: ignore[literal-required]
    bound = result["equivalence"]["bound"]
    yield f"{names} as good as each other: within {bound:g} of the scale", aligned(equivalence_table(result))
    yield (
        "Effects (repeated-measures ANOVA)",
        _lines(f"{effect_name(t, e)}: {anova(test)}" for t, e, test in effects(result)),
    )
    yield "Effects on ranks", _lines(f"{effect_name(t, e)}: {friedman(test)}" for t, e, test in ranks(result))
    yield "Normality of residuals", _lines(normalities(result))
    yield "Effects by a mixed model of all ratings", _lines(mixed(result))
    yield "Reliability", aligned(reliability_table(result))
    if "spectral_correlation" in result:
        found = result["spectral_correlation"]
        title = "Spectral correlation of felt with recorded: mean (standard deviation)"
        yield title, aligned(means_table(result, found["means"], found["means_model"]))
    if "best_bands" in result:
        table = aligned(band_table(result)) + _lines([best_sentence(result)])
        yield "Ratings by differences of energy in bands", table
    yield "Methods", _lines(f"{', '.join(keys)}: {text}" for text, keys in methods(result).items())
    yield "Notes", _lines(f"{note['code']} {note['group']}: {note['message']}" for note in result["notes"])


def heading(result: AnalysisDict) -> str:
    """Return a heading with the numbers of participants, textures, models and repetitions."""
    simulated = f" ({len(result['simulated'])} SIMULATED)" if result["simulated"] else ""
    counts = f"{len(result['textures'])} textures, {len(result['models'])} models, {result['repetitions']} repetitions"
    return f"{len(result['participants'])} participants{simulated}, {counts}"


def level_names(result: AnalysisDict) -> tuple[str, list[str], str]:
    """Return the name of the study's first factor, its levels, and the key of its comparisons."""
    if "pairs_texture" in result:
        return "Textures", result["textures"], "pairs_texture"
    return "Models", result["models"], "pairs_model"


def methods(result: AnalysisDict) -> dict[str, list[str]]:
    """Return the texts of the methods that were used, each with the groups of results to which it
    applies."""
    groups: dict[str, list[str]] = defaultdict(list)
    for key, text in result["methods"].items():
        if result.get(key):
            groups[text].append(key)
    return groups


def p_value(value: float) -> str:
    """Return a p-value with three decimals, or ``< 0.001``."""
    return "p < 0.001" if value < 0.001 else f"p = {value:.3f}"


def number_p(value: float | None) -> str:
    """Return a p-value for a table, with three digits."""
    if value is None:
        return ""
    return f"{value:.1e}" if value < 0.001 else f"{value:.3f}"


def stars(value: float) -> str:
    """Return the stars that mark the significance of a p-value."""
    return "*" * sum(value < level for level in (0.05, 0.01, 0.001))


def effect_name(texture: str, effect: str) -> str:
    """Return the name of an effect, and the texture it belongs to."""
    return f"{effect} in {texture}" if texture else effect


def anova(test: Any) -> str:
    """Describe an ANOVA in a sentence, with the assumptions that fail."""
    mauchly = f"; Mauchly W = {test['mauchly_w']:.3f}, {p_value(test['mauchly_p'])}" if "mauchly_w" in test else ""
    return (
        f"F({test['df'][0]:g}, {test['df'][1]:g}) = {test['f']:.3f}, {p_value(test['p'])}; Greenhouse–Geisser "
        f"{p_value(test['p_gg'])} (ε = {test['eps_gg']:.3f}), Huynh–Feldt {p_value(test['p_hf'])} (ε = {test['eps_hf']:.3f}); "
        f"partial η² = {test['partial_eta_squared']:.3f}{mauchly}{failed(test)}"
    )


def failed(test: Mapping[str, Any]) -> str:
    """Return the assumptions of a test that are violated."""
    return "".join(f"; BUT {sentence}" for sentence in test.get("assumptions", []))


def friedman(test: Any) -> str:
    """Describe Friedman's test in a sentence."""
    return (
        f"Friedman χ²({test['df']:g}) = {test['chi2']:.3f}, {p_value(test['p'])}; Kendall's W = {test['kendall_w']:.3f}"
    )


def normalities(result: AnalysisDict) -> list[str]:
    """Describe the normality of the residuals, over all textures and in each texture."""
    overall = [f"all textures: {normality(result['normality_of_residuals'])}"]
    each = result["normality_of_residuals_by_texture"].items()
    return overall + [f"{texture}: {normality(test)}" for texture, test in each]


def normality(test: Any) -> str:
    """Describe the tests of normality that the data allow, in a sentence."""
    names = {"ks_d": "Kolmogorov–Smirnov D", "lilliefors_d": "Lilliefors D", "shapiro_w": "Shapiro–Wilk W"}
    found = [f"{name} = {test[key]:.4f}, {p_value(test[key[:-1] + 'p'])}" for key, name in names.items() if key in test]
    return "; ".join(found) or "not defined"


def mixed(result: AnalysisDict) -> list[str]:
    """Describe the effects of the mixed model, and its variances."""
    if "mixed_model" not in result:
        return []
    model = result["mixed_model"]
    lines = [
        f"{name}: F({test['df'][0]:g}, {test['df'][1]:g}) = {test['f']:.3f}, {p_value(test['p'])}"
        for name, test in model["effects"].items()
    ]
    return [*lines, "variances: " + ", ".join(f"{name} {value:.4f}" for name, value in model["variances"].items())]


def best_sentence(result: AnalysisDict) -> str:
    """State in a sentence which numbers of bands the criteria prefer."""
    best = result["best_bands"]
    checked = f", {best['cross_validated_r2']} by cross-validated r2" if "cross_validated_r2" in best else ""
    none = "" if best["better_than_none"] else "; but the mean alone has a lower BIC, so that the bands explain nothing"
    return f"best number of bands: {best['bic']} by BIC, {best['aic']} by AIC{checked}{none}"


def means_table(result: AnalysisDict, by_texture: Any, overall: Any, form: str = "{mean:.3f} ({sd:.3f})") -> Table:
    """Return the means of each model, in each texture and over all textures."""
    cells = {(mean.get("texture"), mean["model"]): form.format(**mean) for mean in [*by_texture, *overall]}
    rows = [["", *result["models"]]]
    for texture in [*result["textures"], None]:
        rows.append([texture or "all textures", *(cells.get((texture, model), "") for model in result["models"])])
    return rows


def pair_table(pairs: Any) -> Table:
    """Return the paired comparisons as a table. The end of a line names violated assumptions."""
    rows = [["a", "b", *PAIR_HEADS]]
    for pair in pairs:
        row = [pair["a"], pair["b"], f"{pair['mean_difference']:.3f}"]
        if "t" in pair:
            low, high = pair["ci95"]
            row += [f"{pair['t']:.3f}", str(pair["df"]), *(number_p(pair[k]) for k in ("p", "p_bonferroni", "p_holm"))]
            row += [f"{low:.3f} to {high:.3f}", f"{pair['cohen_dz']:.2f}", _maybe(pair.get("hedges_g"), ".2f")]
            row += [failed(pair).removeprefix("; ")] * ("assumptions" in pair)
        else:
            row.append("not defined")
        rows.append(row)
    return rows


def equivalence_table(result: AnalysisDict) -> Table:
    """Return a table of the pairs: whether they are equivalent, and the results of the rank
    tests."""
    ranked = {(pair["a"], pair["b"]): pair["p"] for pair in result.get("nemenyi", [])}
    rows = [["a", "b", *EQUIVALENCE_HEADS]]
    for pair in result["equivalence"]["pairs"]:
        low, high = pair["ci90"]
        row = [
            pair["a"],
            pair["b"],
            number_p(pair["p_tost"]),
            f"{low:.3f} to {high:.3f}",
            "yes" if pair["equivalent"] else "no",
        ]
        row += [f"{pair['wilcoxon_w']:g}", number_p(pair["wilcoxon_p"]), number_p(ranked.get((pair["a"], pair["b"])))]
        rows.append(row)
    return rows if len(rows) > 1 else []


def reliability_table(result: AnalysisDict) -> Table:
    """Return the intraclass correlations as a table."""
    rows = [["of", *ICC_HEADS]]
    for of in ("participants", "repetitions"):
        if of in result["reliability"]:
            icc = result["reliability"][of]
            low, high = icc["ci95"]
            numbers = [f"{icc[key]:.3f}" for key in ("icc2", "icc2k", "icc3")]
            rows.append([of, str(icc["targets"]), str(icc["raters"]), *numbers, f"{low:.3f} to {high:.3f}"])
            rows[-1] += [f"{icc['icc3k']:.3f}", number_p(icc["p"])]
    return rows if len(rows) > 1 else []


def band_table(result: AnalysisDict) -> Table:
    """Return the regressions as a table with a row for each number of bands. It includes the tests
    that account for z-scoring."""
    rows = [["bands", *BAND_HEADS]]
    for band in result["bands"]:
        within: Any = band.get("within", {})
        row = [str(band["filters"]), f"{band['r2']:.4f}", f"{band['adjusted_r2']:.4f}"]
        row += [
            _maybe(band.get("cross_validated_r2"), ".4f"),
            _maybe(within.get("f"), ".2f"),
            number_p(within.get("p")),
        ]
        rows.append([*row, f"{band['rmse']:.4f}", f"{band['aic']:.1f}", f"{band['bic']:.1f}"])
    return rows


def _maybe(value: float | None, form: str) -> str:
    return "" if value is None else format(value, form)


def _significant(result: AnalysisDict) -> str:
    """Return the pairs that differ in each texture."""
    lines = []
    for texture, pairs in result["pairs_by_texture"].items() if len(result["textures"]) > 1 else ():
        found = [f"{pair['a']}–{pair['b']}" for pair in pairs if pair.get("p_holm", 1) < 0.05]
        lines.append(f"in {texture}, p Holm < 0.05: {', '.join(found) or 'none'}")
    return _lines(lines)


def _lines(lines: Iterable[str]) -> str:
    return "".join(f"  {line}\n" for line in lines)


def aligned(rows: Table) -> str:
    """Align columns: the first to the left, all others to the right."""
    count = max((len(row) for row in rows), default=0)
    lengths = [[len(row[i]) for row in rows if i < len(row) and not row[i].startswith("BUT")] for i in range(count)]
    widths = [max(column, default=0) for column in lengths]

    def cell(index: int, text: str) -> str:
        return text.ljust(widths[index]) if index == 0 or text.startswith("BUT") else text.rjust(widths[index])

    return _lines("  ".join(cell(i, text) for i, text in enumerate(row)).rstrip() for row in rows)
