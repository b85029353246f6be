"""Describe the method behind each group of numbers: the test, its correction and its source."""

from __future__ import annotations

from .planning import METHOD as _POWER

_MEANS = "Means over participants of each participant's mean over repetitions; standard deviation between participants with n - 1."
_PAIRS = (
    "Paired t-tests, two-sided, on each participant's mean ratings. p_bonferroni and p_holm (Holm 1979) correct for all pairs "
    "of the list. ci95 is Student's interval of the mean difference, uncorrected. cohen_dz by the deviation of the "
    "differences, cohen_d_av by the root mean square of both deviations, hedges_g corrects d_av by 1 - 3 / (8 n - 9). "
    "shapiro_p tests whether the differences are normal. By SciPy; agrees with pingouin 0.7."
)
_EQUIVALENCE = (
    "Two one-sided paired t-tests (Schuirmann 1987) of differences within the bound: p_tost is the larger p-value, and the 90 % "
    "interval lies within the bound where it is below 0.05. A large p-value of another test does not say that two conditions "
    "are as good as each other; this one does. State the bound before looking at the ratings. Beside it Wilcoxon's signed-rank "
    "test of the same differences, by SciPy: exact without ties, else by the normal."
)
_ANOVA = (
    "Repeated-measures ANOVA on each participant's mean ratings, for one factor or two. p_gg and p_hf multiply both degrees of "
    "freedom by the epsilon of Greenhouse and Geisser (1959) or of Huynh and Feldt (1976). Sphericity by Mauchly (1940), p-value "
    "by two terms of Box's expansion: mauchly_p as pingouin 0.7 computes it, mauchly_p_r as R does. Effect size: partial eta "
    "squared. Agrees with pingouin 0.7."
)
_FRIEDMAN = (
    "Friedman's test (1937) on the ranks of mean ratings within participants, corrected for ties, p-value by chi-squared. Effect "
    "size: Kendall's W. By SciPy."
)
_NEMENYI = (
    "Nemenyi's test (1963) of every two conditions by the mean ranks of Friedman's test, p-value by the studentised range: "
    "corrected for all pairs. By scikit-posthocs."
)
_NORMALITY_TESTS = (
    "Kolmogorov-Smirnov against the standard normal with the exact distribution of D, as the paper tested; its p-value is too "
    "large, because the normal is fitted to the same values. Lilliefors (1967) corrects for that, p-value by the tables of "
    "statsmodels, between 0.001 and 0.99. Shapiro-Wilk by Royston (1995, AS R94). By SciPy and statsmodels."
)
_NORMALITY = (
    "On z-scores (n - 1) of the mean ratings of all conditions: they are not normal where conditions differ, whatever the "
    "ratings; read normality_of_residuals. " + _NORMALITY_TESTS
)
_RESIDUALS = (
    "On z-scores (n - 1) of what remains of mean ratings when the effects of participant and condition are taken away, which is what "
    "an ANOVA takes as normal. " + _NORMALITY_TESTS
)
_MIXED = (
    "Linear mixed model of all cell means, by restricted maximum likelihood: fixed effects of texture, model and their "
    "interaction; random effects of the participant, and of the participant's taste in textures and in models where there are "
    "both. It uses participants who have not rated everything. Wald's F-tests, whose errors have the degrees of freedom of the "
    "effect's interaction with participants, which equal the ANOVA's if the ratings are complete. By statsmodels."
)
_RELIABILITY = (
    "Intraclass correlations by two-way mean squares (McGraw and Wong 1996): icc2 and icc2k of agreement with random raters, "
    "icc3 and icc3k of consistency. Of participants: each condition's mean ratings, by those who rated all. Of repetitions: each "
    "participant's ratings of a condition, by repetition. Agrees with pingouin 0.7."
)
_CORRELATION = (
    "Pearson's correlation of the linear magnitudes of felt and recorded spectrum over 197 bins, 20 to 1000 Hz, for each "
    "participant, then averaged (paper, Figure 3A)."
)
_BANDS = (
    "Least squares with an intercept. Predictors: the absolute difference of squared magnitudes, felt and recorded, at each 5 Hz "
    "bin, z-scored (n - 1) over the models within a participant and texture (over textures within a participant in a study of "
    "one model), then summed by triangles over log frequency from 20 to 1000 Hz that overlap by half (paper, Supplementary, "
    "Linear regression). Values: mean ratings, z-scored alike. within is the F-test to read: z-scores sum to 0 within each cell, "
    "so that the residual has sum of (conditions of a cell - 1) - bands degrees of freedom; f, df and p take all values as "
    "independent, and reject too often. rmse by residual degrees of freedom of df; AIC and BIC by the normal likelihood, with "
    "the intercept. By statsmodels. cross_validated_r2 predicts each participant from the others, against their mean; r2 alone "
    "grows with every band."
)
_BEST = "The number of bands with the lowest BIC or AIC, or the highest cross-validated r2; bic_of_none is the BIC of the mean alone."

#: The methods, by the key of their group in the analysis.
METHODS = {
    "anova_by_texture": _ANOVA,
    "anova_model": _ANOVA,
    "anova_texture": _ANOVA,
    "anova_two_way": _ANOVA,
    "bands": _BANDS,
    "best_bands": _BEST,
    "cell_means": _MEANS,
    "equivalence": _EQUIVALENCE,
    "equivalence_by_texture": _EQUIVALENCE,
    "friedman": _FRIEDMAN,
    "friedman_by_texture": _FRIEDMAN,
    "friedman_texture": _FRIEDMAN,
    "means": _MEANS,
    "means_model": _MEANS,
    "means_texture": _MEANS,
    "mixed_model": _MIXED,
    "nemenyi": _NEMENYI,
    "nemenyi_by_texture": _NEMENYI,
    "normality": _NORMALITY,
    "normality_by_texture": _NORMALITY,
    "normality_of_residuals": _RESIDUALS,
    "normality_of_residuals_by_texture": _RESIDUALS,
    "pairs_by_texture": _PAIRS,
    "pairs_model": _PAIRS,
    "pairs_texture": _PAIRS,
    "power": _POWER + "; for a medium effect (Cohen 1988: f = 0.25), not for the effect that was found.",
    "reliability": _RELIABILITY,
    "spectral_correlation": _CORRELATION,
}
