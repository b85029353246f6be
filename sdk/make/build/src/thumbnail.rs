//! Spectra with few numbers, so that a page can contain the spectra of thousands of textures.

use htex_author::TextureSpectrum;
use serde::{Deserialize, Serialize};

/// Number of points in a thumbnail, evenly spaced in log frequency over the band.
const POINTS: usize = 48;
/// Range of a thumbnail below its largest magnitude, decibels.
const RANGE_DB: f64 = 40.0;
/// Number of steps in that range.
const STEPS: f64 = 63.0;

/// A spectrum with 48 points, evenly spaced in log frequency over the spectrum's band. The largest
/// magnitude of the spectrum has the value 63. A magnitude that is at least 40 dB smaller has the
/// value 0.
#[derive(Debug, Clone, PartialEq, Eq, Default, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Thumbnail(pub Vec<u8>);

/// Returns the thumbnail of a spectrum.
pub(crate) fn thumbnail(spectrum: &TextureSpectrum) -> Thumbnail {
    of_magnitudes(&spectrum.frequency_hz, &spectrum.magnitude)
}

/// Returns the thumbnail of magnitudes at ascending frequencies.
pub(crate) fn of_magnitudes(frequency_hz: &[f64], magnitude: &[f64]) -> Thumbnail {
    let (Some(low), Some(high)) = (frequency_hz.first(), frequency_hz.last()) else {
        return Thumbnail::default();
    };
    let largest = magnitude.iter().copied().fold(0.0, f64::max);
    let step = libm::pow(high / low, 1.0 / POINTS as f64);
    let mut edge = *low;
    let points = (0..POINTS).map(|_| {
        let (from, to) = (edge, edge * step);
        edge = to;
        let within = frequency_hz.iter().zip(magnitude).filter(|(f, _)| (from..=to).contains(*f));
        let peak = within.map(|(_, m)| *m).fold(0.0, f64::max);
        // Below 50 Hz the 5 Hz grid is coarser than the points, so some points have no frequency of
        // the grid.
        let peak = if peak > 0.0 { peak } else { nearest(frequency_hz, magnitude, from) };
        level(peak, largest)
    });
    Thumbnail(points.collect())
}

fn nearest(frequency_hz: &[f64], magnitude: &[f64], at: f64) -> f64 {
    let above = frequency_hz.partition_point(|f| *f < at);
    magnitude.get(above).copied().unwrap_or_default()
}

fn level(magnitude: f64, largest: f64) -> u8 {
    if magnitude <= 0.0 || largest <= 0.0 {
        return 0;
    }
    let below_db = 20.0 * libm::log10(largest / magnitude);
    (STEPS * (1.0 - below_db / RANGE_DB)).clamp(0.0, STEPS).round() as u8
}
