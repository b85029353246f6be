//! Fits the beta density to the spectrum's peaks and to bins spread over the frequency band. The
//! fit minimises squared differences of decibels or of magnitudes. (The paper uses fminsearch on
//! ten peaks and does not state the cost function.)
//!
//! The paper's method corresponds to `error=magnitude`, `lower_bound=1`, `bins=0`, `refit=never`.
//! It has two weaknesses: a fit of squared magnitudes follows only the strongest peaks, and peaks
//! give no information about the frequencies between them. Each cell of the table has three errors
//! in dB: the median, the mean and the largest. The columns headed "recordings" are about 32
//! third-party recordings. In 24 of these recordings, the band is from 20 to 1000 Hz. In the other
//! eight, the band is from 60 to 1000 Hz. If half the sample rate is lower than this upper end, the
//! band ends at half the sample rate. The columns headed "simulated" are about 15 simulated
//! recordings (five surfaces, three seeds).
//!
//! | options | recordings, nine bands | third octaves | simulated, nine bands | third octaves |
//! |---|---|---|---|---|
//! | the paper's | 5.0, 8.5, 33.9 | 11.2, 21.2, 70.2 | 5.2, 11.0, 66.7 | 10.2, 19.4, 95.0 |
//! | the paper's, the second fit always kept | 5.0, 8.5, 33.9 | 11.2, 21.2, 70.2 | 5.2, 14.7, 77.9 | 10.2, 25.0, 118.4 |
//! | `decibel`, bound 1, no bins | 4.8, 5.7, 13.3 | 10.0, 16.0, 49.9 | 3.9, 3.9, 6.7 | 9.7, 9.1, 14.4 |
//! | `decibel`, bound 0.2, no bins | 4.3, 5.0, 14.3 | 7.6, 15.3, 49.9 | 3.9, 4.5, 11.4 | 9.7, 9.2, 14.4 |
//! | `decibel`, bound 1, 20 bins | 2.6, 3.1, 10.0 | 4.3, 9.6, 48.4 | 2.8, 2.9, 5.7 | 4.5, 4.9, 8.3 |
//! | `decibel`, bound 0.2, 20 bins | 2.3, 3.0, 10.6 | 4.1, 9.6, 48.4 | 2.8, 2.8, 5.7 | 4.6, 4.9, 8.3 |
//! | the default: `decibel`, bound 0.5, 20 bins | 2.3, 2.8, 7.9 | 4.1, 9.4, 48.4 | 2.8, 2.8, 5.7 | 4.6, 4.9, 8.3 |
//!
//! If all peaks are on one side of the band, the density that fits the peaks best has a spike at
//! frequencies without a peak. This spike is many decibels too high. Therefore, if the maximum of a
//! fit to peaks is higher than twice the largest bin, the plugin makes a second fit, to peaks and
//! bins. To compare the two fits, the plugin scales each of them so that its distance to the peaks
//! and bins is as small as possible. The result is the fit with the smaller distance, in decibels,
//! to the peaks and bins. The option `refit=never` keeps the first fit.
//!
//! With `error=decibel`, the fit has a closed form ([`crate::decibels`]), and its level gives the
//! density the same energy as the fitted points. If the density is still higher than twice the
//! largest bin, its level is reduced until its maximum equals the largest bin.

use alloc::vec::Vec;

use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::nelder_mead::{Minimum, Options, minimize};
use htex_dsp::peaks::{Peak, select_peaks};
use htex_model::{Error, Fit, FitInput};

use crate::Profile;
use crate::decibels::{least_decibels, nearest};

const POINTS: usize = 0;
const JND: usize = 1;
const LOWER_BOUND: usize = 2;
const ERROR: usize = 3;
const BINS: usize = 4;
const REFIT: usize = 5;

/// Starting points of the search (numeric definitions: sBeta).
const STARTS: [(f64, f64); 4] = [(2.0, 2.0), (1.5, 3.0), (3.0, 1.5), (4.0, 4.0)];
/// Smallest parameter the descriptor allows.
const SMALLEST: f64 = 1e-3;
/// Largest parameter of the search. With a larger parameter, the density would be narrower than a
/// bin.
const LARGEST: f64 = 1e4;
/// Smallest number of peaks. The fit has three unknowns: two shape parameters and a scale.
const FEWEST_PEAKS: usize = 3;
/// Largest allowed maximum of a fit, relative to the spectrum's largest bin. A fit with a higher
/// maximum has its energy at frequencies where no point constrains it.
const HIGHEST: f64 = 2.0;
/// Residual, as a part of the points' squared magnitude, above which a density counts as not
/// matching the points.
const NOTHING_EXPLAINED: f64 = 0.99;

/// The cost that the fit minimises at the points. It does not depend on the scale of the points.
#[derive(Clone, Copy)]
enum Distance {
    /// Squared differences of magnitudes.
    Magnitude,
    /// Squared differences of logarithms.
    Decibel,
}

pub(crate) fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
    let largest = input.magnitude.iter().copied().fold(0.0, f64::max);
    if largest <= 0.0 {
        return Err(Error::cannot_fit("the spectrum is silent: there is no profile to fit"));
    }
    // Relative magnitudes, so that tolerances have the same effect for weak and strong signals.
    let relative: Vec<f64> = input.magnitude.iter().map(|m| m / largest).collect();
    let (count, jnd) = (input.options[POINTS] as usize, input.options[JND]);
    let peaks = select_peaks(input.frequency_hz, &relative, count, jnd);
    let bins = input.options[BINS] as usize;
    let fitted = match bins {
        0 => to_peaks(peaks, input, &relative),
        _ => to_peaks_and_bins(&peaks, bins, input, &relative),
    };
    let level = if fitted.highest > HIGHEST { fitted.level / fitted.highest } else { fitted.level };
    Ok(Fit { parameters: vec![fitted.alpha, fitted.beta], level_rms: largest * level })
}

fn to_peaks_and_bins(
    peaks: &[Peak],
    bins: usize,
    input: &FitInput<'_>,
    relative: &[f64],
) -> DensityFit {
    let points = [peaks, &spread_bins(bins, input, relative)].concat();
    DensityFit::to(&points, input)
}

/// Fits only the peaks. If the peaks leave the fit undetermined or too high, also fits the same
/// number of bins.
fn to_peaks(peaks: Vec<Peak>, input: &FitInput<'_>, relative: &[f64]) -> DensityFit {
    let bins = spread_bins(input.options[POINTS] as usize, input, relative);
    if peaks.len() < FEWEST_PEAKS {
        return DensityFit::to(&bins, input);
    }
    let first = DensityFit::to(&peaks, input);
    let never = input.options[REFIT] as u32 == 1;
    if first.highest <= HIGHEST || never {
        return first;
    }
    let points = [peaks, bins].concat();
    let second = DensityFit::to(&points, input);
    let distance = |fitted: &DensityFit| least_decibels(&points, &fitted.profile(input.band)).1;
    if distance(&first) < distance(&second) { first } else { second }
}

/// A fitted density, with the RMS of its magnitude (`level`) and its maximum over the bins
/// (`highest`). Both are relative to the spectrum's largest bin.
struct DensityFit {
    alpha: f64,
    beta: f64,
    level: f64,
    highest: f64,
}

impl DensityFit {
    fn to(points: &[Peak], input: &FitInput<'_>) -> Self {
        let band: Band = input.band;
        let bound = input.options[LOWER_BOUND].max(SMALLEST);
        let distance = match input.options[ERROR] as u32 {
            0 => Distance::Decibel,
            _ => Distance::Magnitude,
        };
        // The scale must belong to the parameters as files store them, in single precision. Near 1,
        // rounding changes the density at an edge completely: for 1 + 1e-16 it is zero there, for 1
        // it may have its maximum there.
        let (alpha, beta) = fit_points(points, band, bound, distance);
        let [alpha, beta] = [alpha, beta].map(|parameter| f64::from(parameter as f32));
        let profile = Profile::new(alpha, beta, band);
        let scale = distance.level_scale(points, &profile);
        let at = |f: f64| scale * profile.density_at(f);
        let bins = input.frequency_hz.iter();
        Self {
            alpha,
            beta,
            level: curve_level_rms(band, at),
            highest: bins.map(|&f| at(f)).fold(0.0, f64::max),
        }
    }

    fn profile(&self, band: Band) -> Profile {
        Profile::new(self.alpha, self.beta, band)
    }
}

/// Returns `count` bins that are evenly spaced in log frequency, and the largest bin, because it
/// may be the only nonzero bin. Bins may occur twice.
fn spread_bins(count: usize, input: &FitInput<'_>, magnitude: &[f64]) -> Vec<Peak> {
    let band: Band = input.band;
    let ratio = band.high_hz / band.low_hz;
    let (last, steps) = (magnitude.len() - 1, count.saturating_sub(1).max(1));
    let mut bins: Vec<usize> = (0..count)
        .map(|i| {
            let f = band.low_hz * libm::pow(ratio, i as f64 / steps as f64);
            input.frequency_hz.partition_point(|&g| g < f).min(last)
        })
        .collect();
    let larger = |&a: &usize, &b: &usize| magnitude[a].total_cmp(&magnitude[b]);
    let largest = (0..=last).max_by(larger).unwrap_or(0);
    if !bins.contains(&largest) {
        bins.push(largest);
    }
    let point =
        |bin: usize| Peak { frequency_hz: input.frequency_hz[bin], magnitude: magnitude[bin] };
    bins.into_iter().map(point).collect()
}

/// Returns the alpha and beta, each at least `bound`, with the smallest distance to the points.
fn fit_points(points: &[Peak], band: Band, bound: f64, distance: Distance) -> (f64, f64) {
    let closed = match distance {
        Distance::Decibel => nearest(points, band, [bound, LARGEST]),
        Distance::Magnitude => None,
    };
    closed.unwrap_or_else(|| search_points(points, band, bound, distance))
}

/// Does the same as [`fit_points`], with a search from several starting points.
fn search_points(points: &[Peak], band: Band, bound: f64, distance: Distance) -> (f64, f64) {
    let shape = |x: f64| (bound + x * x).min(LARGEST);
    let profile = |x: &[f64; 2]| Profile::new(shape(x[0]), shape(x[1]), band);
    let cost = |x: &[f64; 2]| distance.best_scale(points, &profile(x)).1;
    let options = Options::default();
    let search = |(alpha, beta): (f64, f64)| {
        let start = [alpha, beta].map(|s: f64| htex_dsp::root::sqrt((s - bound).max(0.0)));
        minimize(cost, start, &options)
    };
    let better =
        |best: Minimum<2>, next: Minimum<2>| if next.value < best.value { next } else { best };
    let mut best = STARTS.into_iter().map(search).reduce(better);
    if best.is_none_or(|best| best.value > NOTHING_EXPLAINED) {
        // At an edge, a density with parameters above 1 is 0 and has no gradient, so a search could
        // not leave it.
        let at_edges = [(bound, 4.0), (4.0, bound)].into_iter().map(search);
        best = best.into_iter().chain(at_edges).reduce(better);
    }
    best.map_or((2.0, 2.0), |m| (shape(m.x[0]), shape(m.x[1])))
}

impl Distance {
    /// Returns the best scale in closed form, and the distance at this scale. If the density is not
    /// finite, or zero at all points, the distance is NaN, which the search rejects.
    fn best_scale(self, points: &[Peak], profile: &Profile) -> (f64, f64) {
        match self {
            Self::Magnitude => least_squares(points, profile),
            Self::Decibel => least_decibels(points, profile),
        }
    }

    /// Returns the scale that determines the level. With `decibel`, it is not the best scale: next
    /// to a line, faint points determine the best scale, but nearly all energy is in the line.
    fn level_scale(self, points: &[Peak], profile: &Profile) -> f64 {
        match self {
            Self::Magnitude => least_squares(points, profile).0,
            Self::Decibel => equal_energy(points, profile),
        }
    }
}

/// Returns the scale at which a density has the energy of the points.
fn equal_energy(points: &[Peak], profile: &Profile) -> f64 {
    let density = |point: &Peak| profile.density_at(point.frequency_hz);
    let fitted: f64 = points.iter().map(density).map(|p| p * p).sum();
    let wanted: f64 = points.iter().map(|p| p.magnitude * p.magnitude).sum();
    htex_dsp::root::sqrt(wanted / fitted)
}

/// Returns the best scale, and the squared differences of magnitudes relative to the sum of the
/// points' squares.
fn least_squares(points: &[Peak], profile: &Profile) -> (f64, f64) {
    let (mut pp, mut pm, mut mm) = (0.0, 0.0, 0.0);
    for point in points {
        let p = profile.density_at(point.frequency_hz);
        pp += p * p;
        pm += p * point.magnitude;
        mm += point.magnitude * point.magnitude;
    }
    let scale = pm / pp;
    let residual: f64 = points
        .iter()
        .map(|point| scale * profile.density_at(point.frequency_hz) - point.magnitude)
        .map(|r| r * r)
        .sum();
    (scale, residual / mm)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points whose levels vary by up to 60 dB over the band. Some of them fall towards an edge.
    fn points(seed: u32) -> Vec<Peak> {
        let mut state = seed;
        let mut next = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            f64::from(state) / f64::from(u32::MAX)
        };
        let (tilt, bend) = (next() - 0.5, next() - 0.5);
        let point = |i: i32| {
            let u = (f64::from(i) + 0.5) / 30.0;
            let level_db = 60.0 * (tilt * u + bend * (2.0 * u - 1.0).powi(2)) + 6.0 * next();
            Peak {
                frequency_hz: 20.0 * libm::pow(50.0, u),
                magnitude: libm::pow(10.0, level_db / 20.0),
            }
        };
        (0..30).map(point).collect()
    }

    #[test]
    fn the_closed_form_is_no_further_off_than_a_search() {
        let band = Band::TACTILE;
        let mut closed = 0;
        for seed in 0..300 {
            let (points, bound) = (points(seed), if seed % 2 == 0 { 0.5 } else { 1.0 });
            let distance = |(alpha, beta)| {
                let profile = Profile::new(alpha, beta, band);
                least_decibels(&points, &profile).1
            };
            let Some(found) = nearest(&points, band, [bound, LARGEST]) else {
                continue;
            };
            closed += 1;
            assert!(found.0 >= bound && found.1 >= bound, "{found:?}");
            let searched = search_points(&points, band, bound, Distance::Decibel);
            let [own, other] = [distance(found), distance(searched)];
            assert!(own <= other + 1e-9, "{seed}: {own} at {found:?}, {other} at {searched:?}");
        }
        assert!(closed > 290, "{closed}");
    }
}
