//! The result of an analysis, as it is written to JSON.

use std::collections::BTreeMap;

use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

use super::results::{
    AnovaResult, BandResult, BestBanks, FriedmanResult, Normality, PairResult, PowerRow,
    SpectralCorrelation,
};

/// Name and version of the form.
pub(super) const ANALYSIS: &str = "htex-study-analysis/1";

/// The analysis of a study. What the data do not allow is absent, and `notes` say why; every number is finite.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Analysis {
    /// `htex-study-analysis/1`.
    pub analysis: String,
    /// Program and version that analysed.
    pub program: String,
    /// Participants, in the order of every list.
    pub participants: Vec<String>,
    /// Those of them that are simulated.
    pub simulated: Vec<String>,
    /// Textures, in the order of every list.
    pub textures: Vec<String>,
    /// Models, in the order of every list.
    pub models: Vec<String>,
    /// Largest number of repetitions of a condition.
    pub repetitions: usize,
    /// The method of each group of numbers: test, correction and source, by the group's key.
    pub methods: BTreeMap<String, String>,
    /// What is not computed or needs care, and why.
    pub notes: Vec<Note>,
    /// Mean rating of each participant, texture and model.
    pub cell_means: Vec<CellMean>,
    /// Ratings of each model, averaged over textures.
    pub means_model: Vec<Mean>,
    /// Ratings of each model in each texture.
    pub means: Vec<Mean>,
    /// Normality of the mean ratings.
    pub normality: Normality,
    /// Normality of the mean ratings of each texture.
    pub normality_by_texture: BTreeMap<String, Normality>,
    /// Effect of the model on ratings averaged over textures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub anova_model: Option<AnovaResult>,
    /// Effect of the model in each texture.
    pub anova_by_texture: BTreeMap<String, AnovaResult>,
    /// Effects of `texture`, `model` and `texture * model`.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub anova_two_way: BTreeMap<String, AnovaResult>,
    /// Effect of the model on ranks of ratings averaged over textures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub friedman: Option<FriedmanResult>,
    /// Effect of the model on ranks in each texture.
    pub friedman_by_texture: BTreeMap<String, FriedmanResult>,
    /// Comparisons of models by ratings averaged over textures.
    pub pairs_model: Vec<PairResult>,
    /// Comparisons of models in each texture.
    pub pairs_by_texture: BTreeMap<String, Vec<PairResult>>,
    /// Power of a study of this shape for a medium effect.
    pub power: Vec<PowerRow>,
    /// Correlation of felt spectra with recorded ones, if spectra are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub spectral_correlation: Option<SpectralCorrelation>,
    /// Regressions of ratings on differences of spectral energy in 1 to 20 bands, if spectra are given.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub bands: Vec<BandResult>,
    /// The number of bands that each criterion prefers, if spectra are given.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub best_bands: Option<BestBanks>,
}

/// What is not computed, and why.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Note {
    /// Key of the group that it belongs to, such as `anova_model` or `pairs_by_texture.vinyl`.
    pub group: String,
    /// Stable code: `TOO_FEW_PARTICIPANTS`.
    pub code: String,
    /// What is wrong, and what to do.
    pub message: String,
}

/// A participant's mean rating of a model in a texture.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct CellMean {
    /// Participant.
    pub participant: String,
    /// Texture.
    pub texture: String,
    /// Model.
    pub model: String,
    /// Number of repetitions.
    pub repetitions: usize,
    /// Their mean.
    pub mean: f64,
}

/// Mean over participants.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Mean {
    /// Texture; absent for a mean over all textures.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub texture: Option<String>,
    /// Model.
    pub model: String,
    /// Number of participants.
    pub count: usize,
    /// Mean.
    pub mean: f64,
    /// Standard deviation between participants (n - 1); 0 for one participant.
    pub sd: f64,
    /// Value of each participant.
    pub by_participant: Vec<f64>,
}
