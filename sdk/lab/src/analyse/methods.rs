//! The method of each group of numbers, in words: test, correction, source.

use std::collections::BTreeMap;

pub(super) const ANOVA: &str = "Repeated-measures ANOVA on each participant's mean ratings, for one factor or two. p_gg and p_hf multiply both degrees of freedom by the \
epsilon of Greenhouse and Geisser (1959) or of Huynh and Feldt (1976). Sphericity by Mauchly (1940), p-value by two terms of Box's \
expansion: mauchly_p as pingouin 0.7 computes it, mauchly_p_r as R does. Effect size: partial eta squared. Agrees with pingouin 0.7.";
pub(super) const FRIEDMAN: &str = "Friedman's test (1937) on the ranks of mean ratings within participants, corrected for ties, p-value by chi-squared. Effect \
size: Kendall's W. Agrees with SciPy.";
pub(super) const NORMALITY: &str = "On z-scores (n - 1) of the mean ratings. Kolmogorov-Smirnov against the standard normal with the exact distribution of D, as the \
paper tested; its p-value is too large, because the normal is fitted to the same values. Lilliefors (1967) corrects for that, p-value by Dallal and \
Wilkinson (1986) and Stephens (1974). Shapiro-Wilk by Royston (1995, AS R94). The first and the last agree with SciPy.";
pub(super) const CORRELATION: &str = "Pearson's correlation of the linear magnitudes of felt and recorded spectrum over 197 bins, 20 to 1000 Hz, for each \
participant, then averaged (paper, Figure 3A).";
const MEANS: &str = "Means over participants of each participant's mean over repetitions; standard deviation between participants with n - 1.";
const PAIRS: &str = "Paired t-tests, two-sided, on each participant's mean ratings. p_bonferroni and p_holm (Holm 1979) correct for all pairs of the list. ci95 is \
Student's interval of the mean difference, uncorrected. cohen_dz by the deviation of the differences, cohen_d_av by the root mean square of both deviations, \
hedges_g corrects d_av by 1 - 3 / (8 n - 9). Agrees with pingouin 0.7.";
const POWER: &str = "Power of an F-test of repeated measures within factors, one group, as G*Power 3.1: lambda = f^2 N m epsilon / (1 - rho), degrees of freedom \
(m - 1) epsilon and (N - 1) (m - 1) epsilon; for a medium effect (Cohen 1988: f = 0.25), not for the effect that was found.";
const BANDS: &str = "Least squares with an intercept. Predictors: the absolute difference of squared magnitudes, felt and recorded, at each 5 Hz bin, z-scored \
(n - 1) over the models within a participant and texture, then summed by triangles over log frequency from 20 to 1000 Hz that overlap by half (paper, \
Supplementary, Linear regression). Values: mean ratings, z-scored alike. rmse by residual degrees of freedom; AIC and BIC by the normal likelihood, \
with the intercept. Agrees with statsmodels. F and p take all values as independent, \
although z-scores within a participant and texture sum to 0: p is somewhat too small. cross_validated_r2 predicts each participant from the others, against their mean; r2 alone grows with every band.";

/// The method of every group, by its key in the analysis.
pub(super) fn all() -> BTreeMap<String, String> {
    let table = [
        ("anova_by_texture", ANOVA),
        ("anova_model", ANOVA),
        ("anova_two_way", ANOVA),
        ("bands", BANDS),
        (
            "best_bands",
            "The number of bands with the lowest BIC or AIC, or the highest cross-validated r2; bic_of_none is the BIC of the mean alone.",
        ),
        ("cell_means", MEANS),
        ("friedman", FRIEDMAN),
        ("friedman_by_texture", FRIEDMAN),
        ("means", MEANS),
        ("means_model", MEANS),
        ("normality", NORMALITY),
        ("normality_by_texture", NORMALITY),
        ("pairs_by_texture", PAIRS),
        ("pairs_model", PAIRS),
        ("power", POWER),
        ("spectral_correlation", CORRELATION),
    ];
    let owned = |(key, text): (&str, &str)| (key.to_owned(), text.to_owned());
    table.into_iter().map(owned).collect()
}
