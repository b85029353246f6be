//! Accuracy of a spectrum, compared with the spectrum of a recording.

use crate::{FeltError, TextureSpectrum, agreement};
use htex_format::{Measure, Measures};
use serde::{Deserialize, Serialize};

/// Errors of a spectrum relative to a recording's spectrum.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Accuracy {
    /// Every measure of [`Measure::of_both`].
    pub(crate) measures: Measures,
    /// How much of the difference can be felt.
    pub(crate) felt: FeltError,
}

/// Error in decibels that stands for silence, or for a missing comparison, so that all errors are
/// finite.
pub(crate) const FAR_DB: f64 = 200.0;

pub(crate) fn accuracy(reference: &TextureSpectrum, magnitude: &[f64]) -> Accuracy {
    let found = agreement(reference.as_ref(), magnitude);
    let felt = FeltError::new(reference, magnitude, found.get(Measure::NineBand));
    let finite = |measure| match measure {
        Measure::Felt => felt.error_rms_db,
        _ => found.get(measure).unwrap_or(FAR_DB).clamp(-FAR_DB, FAR_DB),
    };
    Accuracy {
        measures: Measures::new(|measure| Some(finite(measure))).only(Measure::of_both()),
        felt,
    }
}
