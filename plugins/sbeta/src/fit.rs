//! Least-squares fit of the density to the spectrum's peaks (paper: fminsearch on ten peaks, cost function
//! not stated).
//!
//! A fit is limited to twice the largest bin: with all peaks on one side the density fits best with a spike where there
//! is no peak, many decibels too high.

use alloc::vec::Vec;

use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::nelder_mead::{Minimum, Options, minimize};
use htex_dsp::peaks::{Peak, select_peaks};
use htex_model::{Error, Fit, FitInput};

use crate::Profile;

const POINTS: usize = 0;
const JND: usize = 1;
const LOWER_BOUND: usize = 2;
const ERROR: usize = 3;

/// Starting points (numeric definitions: sBeta).
const STARTS: [(f64, f64); 4] = [(2.0, 2.0), (1.5, 3.0), (3.0, 1.5), (4.0, 4.0)];
/// Smallest parameter the descriptor allows.
const SMALLEST: f64 = 1e-3;
/// Largest parameter of the search: beyond it the density is narrower than a bin.
const LARGEST: f64 = 1e4;
/// The fit has three unknowns, two shapes and a scale: fewer peaks leave it undetermined.
const FEWEST_PEAKS: usize = 3;
/// Limit for a fit's maximum, relative to the spectrum's largest bin. A fit above it has its energy where
/// there is no peak to constrain it; it is fitted again to bins spread over the band and scaled down to the
/// largest bin.
const HIGHEST: f64 = 2.0;
/// Residual, as part of the points' squared magnitude, from which a density counts as not matching the
/// points.
const NOTHING_EXPLAINED: f64 = 0.99;
/// Lower limit, relative to the largest, of points and densities compared in decibels.
const FAINTEST: f64 = 1e-6;

/// Measure minimised at the points, relative to their own size.
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
        return Err(Error::cannot_fit(
            "the spectrum is silent: there is no profile to fit",
        ));
    }
    // Relative magnitudes, so that the tolerances mean the same for a whisper and a blow.
    let relative: Vec<f64> = input.magnitude.iter().map(|m| m / largest).collect();
    let (count, jnd) = (input.options[POINTS] as usize, input.options[JND]);
    let mut points = select_peaks(input.frequency_hz, &relative, count, jnd);
    if points.len() < FEWEST_PEAKS {
        points = spread_bins(input, &relative);
    }
    let mut fitted = Fitted::to(&points, input);
    if fitted.highest > HIGHEST {
        points.extend(spread_bins(input, &relative));
        fitted = Fitted::to(&points, input);
    }
    let level = match fitted.highest > HIGHEST {
        true => fitted.level / fitted.highest,
        false => fitted.level,
    };
    Ok(Fit {
        parameters: vec![fitted.alpha, fitted.beta],
        level_rms: largest * level,
    })
}

/// A density, the RMS of its magnitude, and its maximum over the bins, relative to the spectrum's largest.
struct Fitted {
    alpha: f64,
    beta: f64,
    level: f64,
    highest: f64,
}

impl Fitted {
    fn to(points: &[Peak], input: &FitInput<'_>) -> Self {
        let band: Band = input.band;
        let bound = input.options[LOWER_BOUND].max(SMALLEST);
        let distance = match input.options[ERROR] as u32 {
            0 => Distance::Magnitude,
            _ => Distance::Decibel,
        };
        // The scale belongs to the parameters as files store them, in single precision: near 1 rounding
        // changes the density at an edge completely, as it is zero there for 1 + 1e-16 and may have its
        // maximum there for 1.
        let (alpha, beta) = fit_points(points, band, bound, distance);
        let [alpha, beta] = [alpha, beta].map(|parameter| f64::from(parameter as f32));
        let profile = Profile::new(alpha, beta, band);
        let (scale, _) = distance.best_scale(points, &profile);
        let at = |f: f64| scale * profile.at(f);
        let bins = input.frequency_hz.iter();
        Self {
            alpha,
            beta,
            level: curve_level_rms(band, at),
            highest: bins.map(|&f| at(f)).fold(0.0, f64::max),
        }
    }
}

/// As many bins as points are wanted, evenly spaced in log frequency, and the largest bin, which may be the
/// only nonzero one.
fn spread_bins(input: &FitInput<'_>, magnitude: &[f64]) -> Vec<Peak> {
    let band: Band = input.band;
    let ratio = band.high_hz / band.low_hz;
    let (count, last) = (input.options[POINTS] as usize, magnitude.len() - 1);
    let mut bins: Vec<usize> = (0..count)
        .map(|i| {
            let f = band.low_hz * libm::pow(ratio, i as f64 / (count - 1) as f64);
            input.frequency_hz.partition_point(|&g| g < f).min(last)
        })
        .collect();
    let larger = |&a: &usize, &b: &usize| magnitude[a].total_cmp(&magnitude[b]);
    let largest = (0..=last).max_by(larger).unwrap_or(0);
    if !bins.contains(&largest) {
        bins.push(largest);
    }
    let point = |bin: usize| Peak {
        frequency_hz: input.frequency_hz[bin],
        magnitude: magnitude[bin],
    };
    bins.into_iter().map(point).collect()
}

/// Returns the alpha and beta, each at least `bound`, with the smallest distance to the points.
fn fit_points(points: &[Peak], band: Band, bound: f64, distance: Distance) -> (f64, f64) {
    let shape = |x: f64| (bound + x * x).min(LARGEST);
    let profile = |x: &[f64; 2]| Profile::new(shape(x[0]), shape(x[1]), band);
    let cost = |x: &[f64; 2]| distance.best_scale(points, &profile(x)).1;
    let options = Options::default();
    let search = |(alpha, beta): (f64, f64)| {
        let start = [alpha, beta].map(|s: f64| htex_dsp::root::sqrt((s - bound).max(0.0)));
        minimize(cost, start, &options)
    };
    let better = |best: Minimum<2>, next: Minimum<2>| match next.value < best.value {
        true => next,
        false => best,
    };
    let mut best = STARTS.into_iter().map(search).reduce(better);
    if best.is_none_or(|best| best.value > NOTHING_EXPLAINED) {
        // At an edge a density with parameters above 1 is 0 and has no gradient.
        let at_edges = [(bound, 4.0), (4.0, bound)].into_iter().map(search);
        best = best.into_iter().chain(at_edges).reduce(better);
    }
    best.map_or((2.0, 2.0), |m| (shape(m.x[0]), shape(m.x[1])))
}

impl Distance {
    /// The optimal scale in closed form, and its distance; NaN, which the search rejects, if the density is
    /// not finite or is zero at all points.
    fn best_scale(self, points: &[Peak], profile: &Profile) -> (f64, f64) {
        match self {
            Self::Magnitude => least_squares(points, profile),
            Self::Decibel => least_decibels(points, profile),
        }
    }
}

/// By the squared differences of magnitudes, relative to the sum of the points' squares.
fn least_squares(points: &[Peak], profile: &Profile) -> (f64, f64) {
    let (mut pp, mut pm, mut mm) = (0.0, 0.0, 0.0);
    for point in points {
        let p = profile.at(point.frequency_hz);
        pp += p * p;
        pm += p * point.magnitude;
        mm += point.magnitude * point.magnitude;
    }
    let scale = pm / pp;
    let residual: f64 = points
        .iter()
        .map(|point| scale * profile.at(point.frequency_hz) - point.magnitude)
        .map(|r| r * r)
        .sum();
    (scale, residual / mm)
}

/// By the mean squared difference of natural logarithms. The band's edges, where a density may be 0 however
/// well it fits elsewhere, are excluded.
fn least_decibels(points: &[Peak], profile: &Profile) -> (f64, f64) {
    let Band { low_hz, high_hz } = profile.band;
    let inside = |point: &&Peak| low_hz < point.frequency_hz && point.frequency_hz < high_hz;
    let points = || points.iter().filter(inside);
    let density = |point: &Peak| profile.at(point.frequency_hz);
    let least_density = FAINTEST * points().map(density).fold(0.0, f64::max);
    let least_magnitude = FAINTEST * points().map(|point| point.magnitude).fold(0.0, f64::max);
    let (mut count, mut sum, mut squares) = (0.0, 0.0, 0.0);
    for point in points() {
        let magnitude = point.magnitude.max(least_magnitude);
        let ratio = libm::log(magnitude) - libm::log(density(point).max(least_density));
        count += 1.0;
        sum += ratio;
        squares += ratio * ratio;
    }
    let mean = sum / count;
    (libm::exp(mean), squares / count - mean * mean)
}
