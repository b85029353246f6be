//! What to fit: models and options of an asset.

use std::collections::BTreeMap;

use htex_host::LoadedModel;

use crate::SpectrumOptions;
use crate::level::Level;

/// A model to fit, with one value for each of its options.
#[derive(Debug, Clone)]
pub struct ModelRequest {
    /// The model.
    pub model: LoadedModel,
    /// Its option values ([`LoadedModel::options`]).
    pub options: Vec<f64>,
}

/// Options of an asset to be fitted.
#[derive(Debug, Clone, Default)]
pub struct AssetRequest {
    /// Name of the texture.
    pub name: String,
    /// SPDX licence expression.
    pub license: Option<String>,
    /// Author of the asset.
    pub author: Option<String>,
    /// Search terms.
    pub tags: Vec<String>,
    /// Models, in the order of the representations.
    pub models: Vec<ModelRequest>,
    /// Options of the spectra.
    pub spectrum: SpectrumOptions,
    /// Level of the representations.
    pub level: Level,
    /// Models to try at their default options when a representation has a large band error; those in `models` are
    /// always tried.
    pub alternatives: Vec<LoadedModel>,
    /// Whether to refuse recordings with errors or warnings.
    pub strict: bool,
    /// Whether to keep the recorded spectra in the asset.
    pub keep_reference: bool,
    /// Options that differ from their defaults, for the provenance.
    pub recorded_options: BTreeMap<String, String>,
    /// Program and version, for the provenance.
    pub tool: String,
}
