//! The results of single tests and regressions, as they are written to JSON.

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::analysis::Mean;

/// Tests of normality.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize, JsonSchema)]
pub struct Normality {
    /// Number of values.
    pub count: usize,
    /// The values tested.
    pub on: String,
    /// Kolmogorov and Smirnov's D.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ks_d: Option<f64>,
    /// Its p-value, as if the normal had not been fitted.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub ks_p: Option<f64>,
    /// Lilliefors' D.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lilliefors_d: Option<f64>,
    /// Its p-value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lilliefors_p: Option<f64>,
    /// Shapiro and Wilk's W.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shapiro_w: Option<f64>,
    /// Its p-value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shapiro_p: Option<f64>,
    /// Tests and sources.
    pub method: String,
}

/// A repeated-measures ANOVA of one effect.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct AnovaResult {
    /// F ratio.
    pub f: f64,
    /// Degrees of freedom of effect and error, uncorrected.
    pub df: [f64; 2],
    /// p-value under sphericity.
    pub p: f64,
    /// p-value by Greenhouse and Geisser's correction.
    pub p_gg: f64,
    /// p-value by Huynh and Feldt's correction.
    pub p_hf: f64,
    /// Greenhouse and Geisser's epsilon.
    pub eps_gg: f64,
    /// Huynh and Feldt's epsilon.
    pub eps_hf: f64,
    /// Partial eta squared.
    pub partial_eta_squared: f64,
    /// Mauchly's W, where it is defined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mauchly_w: Option<f64>,
    /// Its statistic.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mauchly_chi2: Option<f64>,
    /// Its p-value.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mauchly_p: Option<f64>,
    /// The p-value as R computes it; `mauchly_p` is pingouin's.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub mauchly_p_r: Option<f64>,
    /// Test, correction and source.
    pub method: String,
}

/// Friedman's test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct FriedmanResult {
    /// The statistic, corrected for ties.
    pub chi2: f64,
    /// Degrees of freedom.
    pub df: f64,
    /// p-value.
    pub p: f64,
    /// Kendall's W, 0 to 1.
    pub kendall_w: f64,
    /// Test and source.
    pub method: String,
}

/// A paired comparison of two models. Where the differences of all participants are equal there is only their mean.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PairResult {
    /// First model.
    pub a: String,
    /// Second model.
    pub b: String,
    /// Mean of the differences, `a` less `b`.
    pub mean_difference: f64,
    /// The test, where it is defined.
    #[serde(default, flatten, skip_serializing_if = "Option::is_none")]
    pub test: Option<PairTest>,
}

/// The numbers of a paired t-test.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PairTest {
    /// Student's t.
    pub t: f64,
    /// Degrees of freedom.
    pub df: usize,
    /// Two-sided p-value, uncorrected.
    pub p: f64,
    /// p-value by Bonferroni's correction for all pairs of the list.
    pub p_bonferroni: f64,
    /// p-value by Holm's correction for all pairs of the list.
    pub p_holm: f64,
    /// Confidence interval of the mean difference, 95 %, uncorrected.
    pub ci95: [f64; 2],
    /// Cohen's d_z, by the deviation of the differences.
    pub cohen_dz: f64,
    /// Cohen's d_av, by the mean deviation of both.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cohen_d_av: Option<f64>,
    /// Hedges' g of d_av.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub hedges_g: Option<f64>,
}

/// Power with a number of participants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct PowerRow {
    /// Number of participants.
    pub participants: usize,
    /// Measurements of each.
    pub measurements: usize,
    /// Cohen's f.
    pub effect_f: f64,
    /// Significance level.
    pub alpha: f64,
    /// Correlation among measurements.
    pub correlation: f64,
    /// Correction for nonsphericity.
    pub epsilon: f64,
    /// Probability of finding the effect.
    pub power: f64,
}

/// Correlation of felt spectra with the recorded one of their texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SpectralCorrelation {
    /// Of each participant, texture and model.
    pub cells: Vec<Correlation>,
    /// Means over participants of each model in each texture.
    pub means: Vec<Mean>,
    /// Means over participants of each model, averaged over textures.
    pub means_model: Vec<Mean>,
    /// Definition and source.
    pub method: String,
}

/// Correlation of one felt spectrum.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Correlation {
    /// Participant.
    pub participant: String,
    /// Texture.
    pub texture: String,
    /// Model.
    pub model: String,
    /// Pearson's correlation; absent if a spectrum is constant.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub correlation: Option<f64>,
}

/// A regression of ratings on differences of energy in bands.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BandResult {
    /// Number of bands.
    pub filters: usize,
    /// Explained part of the variance.
    pub r2: f64,
    /// The same, adjusted for the number of bands.
    pub adjusted_r2: f64,
    /// r2 of predictions for participants that were left out; absent if it is not defined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cross_validated_r2: Option<f64>,
    /// F ratio of all bands.
    pub f: f64,
    /// Its degrees of freedom.
    pub df: [f64; 2],
    /// Its p-value.
    pub p: f64,
    /// Root of the residual sum of squares by residual degrees of freedom, in z-scores.
    pub rmse: f64,
    /// Akaike's information criterion.
    pub aic: f64,
    /// Schwarz's (Bayesian) information criterion.
    pub bic: f64,
    /// Intercept, then a coefficient for each band.
    pub coefficients: Vec<f64>,
    /// Bands, from 1, that do not vary or depend on those before them; their coefficient is 0.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub dependent: Vec<usize>,
    /// Frequencies, hertz: band i rises from the i-th to the next and falls to the one after it.
    pub edges_hz: Vec<f64>,
}

/// The numbers of bands that criteria prefer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct BestBanks {
    /// Lowest BIC.
    pub bic: usize,
    /// Lowest AIC.
    pub aic: usize,
    /// Highest cross-validated r2; absent if it is not defined.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub cross_validated_r2: Option<usize>,
    /// BIC of no bands at all: the mean alone. Where it is the lowest, the bands explain nothing.
    pub bic_of_none: f64,
    /// Whether the best bank has a lower BIC than no bands at all.
    pub better_than_none: bool,
}
