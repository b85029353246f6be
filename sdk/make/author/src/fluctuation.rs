//! How recordings and voices fluctuate in time, and how much two of them differ in it.

use htex_dsp::fluctuation::Fluctuation;
use htex_host::{LoadedModel, Stream};
use schemars::JsonSchema;
use serde::Serialize;

use crate::{AuthorError, Recording, SpectrumRef};

/// Length of the rendering that is measured, seconds.
const SECONDS: f64 = 20.0;
/// The seed is always the same, so that measuring again gives the same numbers.
const SEED: u64 = 1;
/// Samples rendered before the measured ones, seconds: a voice may begin softly.
const LEAD_S: f64 = 0.5;

/// Measures how a recording fluctuates; `None` if the recording is shorter than 3 s or silent.
pub fn fluctuation(recording: &Recording) -> Option<Fluctuation> {
    let axes: Vec<&[f64]> = recording.axes.iter().map(Vec::as_slice).collect();
    Fluctuation::new(&axes, recording.rate_hz)
}

/// Measures how the voice of a model fluctuates with the given parameters.
///
/// # Errors
/// When the model cannot render.
pub(crate) fn voice_fluctuation(
    model: &LoadedModel,
    parameters: &[f64],
    reference: SpectrumRef<'_>,
) -> Result<Option<Fluctuation>, AuthorError> {
    let rate_hz = 4.0 * reference.band.high_hz;
    let lead = (LEAD_S * rate_hz) as usize;
    let mut samples = vec![0.0f32; lead + (SECONDS * rate_hz) as usize];
    Stream::new(model, parameters, reference.band, rate_hz, SEED)?.render(&mut samples)?;
    let samples: Vec<f64> = samples[lead..].iter().map(|x| f64::from(*x)).collect();
    Ok(Fluctuation::new(&[&samples], rate_hz))
}

/// How the fluctuation of a signal differs from the fluctuation of a recording.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, JsonSchema)]
pub struct FluctuationDifference {
    /// RMS difference of the modulation spectra, decibels. Of second takes of one surface, 95 % lie
    /// within [`SECOND_TAKES_DB`].
    pub fluctuation_error_db: f64,
    /// Kurtosis of the recording and of the other signal; 3 for Gaussian noise.
    pub kurtosis: [f64; 2],
    /// Mean correlation between the envelopes of wide bands, of the recording and of the other
    /// signal. `None` if the band of the signal is too narrow.
    pub envelope_correlation: [Option<f64>; 2],
}

/// In 148 pairs of second takes of one surface (a robot's fingertip, 3 s each), 95 % differed by at
/// most this much: in third octaves and in the modulation spectrum, decibels.
pub const SECOND_TAKES_DB: [f64; 2] = [2.0, 3.4];

impl FluctuationDifference {
    /// Compares a signal with a recording.
    pub fn new(recorded: &Fluctuation, other: &Fluctuation) -> Self {
        Self {
            fluctuation_error_db: recorded.error_rms_db(other),
            kurtosis: [recorded, other].map(|signal| signal.kurtosis),
            envelope_correlation: [recorded, other].map(|signal| signal.envelope_correlation),
        }
    }
}
