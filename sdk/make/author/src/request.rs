//! Options of a fit: the models, and the asset to make.

use std::collections::BTreeMap;

use htex_format::Contact;
use htex_host::LoadedModel;

use crate::SpectrumOptions;
use crate::coding::Coding;
use crate::grid::Grid;
use crate::level::Level;
use crate::settings::{GivenLaw, Metadata};

/// A model to fit, with one value for each of its options.
#[derive(Debug, Clone)]
#[non_exhaustive]
pub struct ModelRequest {
    pub model: LoadedModel,
    /// The model's option values ([`LoadedModel::options`]).
    pub options: Vec<f64>,
}

impl ModelRequest {
    /// Requests a model with its default options.
    #[must_use]
    pub fn new(model: &LoadedModel) -> Self {
        Self { model: model.clone(), options: model.descriptor().default_options() }
    }

    #[must_use]
    pub fn with_options(mut self, options: Vec<f64>) -> Self {
        self.options = options;
        self
    }
}

/// Options for fitting an asset.
///
/// ```
/// use htex_author::{AssetRequest, ModelRequest};
/// use htex_host::Registry;
///
/// let registry = Registry::builtin();
/// let models = registry.by_default().map(ModelRequest::new);
/// let mut request = AssetRequest::new("linen").with_models(models);
/// request.license = Some("CC-BY-4.0".to_owned());
/// assert_eq!(request.models.len(), registry.by_default().count());
/// ```
#[derive(Debug, Clone, Default)]
#[non_exhaustive]
pub struct AssetRequest {
    pub name: String,
    /// SPDX licence expression.
    pub license: Option<String>,
    pub author: Option<String>,
    /// Search terms.
    pub tags: Vec<String>,
    /// The models, in the order of the representations.
    pub models: Vec<ModelRequest>,
    pub spectrum: SpectrumOptions,
    pub level: Level,
    /// What slid over the surface. `None` means a finger if all recordings are simulated, and an
    /// unknown contact otherwise.
    pub contact: Option<Contact>,
    /// Exponents that replace the measured or assumed exponents of the law.
    pub law: Option<GivenLaw>,
    /// Models to try with their default options, in addition to `models`, when a representation has
    /// a large band error.
    pub alternatives: Vec<LoadedModel>,
    /// Whether to refuse recordings with errors or warnings.
    pub strict: bool,
    /// Grid of conditions, for recordings of a free motion. Without a grid, each recording gives
    /// one condition.
    pub grid: Option<Grid>,
    /// Whether to keep the recorded spectra in the asset.
    pub keep_reference: bool,
    /// Whether the asset is coded.
    pub coding: Coding,
    /// Whether to fit only the recorded conditions, without conditions computed from them.
    pub recorded_only: bool,
    /// Options whose values differ from their defaults, to be stored in the provenance.
    pub recorded_options: BTreeMap<String, String>,
    /// Program and version, stored in the provenance.
    pub tool: String,
}

impl AssetRequest {
    /// Requests an asset with this name and no models yet.
    #[must_use]
    pub fn new(name: impl Into<String>) -> Self {
        Self { name: name.into(), ..Self::default() }
    }

    /// Sets the models, in the order of the representations.
    #[must_use]
    pub fn with_models(mut self, models: impl IntoIterator<Item = ModelRequest>) -> Self {
        self.models = models.into_iter().collect();
        self
    }

    #[must_use]
    pub fn with_spectrum(mut self, spectrum: SpectrumOptions) -> Self {
        self.spectrum = spectrum;
        self
    }

    /// Sets the contact and the exponents that `metadata` gives for the law.
    #[must_use]
    pub fn with_law_of(mut self, metadata: &Metadata) -> Self {
        (self.contact, self.law) = (metadata.contact, metadata.law);
        self
    }

    /// Sets whether to refuse recordings with errors or warnings.
    #[must_use]
    pub fn with_strict(mut self, strict: bool) -> Self {
        self.strict = strict;
        self
    }

    /// Sets the grid of conditions, for recordings of a free motion.
    #[must_use]
    pub fn with_grid(mut self, grid: impl Into<Option<Grid>>) -> Self {
        self.grid = grid.into();
        self
    }
}
