//! Contenders of a sweep. A contender is a model with a setting, or a baseline. Every contender can
//! be fitted to a recording, stored and played.

use crate::{AuthorError, Level, TextureSpectrum, stored_fields, stored_level};
use htex_dsp::grid::level_rms;
use htex_format::{StoredAs, StoredField, round_within, stored_bytes};
use htex_host::{Fit, FitCondition, HostError, LoadedModel};

use crate::tradeoff::baseline::quantise;
use crate::tradeoff::setting::Keep;
use crate::tradeoff::{Setting, Subject};

/// What is measured: a model with a setting, or a baseline.
#[derive(Debug, Clone)]
pub(crate) struct Contender {
    pub(crate) model: String,
    pub(crate) setting: Setting,
    pub(crate) kind: ContenderKind,
}

#[derive(Debug, Clone)]
pub(crate) enum ContenderKind {
    /// A model, with a value for each of its fit options.
    Model(LoadedModel, Vec<f64>),
    /// The spectrum, quantised to one byte per bin.
    Quantised,
    Recording,
}

/// The stored data needed for playing.
pub(crate) struct StoredData {
    pub(crate) parameters: Vec<f64>,
    pub(crate) level_rms: f64,
    pub(crate) bytes: usize,
}

impl Contender {
    /// Returns the contender's name, which is unique within a recording.
    pub(crate) fn id(&self) -> String {
        format!("{} {}", self.model, self.setting.words())
    }

    /// Fits the model to a spectrum. For a baseline, computes the data to store.
    pub(crate) fn fit(&self, spectrum: &TextureSpectrum) -> Result<Fit, HostError> {
        match &self.kind {
            ContenderKind::Model(model, options) => {
                model.fit(&spectrum.fit_input(options, FitCondition::default()))
            }
            ContenderKind::Quantised => {
                let parameters = quantise(&spectrum.magnitude).0;
                let level_rms = level_rms(&parameters);
                Ok(Fit { parameters, level_rms })
            }
            ContenderKind::Recording => {
                Ok(Fit { parameters: Vec::new(), level_rms: level_rms(&spectrum.magnitude) })
            }
        }
    }

    /// Stores a fit to one of the subject's spectra. Returns the data as read back, and their size.
    pub(crate) fn store(
        &self,
        subject: &Subject,
        spectrum: &TextureSpectrum,
        fit: &Fit,
    ) -> Result<StoredData, AuthorError> {
        let (parameters, bytes) = match &self.kind {
            ContenderKind::Model(model, _) => {
                let mut fields = stored_fields(model.descriptor());
                self.keep(&mut fields);
                let parameters = round_within(&fields, model.descriptor(), &fit.parameters)?;
                let (reference, level) = (spectrum.as_ref(), Level::default());
                return Ok(StoredData {
                    level_rms: stored_level(model, fit, &parameters, reference, level)?,
                    bytes: stored_bytes(&fields, &parameters)?,
                    parameters,
                });
            }
            ContenderKind::Quantised => quantise(&spectrum.magnitude),
            ContenderKind::Recording => (Vec::new(), subject.bytes),
        };
        Ok(StoredData { parameters, level_rms: fit.level_rms, bytes })
    }

    fn keep(&self, fields: &mut [StoredField]) {
        let store = match self.setting.store {
            Keep::Model => return,
            Keep::F32 => StoredAs::F32,
            Keep::F64 => StoredAs::F64,
        };
        fields.iter_mut().for_each(|field| field.store = store);
    }
}
