//! Averages over the segments of a texture.

use htex_dsp::spectrum::{Complex, magnitude};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Method of averaging segments.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum Averaging {
    /// Mean of the magnitudes: one reading of "averaged the FFTs" (paper, Texture processing). The
    /// mean of noise is 1.05 dB, a factor of √π/2, below its RMS (Rayleigh distribution).
    Magnitude,
    /// Root of the mean power: the RMS of noise and tones.
    #[default]
    Rms,
    /// Magnitude of the mean of the complex spectra: keeps only what has the same phase in all
    /// segments.
    Complex,
}

impl Averaging {
    /// All methods, in the order of the command line's help.
    pub const ALL: &[Self] = &[Self::Magnitude, Self::Rms, Self::Complex];

    /// Returns the name used in recipes and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Magnitude => "magnitude",
            Self::Rms => "rms",
            Self::Complex => "complex",
        }
    }
}

/// Returns the average in each of the first `bins` bins.
pub(crate) fn average(all: &[&[Complex<f64>]], bins: usize, averaging: Averaging) -> Vec<f64> {
    let n = all.len() as f64;
    (0..bins)
        .map(|k| {
            let column = all.iter().map(|spectrum| spectrum[k]);
            match averaging {
                Averaging::Magnitude => column.map(magnitude).sum::<f64>() / n,
                Averaging::Rms => (column.map(|x| x.norm_sqr()).sum::<f64>() / n).sqrt(),
                Averaging::Complex => magnitude(column.sum::<Complex<f64>>() / n),
            }
        })
        .collect()
}
