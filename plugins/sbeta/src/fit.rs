//! Least squares of the density to the spectrum's peaks (paper: fminsearch on ten peaks).

use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::nelder_mead::{Minimum, Options, minimize};
use htex_dsp::peaks::{Peak, select_peaks};
use htex_model::{Error, Fit, FitInput};

use crate::density;

const POINTS: usize = 0;
const JND: usize = 1;
const LOWER_BOUND: usize = 2;

/// Starting points (numeric definitions: sBeta).
const STARTS: [(f64, f64); 4] = [(2.0, 2.0), (1.5, 3.0), (3.0, 1.5), (4.0, 4.0)];
/// Smallest parameter the descriptor allows.
const SMALLEST: f64 = 1e-3;
/// Largest parameter the search tries: beyond it the density is narrower than a bin.
const LARGEST: f64 = 1e4;
/// Fewer peaks than parameters (two shapes and a scale) leave the fit undetermined.
const FEWEST_PEAKS: usize = 3;

pub(crate) fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
    let band: Band = input.band.edges().into();
    let points = reference_points(input);
    let largest = points.iter().map(|p| p.magnitude).fold(0.0, f64::max);
    if largest <= 0.0 {
        return Err(Error::cannot_fit(
            "the spectrum is silent: there is no profile to fit",
        ));
    }
    // Relative magnitudes, so that the tolerances mean the same for a whisper and a blow.
    let points: Vec<Peak> = points
        .iter()
        .map(|p| Peak {
            magnitude: p.magnitude / largest,
            ..*p
        })
        .collect();
    let bound = input.options[LOWER_BOUND].max(SMALLEST);
    let (alpha, beta) = fit_points(&points, band, bound);
    let scale = best_scale(&points, band, alpha, beta).map_or(0.0, |(scale, _)| scale);
    let level = curve_level_rms(band, |f| density(alpha, beta, band, f));
    Ok(Fit {
        parameters: vec![alpha, beta],
        level_rms: largest * scale * level,
    })
}

/// The spectrum's peaks; where there are too few, as many bins evenly spaced in log frequency.
fn reference_points(input: &FitInput<'_>) -> Vec<Peak> {
    let count = input.options[POINTS] as usize;
    let peaks = select_peaks(
        input.frequency_hz,
        input.magnitude,
        count,
        input.options[JND],
    );
    if peaks.len() >= FEWEST_PEAKS {
        return peaks;
    }
    let band: Band = input.band.edges().into();
    let ratio = band.high_hz / band.low_hz;
    (0..count)
        .map(|i| {
            let f = band.low_hz * libm::pow(ratio, i as f64 / (count - 1) as f64);
            let above = input.frequency_hz.partition_point(|&g| g < f);
            let bin = above.min(input.frequency_hz.len() - 1);
            Peak {
                frequency_hz: input.frequency_hz[bin],
                magnitude: input.magnitude[bin],
            }
        })
        .collect()
}

/// Alpha and beta, each at least `bound`, of least squared distance to the points.
pub(crate) fn fit_points(points: &[Peak], band: Band, bound: f64) -> (f64, f64) {
    let shape = |x: f64| (bound + x * x).min(LARGEST);
    let cost = |x: &[f64; 2]| {
        best_scale(points, band, shape(x[0]), shape(x[1])).map_or(f64::INFINITY, |(_, cost)| cost)
    };
    let options = Options::default();
    let best = STARTS
        .iter()
        .map(|&(alpha, beta)| {
            let start = [alpha, beta].map(|s: f64| libm::sqrt(s - bound));
            minimize(cost, start, &options)
        })
        .reduce(|best: Minimum<2>, next| if next.value < best.value { next } else { best });
    best.map_or((2.0, 2.0), |m| (shape(m.x[0]), shape(m.x[1])))
}

/// The scale of least squares, in closed form, and the squared distance it leaves relative to the
/// points' own; `None` where the density is not finite or zero at all points.
fn best_scale(points: &[Peak], band: Band, alpha: f64, beta: f64) -> Option<(f64, f64)> {
    let (mut pp, mut pm, mut mm) = (0.0, 0.0, 0.0);
    for point in points {
        let p = density(alpha, beta, band, point.frequency_hz);
        pp += p * p;
        pm += p * point.magnitude;
        mm += point.magnitude * point.magnitude;
    }
    if !(pp > 0.0 && pp.is_finite() && mm > 0.0) {
        return None;
    }
    let scale = pm / pp;
    let residual: f64 = points
        .iter()
        .map(|point| scale * density(alpha, beta, band, point.frequency_hz) - point.magnitude)
        .map(|r| r * r)
        .sum();
    Some((scale, residual / mm))
}
