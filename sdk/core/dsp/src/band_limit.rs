//! Steep filters that limit noise to the band, if the spectrum of the noise is wider than the band.
//!
//! A filter changes the RMS by up to 2 %, because the filter has ripple, and because half of the
//! bin at the Nyquist frequency lies above this frequency. Therefore a model that uses these
//! filters computes the level of the filtered noise, as a sum over a table of frequencies
//! ([`PassedPower`]).

use alloc::sync::Arc;
use alloc::vec::Vec;

use crate::biquad::Biquad;
use crate::butterworth::PassKind;
use crate::chebyshev::chebyshev;
use crate::grid::{Band, GRID_HZ, read_part};
use crate::pipeline::Pipeline;
use crate::shared::Shared;
use crate::wide::{Work, very_wide, wide};

/// Filter order: 80 dB per decade. At the edge, the filter is as steep as a Butterworth filter of
/// twice the order, so little power passes outside the band.
const ORDER: usize = 4;
const RIPPLE_DB: f64 = 0.2;
/// Within this number of bins on either side of an edge, the response changes inside a single bin.
const EDGE_BINS: usize = 3;
/// Points per bin at which the response is evaluated in these bins.
const EDGE_POINTS: usize = 4;
/// Distance from an edge, relative to its frequency, beyond which the attenuation is at least 30
/// dB.
const BESIDE: f64 = 0.5;

/// Returns the filters that limit noise to `band`, at the sample rate `rate_hz`. The filters are
/// Chebyshev filters. Inside the band, the magnitude is constant within 0.2 dB. It may deviate more
/// at frequencies that are closer to an edge than an eighth of the edge's frequency. Half a grid
/// bin outside each edge, the magnitude is 3 dB down. An edge at or above the Nyquist frequency
/// gets no filter. The output is delayed by some samples ([`Pipeline`]).
pub fn band_limit(band: Band, rate_hz: f64) -> Pipeline {
    Pipeline::new(&sections(band, rate_hz))
}

/// Returns a function that maps a frequency, in hertz, to the part of the power that [`band_limit`]
/// passes.
pub fn band_limit_power(band: Band, rate_hz: f64) -> impl Fn(f64) -> f64 {
    let sections = sections(band, rate_hz);
    move |hz| {
        let magnitudes = sections.iter().map(|s| s.magnitude(hz, rate_hz));
        magnitudes.map(|m| m * m).product()
    }
}

fn sections(band: Band, rate_hz: f64) -> Vec<Biquad> {
    let half_bin = 0.5 * GRID_HZ;
    // Half a bin below a very low edge could be 0 Hz or less, where no filter exists.
    let low_hz = (band.low_hz - half_bin).max(0.5 * band.low_hz);
    let high_hz = band.high_hz + half_bin;
    [(PassKind::HighPass, low_hz), (PassKind::LowPass, high_hz)]
        .into_iter()
        .filter_map(|(kind, edge_hz)| chebyshev(kind, ORDER, RIPPLE_DB, edge_hz, rate_hz))
        .flatten()
        .collect()
}

/// A table that states, for each frequency, which part of a noise's power passes [`band_limit`] and
/// is measured in the bins of the band. The table covers each grid bin in the band and some bins
/// outside. Bins near the edges are subdivided. If a bin contains the Nyquist frequency, only its
/// part below that frequency counts.
///
/// The table corrects the level of filtered noise. Without this correction, the noise would be too
/// weak for three reasons. The filters have ripple, a part of the highest bin lies above the
/// Nyquist frequency, and the window does not measure all power at the band's edges.
#[derive(Debug, Clone)]
pub struct PassedPower {
    /// Frequency in hertz, and the part of the power at this frequency that is measured, 0 to
    /// about 1.
    points: Vec<(f64, f64)>,
    /// The same points in groups of [`TURNS`]: cosine and sine of the phase advance per sample, and
    /// the part of the power.
    turns: Vec<Turns>,
}

/// A group of points; unused ones have weight zero.
#[derive(Debug, Clone, Copy)]
struct Turns {
    cos: [f64; TURNS],
    sin: [f64; TURNS],
    part: [f64; TURNS],
}

/// Points per group.
const TURNS: usize = 8;

impl PassedPower {
    /// Returns the table of [`Self::new`]. All users of the same band and rate share one table.
    pub fn shared(band: Band, rate_hz: f64) -> Arc<Self> {
        static PASSED: Shared<[u64; 3], PassedPower> = Shared::new();
        let key = [band.low_hz, band.high_hz, rate_hz].map(f64::to_bits);
        PASSED.get(key, || Arc::new(Self::new(band, rate_hz)))
    }

    /// Computes the table for a band and a sample rate (both in hertz).
    pub fn new(band: Band, rate_hz: f64) -> Self {
        Self::read_by(band, rate_hz, |hz| read_part(band, hz))
    }

    fn read_by(band: Band, rate_hz: f64, read: impl Fn(f64) -> f64) -> Self {
        let power = band_limit_power(band, rate_hz);
        let edges = [band.first_bin(), band.last_bin()];
        let [below, above] = edges.map(|bin| EDGE_BINS.max((BESIDE * bin as f64) as usize));
        let nyquist_bin = libm::ceil(0.5 * rate_hz / GRID_HZ) as usize;
        let first_bin = edges[0].saturating_sub(below);
        let last_bin = (edges[1] + above).min(nyquist_bin);
        let heard = |bin: usize| {
            let count = if edges.iter().any(|edge| edge.abs_diff(bin) <= EDGE_BINS) {
                EDGE_POINTS
            } else {
                1
            };
            let parts = (0..count).map(move |i| (i as f64 + 0.5) / count as f64);
            let all = parts.map(move |part| (bin as f64 - 0.5 + part) * GRID_HZ);
            all.filter(|hz| (0.0..0.5 * rate_hz).contains(hz))
                .map(|hz| (hz, power(hz) * read(hz) / count as f64))
                .collect::<Vec<_>>()
        };
        let points: Vec<(f64, f64)> = (first_bin..=last_bin).flat_map(heard).collect();
        Self { turns: points.chunks(TURNS).map(|p| Turns::new(p, rate_hz)).collect(), points }
    }

    /// Returns the RMS of noise after the filters, if the noise has the magnitude `curve` before
    /// the filters. Corresponds to [`curve_level_rms`](crate::grid::curve_level_rms), which
    /// measures unfiltered noise.
    pub fn level_rms(&self, curve: impl Fn(f64) -> f64) -> f64 {
        let power: f64 = self
            .points
            .iter()
            .map(|(hz, part)| (part, curve(*hz)))
            .map(|(part, m)| part * m * m)
            .sum();
        crate::root::sqrt(power / 3.0)
    }

    /// Returns the RMS of white noise after the all-pole filter `1 / (1 - Σ A_i z⁻ⁱ)` at this rate.
    /// The RMS is measured as in [`Self::level_rms`]. Before the filter, the noise has a magnitude
    /// of 1 in each bin. Does not allocate.
    pub fn all_pole_level_rms(&self, coefficients: &[f64]) -> f64 {
        let mut power = 0.0;
        wide(AllPolePower { turns: &self.turns, coefficients, power: &mut power });
        crate::root::sqrt(power / 3.0)
    }

    /// Returns the same RMS as [`Self::all_pole_level_rms`], but for a filter with zeros and poles.
    /// The arguments are the cosines of the line spectral frequencies of the zeros and of the
    /// poles. Does not allocate.
    pub fn rational_level_rms(&self, zeros: &[f64], poles: &[f64]) -> f64 {
        let mut power = 0.0;
        let work = RationalPower { turns: &self.turns, zeros, poles, power: &mut power };
        if let Err(work) = very_wide(work) {
            wide(work);
        }
        crate::root::sqrt(power / 3.0)
    }
}

impl Turns {
    const NONE: Self = Self { cos: [1.0; TURNS], sin: [0.0; TURNS], part: [0.0; TURNS] };

    fn new(points: &[(f64, f64)], rate_hz: f64) -> Self {
        let mut turns = Self::NONE;
        for (i, (hz, part)) in points.iter().enumerate() {
            let angle = core::f64::consts::TAU * hz / rate_hz;
            (turns.sin[i], turns.cos[i]) = crate::trig::sincos(angle);
            turns.part[i] = *part;
        }
        turns
    }
}

/// Sums the power of an all-pole filter over all points.
struct AllPolePower<'a> {
    turns: &'a [Turns],
    coefficients: &'a [f64],
    power: &'a mut f64,
}

impl Work for AllPolePower<'_> {
    #[inline(always)]
    fn run(self) {
        // One sum per lane, added up once at the end, so that the order of additions does not
        // depend on the width of the registers.
        let mut sums = [0.0; TURNS];
        for Turns { cos, sin, part } in self.turns {
            // Horner's rule for Σ A_i z⁻ⁱ, with z⁻¹ = cos - i sin.
            let (mut re, mut im) = ([0.0; TURNS], [0.0; TURNS]);
            for a in self.coefficients.iter().rev() {
                for i in 0..TURNS {
                    let sum = re[i] + a;
                    (re[i], im[i]) = (sum * cos[i] + im[i] * sin[i], im[i] * cos[i] - sum * sin[i]);
                }
            }
            for i in 0..TURNS {
                let re = 1.0 - re[i];
                let heard = part[i] / (re * re + im[i] * im[i]);
                // A point with weight zero contributes nothing, even if a pole on the unit circle
                // makes `heard` NaN.
                sums[i] += if part[i] > 0.0 { heard } else { 0.0 };
            }
        }
        *self.power = sums.iter().sum();
    }
}

/// Sums the power of a filter with zeros and poles over all points.
struct RationalPower<'a> {
    turns: &'a [Turns],
    zeros: &'a [f64],
    poles: &'a [f64],
    power: &'a mut f64,
}

impl Work for RationalPower<'_> {
    #[inline(always)]
    fn run(self) {
        let mut sums = [0.0; TURNS];
        for turns in self.turns {
            let above = lines_power(turns, self.zeros);
            let below = lines_power(turns, self.poles);
            for i in 0..TURNS {
                let heard = turns.part[i] * above[i] / below[i];
                sums[i] += if turns.part[i] > 0.0 { heard } else { 0.0 };
            }
        }
        // Each pair of lines has a factor of 4 or 1/4, a power of two, so the products are exact.
        let [above, below] = [self.zeros, self.poles].map(|lines| lines.len() / 2);
        let power: f64 = sums.iter().sum();
        let power = (0..above).fold(power, |power, _| 4.0 * power);
        *self.power = (0..below).fold(power, |power, _| 0.25 * power);
    }
}

/// Squared absolute values of a polynomial at a group of points, divided by 4 for each pair of
/// lines. `cosines` are the cosines of its line spectral frequencies. These belong alternately to
/// the symmetric and the antisymmetric polynomial. On the unit circle the phases of these two
/// polynomials differ by a quarter turn, so their squares add.
#[inline(always)]
fn lines_power(turns: &Turns, cosines: &[f64]) -> [f64; TURNS] {
    let (mut symmetric, mut antisymmetric) = ([1.0; TURNS], [1.0; TURNS]);
    let (pairs, last) = cosines.as_chunks();
    for [a, b] in pairs {
        for i in 0..TURNS {
            symmetric[i] *= turns.cos[i] - a;
            antisymmetric[i] *= turns.cos[i] - b;
        }
    }
    for a in last {
        for i in 0..TURNS {
            symmetric[i] *= turns.cos[i] - a;
        }
    }
    let mut power = [0.0; TURNS];
    for i in 0..TURNS {
        // Each fixed factor of the two polynomials enters as the square of its absolute value.
        let sine = turns.sin[i] * turns.sin[i];
        let s = symmetric[i] * symmetric[i];
        let a = antisymmetric[i] * antisymmetric[i];
        power[i] = if last.is_empty() {
            // (1 - cos) = sin² / (1 + cos), which stays precise at low frequencies.
            let above = 1.0 + turns.cos[i];
            0.5 * (s * above + a * (sine / above))
        } else {
            // An odd number of lines has the fixed factors 1 and `1 - z⁻²`, and the latter has
            // the squared magnitude `4 sin²`.
            s + a * sine
        };
    }
    power
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::line_spectrum::line_spectral_frequencies;
    use crate::linear_prediction::ar_magnitude;

    #[test]
    fn the_level_of_a_filter_is_that_of_its_curve() {
        let passed = PassedPower::new(Band::TACTILE, 2_050.0);
        for coefficients in [&[][..], &[0.9], &[1.2, -0.8, 0.3, -0.1, 0.05, 0.02, -0.3]] {
            let expected = passed.level_rms(|hz| ar_magnitude(coefficients, hz, 2_050.0));
            let found = passed.all_pole_level_rms(coefficients);
            assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
        }
    }

    #[test]
    fn the_level_of_lines_is_that_of_their_polynomials() {
        let passed = PassedPower::new(Band::TACTILE, 2_050.0);
        let cosines = |a: &[f64]| -> Vec<f64> {
            let lines = line_spectral_frequencies(a).unwrap();
            lines.iter().map(|w| libm::cos(*w)).collect()
        };
        for poles in [&[][..], &[0.9], &[1.2, -0.8, 0.3, -0.1, 0.05, 0.02, -0.3]] {
            for zeros in [&[][..], &[-0.4, 0.3], &[-0.4, 0.3, 0.6]] {
                let of = |a: &[f64], hz: f64| ar_magnitude(a, hz, 2_050.0);
                let expected = passed.level_rms(|hz| of(poles, hz) / of(zeros, hz));
                let found = passed.rational_level_rms(&cosines(zeros), &cosines(poles));
                assert!((found / expected - 1.0).abs() < 1e-12, "{found} {expected}");
            }
        }
    }

    /// For white noise of unit variance, the mean square after the filters equals the mean of the
    /// filters' squared response. The energy of the impulse response equals the same mean.
    #[test]
    fn passed_power_equals_the_energy_of_the_impulse_response() {
        for (low_hz, high_hz, rate_hz) in [
            (20.0, 1000.0, 2_000.0),
            (20.0, 1000.0, 2_050.0),
            (20.0, 1000.0, 8_000.0),
            (23.0, 61.0, 2_000.0),
            (300.0, 800.0, 2_000.0),
        ] {
            let band = Band { low_hz, high_hz };
            let mut impulse = alloc::vec![[0.0; 2]; 1 << 16];
            impulse[0][0] = 1.0;
            band_limit(band, rate_hz).process(&mut impulse);
            let energy: f64 = impulse.as_flattened().iter().map(|x| x * x).sum();
            // Magnitude squared of white noise of unit variance: 2 P ENBW, P = 2 / rate.
            let magnitude = libm::sqrt(4.0 * 1.5 * GRID_HZ / rate_hz);
            let level = PassedPower::read_by(band, rate_hz, |_| 1.0).level_rms(|_| magnitude);
            let ratio = level / libm::sqrt(energy);
            assert!((ratio - 1.0).abs() < 2e-3, "{band:?} at {rate_hz}: {ratio}");
        }
    }
}
