"""The analysis as it is written to JSON: the types, and the JSON Schema generated from them."""

from __future__ import annotations

import inspect
from typing import Annotated, Any, TypedDict, get_args, get_origin, get_type_hints, is_typeddict

#: Marks entries that are absent if they are undefined. All other entries are always present.
MAYBE = object()


class Note(TypedDict, total=False):
    """A result that is missing, and why."""

    group: Annotated[str, "Key of the group that it belongs to, such as `anova_model` or `pairs_by_texture.vinyl`."]
    code: Annotated[str, "Stable code: `TOO_FEW_PARTICIPANTS`."]
    message: Annotated[str, "What is wrong, and what to do."]


class CellMean(TypedDict, total=False):
    """A participant's mean rating of a model in a texture."""

    participant: Annotated[str, "Participant."]
    texture: Annotated[str, "Texture."]
    model: Annotated[str, "Model."]
    repetitions: Annotated[int, "Number of repetitions."]
    mean: Annotated[float, "Their mean."]


class Mean(TypedDict, total=False):
    """Mean over participants."""

    texture: Annotated[str, "Texture; absent for a mean over all textures.", MAYBE]
    model: Annotated[str, "Model; absent for a mean over all models.", MAYBE]
    count: Annotated[int, "Number of participants."]
    mean: Annotated[float, "Mean."]
    sd: Annotated[float, "Standard deviation between participants (n - 1); 0 for one participant."]
    by_participant: Annotated[list[float], "Value of each participant that has one."]


class Normality(TypedDict, total=False):
    """Tests of normality."""

    count: Annotated[int, "Number of values."]
    on: Annotated[str, "The values tested."]
    ks_d: Annotated[float, "Kolmogorov and Smirnov's D.", MAYBE]
    ks_p: Annotated[float, "Its p-value, as if the normal had not been fitted.", MAYBE]
    lilliefors_d: Annotated[float, "Lilliefors' D.", MAYBE]
    lilliefors_p: Annotated[float, "Its p-value.", MAYBE]
    shapiro_w: Annotated[float, "Shapiro and Wilk's W.", MAYBE]
    shapiro_p: Annotated[float, "Its p-value.", MAYBE]
    method: Annotated[str, "Tests and sources."]


class AnovaResult(TypedDict, total=False):
    """A repeated-measures ANOVA of one effect."""

    f: Annotated[float, "F ratio."]
    df: Annotated[tuple[float, float], "Degrees of freedom of effect and error, uncorrected."]
    p: Annotated[float, "p-value under sphericity."]
    p_gg: Annotated[float, "p-value by Greenhouse and Geisser's correction."]
    p_hf: Annotated[float, "p-value by Huynh and Feldt's correction."]
    eps_gg: Annotated[float, "Greenhouse and Geisser's epsilon."]
    eps_hf: Annotated[float, "Huynh and Feldt's epsilon."]
    partial_eta_squared: Annotated[float, "Partial eta squared."]
    mauchly_w: Annotated[float, "Mauchly's W, where it is defined.", MAYBE]
    mauchly_chi2: Annotated[float, "Its statistic.", MAYBE]
    mauchly_p: Annotated[float, "Its p-value.", MAYBE]
    mauchly_p_r: Annotated[float, "The p-value as R computes it; `mauchly_p` is pingouin's.", MAYBE]
    assumptions: Annotated[list[str], "Assumptions that fail, and what to read in place of p.", MAYBE]
    method: Annotated[str, "Test, correction and source."]


class FriedmanResult(TypedDict, total=False):
    """Friedman's test."""

    chi2: Annotated[float, "The statistic, corrected for ties."]
    df: Annotated[float, "Degrees of freedom."]
    p: Annotated[float, "p-value."]
    kendall_w: Annotated[float, "Kendall's W, 0 to 1."]
    method: Annotated[str, "Test and source."]


class RankPair(TypedDict, total=False):
    """Nemenyi's test of two conditions."""

    a: Annotated[str, "First condition."]
    b: Annotated[str, "Second condition."]
    p: Annotated[float, "p-value, corrected for all pairs."]


class PairResult(TypedDict, total=False):
    """A paired comparison of two models. It has only the mean if all differences are equal."""

    a: Annotated[str, "First model."]
    b: Annotated[str, "Second model."]
    mean_difference: Annotated[float, "Mean of the differences, `a` less `b`."]
    t: Annotated[float, "Student's t.", MAYBE]
    df: Annotated[int, "Degrees of freedom.", MAYBE]
    p: Annotated[float, "Two-sided p-value, uncorrected.", MAYBE]
    p_bonferroni: Annotated[float, "p-value by Bonferroni's correction for all pairs of the list.", MAYBE]
    p_holm: Annotated[float, "p-value by Holm's correction for all pairs of the list.", MAYBE]
    ci95: Annotated[tuple[float, float], "Confidence interval of the mean difference, 95 %, uncorrected.", MAYBE]
    cohen_dz: Annotated[float, "Cohen's d_z, by the deviation of the differences.", MAYBE]
    cohen_d_av: Annotated[float, "Cohen's d_av, by the mean deviation of both.", MAYBE]
    hedges_g: Annotated[float, "Hedges' g of d_av.", MAYBE]
    shapiro_p: Annotated[float, "Shapiro and Wilk's p-value of the differences.", MAYBE]
    assumptions: Annotated[list[str], "Assumptions that fail, and what to read in place of p.", MAYBE]


class EquivalencePair(TypedDict, total=False):
    """Whether two models are rated equally within the bound."""

    a: Annotated[str, "First model."]
    b: Annotated[str, "Second model."]
    p_tost: Annotated[float, "Larger p-value of the two one-sided tests; below 0.05 the models are equivalent."]
    ci90: Annotated[tuple[float, float], "Confidence interval of the mean difference, 90 %."]
    equivalent: Annotated[bool, "Whether the interval lies within the bound."]
    wilcoxon_w: Annotated[float, "Wilcoxon's W of the same differences."]
    wilcoxon_p: Annotated[float, "Its two-sided p-value, uncorrected."]


class Equivalence(TypedDict, total=False):
    """Two one-sided tests of all pairs."""

    bound: Annotated[float, "Largest difference of ratings that does not matter."]
    pairs: Annotated[list[EquivalencePair], "Every two models whose test is defined."]


class MixedEffect(TypedDict, total=False):
    """A fixed effect of the mixed model."""

    f: Annotated[float, "Wald's F ratio."]
    df: Annotated[tuple[float, float], "Degrees of freedom, by containment."]
    p: Annotated[float, "p-value."]


class MixedModel(TypedDict, total=False):
    """A linear mixed model of all cell means, also of participants with missing ratings."""

    effects: Annotated[dict[str, MixedEffect], "Fixed effects, by name."]
    variances: Annotated[dict[str, float], "Variances of the random effects, and of what is left (`residual`)."]
    means: Annotated[dict[str, float], "Estimated mean of each level of the first factor of comparison."]
    method: Annotated[str, "Model and estimator."]


class Icc(TypedDict, total=False):
    """Intraclass correlations."""

    targets: Annotated[int, "Number of things rated."]
    raters: Annotated[int, "Number of ratings of each."]
    icc2: Annotated[float, "Agreement of single ratings, ICC(A,1)."]
    icc2k: Annotated[float, "Agreement of their means, ICC(A,k)."]
    icc3: Annotated[float, "Consistency of single ratings, ICC(C,1)."]
    icc3k: Annotated[float, "Consistency of their means, ICC(C,k); Cronbach's alpha."]
    ci95: Annotated[tuple[float, float], "Confidence interval of icc3, 95 %."]
    f: Annotated[float, "F ratio of the things rated."]
    df: Annotated[tuple[float, float], "Its degrees of freedom."]
    p: Annotated[float, "Its p-value."]


class Reliability(TypedDict, total=False):
    """How well repeated ratings would agree."""

    participants: Annotated[Icc, "Conditions rated by participants.", MAYBE]
    repetitions: Annotated[Icc, "Cells rated in each repetition.", MAYBE]
    method: Annotated[str, "Definitions and sources."]


class PowerRow(TypedDict, total=False):
    """Power with a number of participants."""

    participants: Annotated[int, "Number of participants."]
    measurements: Annotated[int, "Measurements of each."]
    effect_f: Annotated[float, "Cohen's f."]
    alpha: Annotated[float, "Significance level."]
    correlation: Annotated[float, "Correlation among measurements."]
    epsilon: Annotated[float, "Correction for nonsphericity."]
    power: Annotated[float, "Probability of finding the effect."]


class Correlation(TypedDict, total=False):
    """Correlation of one felt spectrum."""

    participant: Annotated[str, "Participant."]
    texture: Annotated[str, "Texture."]
    model: Annotated[str, "Model."]
    correlation: Annotated[float, "Pearson's correlation; absent if a spectrum is constant.", MAYBE]


class SpectralCorrelation(TypedDict, total=False):
    """Correlation of felt spectra with their texture's recorded spectrum."""

    cells: Annotated[list[Correlation], "Of each participant, texture and model."]
    means: Annotated[list[Mean], "Means over participants of each model in each texture."]
    means_model: Annotated[list[Mean], "Means over participants of each model, averaged over textures."]
    method: Annotated[str, "Definition and source."]


class Within(TypedDict, total=False):
    """The F-test with the degrees of freedom that remain after z-scoring within cells."""

    f: Annotated[float, "F ratio of all bands."]
    df: Annotated[tuple[int, int], "Its degrees of freedom."]
    p: Annotated[float, "Its p-value."]


class BandResult(TypedDict, total=False):
    """A regression of ratings on energy differences in bands."""

    filters: Annotated[int, "Number of bands."]
    r2: Annotated[float, "Explained part of the variance."]
    adjusted_r2: Annotated[float, "The same, adjusted for the number of bands."]
    cross_validated_r2: Annotated[
        float, "r2 of predictions for participants that were left out; absent if it is not defined.", MAYBE
    ]
    f: Annotated[float, "F ratio of all bands, as if values were independent; `within` counts what z-scores take."]
    df: Annotated[tuple[float, float], "Its degrees of freedom."]
    p: Annotated[float, "Its p-value: too small, since z-scores within a cell are not independent."]
    within: Annotated[Within, "The test to read; absent where cells leave no degrees of freedom.", MAYBE]
    rmse: Annotated[float, "Root of the residual sum of squares by residual degrees of freedom, in z-scores."]
    aic: Annotated[float, "Akaike's information criterion."]
    bic: Annotated[float, "Schwarz's (Bayesian) information criterion."]
    coefficients: Annotated[list[float], "Intercept, then a coefficient for each band."]
    dependent: Annotated[
        list[int], "Bands, from 1, that do not vary or depend on those before them; their coefficient is 0.", MAYBE
    ]
    edges_hz: Annotated[
        list[float], "Frequencies, hertz: band i rises from the i-th to the next and falls to the one after it."
    ]


class BestBanks(TypedDict, total=False):
    """The numbers of bands that the criteria prefer."""

    bic: Annotated[int, "Lowest BIC."]
    aic: Annotated[int, "Lowest AIC."]
    cross_validated_r2: Annotated[int, "Highest cross-validated r2; absent if it is not defined.", MAYBE]
    bic_of_none: Annotated[
        float, "BIC of no bands at all: the mean alone. Where it is the lowest, the bands explain nothing."
    ]
    better_than_none: Annotated[bool, "Whether the best bank has a lower BIC than no bands at all."]


class AnalysisDict(TypedDict, total=False):
    """The analysis of a study. `notes` say why a result is missing. Every number is finite."""

    analysis: Annotated[str, "`htex-study-analysis/1`."]
    program: Annotated[str, "Program and version that analysed."]
    participants: Annotated[list[str], "Participants, in the order of every list."]
    simulated: Annotated[list[str], "Those of them that are simulated."]
    textures: Annotated[list[str], "Textures, in the order of every list."]
    models: Annotated[list[str], "Models, in the order of every list."]
    repetitions: Annotated[int, "Largest number of repetitions of a condition."]
    methods: Annotated[
        dict[str, str], "The method of each group of numbers: test, correction and source, by the group's key."
    ]
    notes: Annotated[list[Note], "What is not computed or needs care, and why."]
    cell_means: Annotated[list[CellMean], "Mean rating of each participant, texture and model."]
    means_model: Annotated[list[Mean], "Ratings of each model, averaged over textures."]
    means_texture: Annotated[list[Mean], "Ratings of each texture, averaged over models.", MAYBE]
    means: Annotated[list[Mean], "Ratings of each model in each texture."]
    pairs_model: Annotated[list[PairResult], "Comparisons of models by ratings averaged over textures."]
    pairs_texture: Annotated[list[PairResult], "Comparisons of textures, in a study of one model.", MAYBE]
    pairs_by_texture: Annotated[dict[str, list[PairResult]], "Comparisons of models in each texture."]
    equivalence: Annotated[
        Equivalence, "Whether models, or textures in a study of one model, are as good as each other."
    ]
    equivalence_by_texture: Annotated[
        dict[str, Equivalence], "Whether models are as good as each other in each texture."
    ]
    normality: Annotated[
        Normality, "Normality of the mean ratings over all conditions, as the paper tested; an effect makes it fail."
    ]
    normality_by_texture: Annotated[dict[str, Normality], "Normality of the mean ratings of each texture."]
    normality_of_residuals: Annotated[Normality, "Normality of what an ANOVA assumes to be normal."]
    normality_of_residuals_by_texture: Annotated[dict[str, Normality], "The same in each texture."]
    anova_model: Annotated[AnovaResult, "Effect of the model on ratings averaged over textures.", MAYBE]
    anova_texture: Annotated[AnovaResult, "Effect of the texture, in a study of one model.", MAYBE]
    anova_by_texture: Annotated[dict[str, AnovaResult], "Effect of the model in each texture."]
    anova_two_way: Annotated[dict[str, AnovaResult], "Effects of `texture`, `model` and `texture * model`.", MAYBE]
    friedman: Annotated[FriedmanResult, "Effect of the model on ranks of ratings averaged over textures.", MAYBE]
    friedman_texture: Annotated[FriedmanResult, "Effect of the texture on ranks, in a study of one model.", MAYBE]
    friedman_by_texture: Annotated[dict[str, FriedmanResult], "Effect of the model on ranks in each texture."]
    nemenyi: Annotated[list[RankPair], "Nemenyi's test after Friedman's, of models or of textures.", MAYBE]
    nemenyi_by_texture: Annotated[dict[str, list[RankPair]], "Nemenyi's test of models in each texture."]
    mixed_model: Annotated[MixedModel, "A model of all ratings, also of incomplete participants.", MAYBE]
    reliability: Annotated[Reliability, "Whether participants and repetitions agree."]
    power: Annotated[list[PowerRow], "Power of a study of this shape for a medium effect."]
    spectral_correlation: Annotated[
        SpectralCorrelation, "Correlation of felt spectra with recorded ones, if spectra are given.", MAYBE
    ]
    bands: Annotated[
        list[BandResult],
        "Regressions of ratings on differences of spectral energy in 1 to 20 bands, if spectra are given.",
        MAYBE,
    ]
    best_bands: Annotated[BestBanks, "The number of bands that each criterion prefers, if spectra are given.", MAYBE]


def schema() -> dict[str, Any]:
    """Return the JSON Schema of analyses: ``spec/schemas/study-analysis-1.json``."""
    definitions: dict[str, Any] = {}
    root = _object(AnalysisDict, definitions)
    return {
        **root,
        "$defs": definitions,
        "$id": "https://htex.org/schemas/study-analysis-1.json",
        "$schema": "https://json-schema.org/draft/2020-12/schema",
        "title": "Analysis of a rating study",
    }


def _object(of: type, definitions: dict[str, Any]) -> dict[str, Any]:
    properties, required = {}, []
    for name, hint in get_type_hints(of, include_extras=True).items():
        kind, description, *marks = get_args(hint)
        properties[name] = {**_type(kind, definitions), "description": description}
        if MAYBE not in marks:
            required.append(name)
    return {"type": "object", "description": inspect.getdoc(of), "properties": properties, "required": required}


def _type(kind: Any, definitions: dict[str, Any]) -> dict[str, Any]:
    if is_typeddict(kind):
        if kind.__name__ not in definitions:
            definitions[kind.__name__] = {}
            definitions[kind.__name__] = _object(kind, definitions)
        return {"$ref": f"#/$defs/{kind.__name__}"}
    arguments = get_args(kind)
    if get_origin(kind) is list:
        return {"type": "array", "items": _type(arguments[0], definitions)}
    if get_origin(kind) is tuple:
        return {"type": "array", "items": _type(arguments[0], definitions), "minItems": 2, "maxItems": 2}
    if get_origin(kind) is dict:
        return {"type": "object", "additionalProperties": _type(arguments[1], definitions)}
    return dict(_PLAIN[kind])


_PLAIN: dict[type, dict[str, Any]] = {
    bool: {"type": "boolean"},
    float: {"type": "number"},
    int: {"type": "integer", "minimum": 0},
    str: {"type": "string"},
}
