//! The band of a texture, and the grid of frequencies on which its spectrum is given.
//!
//! A spectrum has unit RMS if the RMS computed from the bins in the band is 1. Bins outside the
//! band do not count, although the window spreads part of a component at 20 Hz into these bins.
//! Suppose that a texture is rendered, and the samples are fitted again to make a copy. If the bins
//! outside the band counted, each copy of a texture with much energy at 20 Hz would lose up to 0.1
//! dB of its level. With this definition, the level stays within 0.1 dB over three successive
//! copies (300 s of samples).

use alloc::vec::Vec;

/// Spacing of the texture spectrum's grid, hertz: the frequency resolution of 4000 samples at 20
/// kHz (paper, Texture processing).
pub const GRID_HZ: f64 = 5.0;

/// The band that a texture spectrum covers, hertz, including both edges.
///
/// ```
/// use htex_dsp::Band;
/// assert_eq!(Band::TACTILE.edges(), (20.0, 1000.0));
/// assert_eq!(Band::TACTILE.bins(), 197);
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Band {
    /// Lower edge, hertz.
    pub low_hz: f64,
    /// Upper edge, hertz.
    pub high_hz: f64,
}

impl Band {
    /// The tactile band of the paper: 20 to 1000 Hz.
    pub const TACTILE: Self = Self { low_hz: 20.0, high_hz: 1000.0 };

    /// Both edges, hertz.
    pub fn edges(self) -> (f64, f64) {
        (self.low_hz, self.high_hz)
    }

    /// Grid index (in multiples of [`GRID_HZ`]) of the lowest bin in the band.
    pub fn first_bin(&self) -> usize {
        // If rounding has moved an edge, the tolerance keeps it on the grid. 0 Hz is never a bin.
        (libm::ceil(self.low_hz / GRID_HZ - 1e-9) as usize).max(1)
    }

    /// Grid index of the highest bin in the band.
    pub fn last_bin(&self) -> usize {
        libm::floor(self.high_hz / GRID_HZ + 1e-9) as usize
    }

    /// Number of grid bins in the band: 197 for 20 to 1000 Hz.
    pub fn bins(&self) -> usize {
        (self.last_bin() + 1).saturating_sub(self.first_bin())
    }

    /// The grid frequencies in the band, ascending, hertz.
    pub fn grid_hz(&self) -> Vec<f64> {
        (self.first_bin()..=self.last_bin()).map(|bin| bin as f64 * GRID_HZ).collect()
    }

    /// Returns whether `frequency_hz` lies in the band. The band includes its edges.
    pub fn contains(&self, frequency_hz: f64) -> bool {
        (self.low_hz..=self.high_hz).contains(&frequency_hz)
    }
}

/// Returns a part of a component's power: the part that the bins of a band measure through the
/// periodic Hann window. This part is 1 well inside the band, 5/6 at its edge bins, 1/2 midway
/// between an edge bin and the first bin outside, and 0 far outside.
///
/// A component near an edge also has power in bins outside the band, which do not count. Noise
/// generators amplify such a component to compensate for this loss.
pub fn read_part(band: Band, frequency_hz: f64) -> f64 {
    ReadPart::new(band).part_at(frequency_hz)
}

/// [`read_part`], precomputed for one band.
pub(crate) struct ReadPart {
    first: f64,
    last: f64,
}

impl ReadPart {
    pub(crate) fn new(band: Band) -> Self {
        Self { first: band.first_bin() as f64, last: band.last_bin() as f64 }
    }

    pub(crate) fn part_at(&self, frequency_hz: f64) -> f64 {
        let at = frequency_hz / GRID_HZ;
        let Self { first, last } = *self;
        if at >= first + WINDOW_BINS && at <= last - WINDOW_BINS {
            return 1.0;
        }
        let nearest = libm::round(at);
        // The distances between bins are whole numbers. Therefore, all bins use the same sine,
        // apart from its sign.
        let turn = crate::trig::sin(core::f64::consts::PI * (at - nearest)) / core::f64::consts::PI;
        let low = first.max(nearest - WINDOW_BINS) as i64;
        let high = last.min(nearest + WINDOW_BINS) as i64;
        let read: f64 = (low..=high).map(|bin| hann_power(bin as f64 - at, turn)).sum();
        read / 1.5
    }
}

/// Distance in bins beyond which the Hann window measures almost nothing of a component: 2e-5 of
/// its power in total.
const WINDOW_BINS: f64 = 4.0;

/// Power that the Hann window measures `x` bins from a component of unit power: the square of
/// `sinc(x) / (1 - x²)`. `turn` is `sin(πx) / π`, apart from its sign.
fn hann_power(x: f64, turn: f64) -> f64 {
    let x = libm::fabs(x);
    // At 0 and 1 the formula is 0 / 0; these are its limits.
    let amplitude = if x < 1e-6 {
        1.0
    } else if libm::fabs(x - 1.0) < 1e-6 {
        0.5
    } else {
        turn / x / (1.0 - x * x)
    };
    amplitude * amplitude
}

impl From<(f64, f64)> for Band {
    fn from((low_hz, high_hz): (f64, f64)) -> Self {
        Self { low_hz, high_hz }
    }
}

/// Returns the RMS of a texture spectrum on the grid, in the unit of the magnitudes. A periodic
/// Hann window measures the magnitudes, so the power of a bin is `magnitude² / (2 · 1.5)` (its
/// equivalent noise bandwidth is 1.5 bins).
pub fn level_rms(magnitude: &[f64]) -> f64 {
    crate::root::sqrt(magnitude.iter().map(|m| m * m).sum::<f64>() / 3.0)
}

/// Returns the [`level_rms`] of a curve on the band's grid, without storing the values of the
/// curve.
pub fn curve_level_rms(band: Band, curve: impl Fn(f64) -> f64) -> f64 {
    let power: f64 = (band.first_bin()..=band.last_bin())
        .map(|bin| curve(bin as f64 * GRID_HZ))
        .map(|m| m * m)
        .sum();
    crate::root::sqrt(power / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::spectrum::SegmentAnalyzer;

    /// Compares with the analyser itself, with components on bins and between them.
    #[test]
    fn read_part_matches_the_analyser() {
        let (band, len) = (Band::TACTILE, 2_000);
        let rate_hz = len as f64 * GRID_HZ;
        let mut analyzer = SegmentAnalyzer::new(len);
        let mut bins = analyzer.make_bins();
        for hz in
            [9.0, 12.5, 15.0, 17.5, 18.7, 20.0, 22.5, 31.0, 500.0, 998.0, 1000.0, 1002.5, 1011.0]
        {
            // Two phases a quarter turn apart: their mean power is the power of noise at this
            // frequency.
            let power: f64 = [0.0, 0.25]
                .map(|turn| {
                    let wave = |n: usize| {
                        libm::cos(core::f64::consts::TAU * (turn + hz * n as f64 / rate_hz))
                    };
                    let samples: Vec<f64> = (0..len).map(wave).collect();
                    analyzer.analyze(&samples, &mut bins).expect("as long as the segment");
                    let magnitude: Vec<f64> = bins[band.first_bin()..=band.last_bin()]
                        .iter()
                        .map(|bin| bin.norm() * analyzer.amplitude_scale())
                        .collect();
                    level_rms(&magnitude).powi(2)
                })
                .iter()
                .sum();
            let part = read_part(band, hz);
            assert!((power - part).abs() < 2e-3, "{hz} Hz: {power} {part}");
        }
        assert_eq!(read_part(band, 500.0), 1.0);
        assert!((read_part(band, 20.0) - 5.0 / 6.0).abs() < 1e-3);
        assert!((read_part(band, 1002.5) - 0.5).abs() < 1e-4);
    }
}
