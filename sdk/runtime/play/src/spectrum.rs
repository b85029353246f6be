//! The spectrum of a voice, after its frequencies and its level are scaled.

use htex_host::{Band, LoadedModel};

use crate::Error;

/// Returns the magnitudes of a model's voice at the frequencies `frequency_hz`, if its unit-RMS
/// samples are read at `ratio` times the recorded speed and played at a level. Noise of magnitude
/// m(f) then has the magnitude `m(f / ratio) / sqrt(ratio)`, and a sum of sinusoids has the
/// magnitude `m(f / ratio)`.
pub(crate) fn scaled_magnitude(
    model: &LoadedModel,
    parameters: &[f64],
    band: Band,
    frequency_hz: &[f64],
    ratio: f64,
    level_rms: f64,
) -> Result<Vec<f64>, Error> {
    let recorded_hz: Vec<f64> = frequency_hz.iter().map(|f| f / ratio).collect();
    let shape = model.magnitude(parameters, band, &recorded_hz)?;
    let spread = if model.has_lines() { 1.0 } else { ratio.sqrt() };
    Ok(shape.iter().map(|m| m * level_rms / spread).collect())
}
