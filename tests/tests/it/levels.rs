//! Levels belong to the shapes as stored.

use htex_author::{Level, SpectrumRef, stored_fields, stored_level};
use htex_dsp::peaks::select_peaks;
use htex_format::round_parameters;
use htex_host::{Band, Fit, FitCondition, FitInput, LoadedModel, Registry};
use proptest::prelude::*;

/// Number of spectra for each property: a sample, unless all are requested.
fn count() -> u32 {
    if xtask::prove::whole() { 10_000 } else { 2_000 }
}

const BAND: Band = Band::TACTILE;
/// Index of sBeta's option `bins`.
const SBETA_BINS: usize = 4;

/// A spectrum on the grid: straight lines between a few levels in decibels, with the noise of an
/// average. About one in four is steep towards an edge, where fits end at a bound of their
/// parameters.
fn spectra() -> impl Strategy<Value = Vec<f64>> {
    let knots = prop::collection::vec(-30.0..0.0_f64, 5);
    let steep = prop_oneof![3 => Just(0.0), 1 => 10.0..60.0_f64, 1 => -60.0..-10.0_f64];
    (knots, steep, 0.02..0.3_f64, any::<u64>()).prop_map(|(knots, steep, noise, seed)| {
        let mut state = seed | 1;
        let mut bins = Vec::with_capacity(BAND.bins());
        for bin in 0..BAND.bins() {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let scatter = 1.0 + noise * ((state >> 40) as f64 / (1u64 << 23) as f64 - 1.0);
            let x = htex_dsp::beta::log_unit(5.0 * (bin + 4) as f64, BAND);
            let place = (4.0 * x).min(3.999);
            let (below, part) = (place as usize, place.fract());
            let level_db = knots[below] * (1.0 - part) + knots[below + 1] * part - steep * x;
            bins.push(0.01 * scatter * 10f64.powf(level_db / 20.0));
        }
        bins
    })
}

/// A fit: its parameters as stored, and the matching level.
struct Stored {
    fit: Fit,
    parameters: Vec<f64>,
    fitted_n: f64,
    default_n: f64,
    shape: Vec<f64>,
}

/// `None` if the model has nothing to fit: sPeak, for a spectrum without a peak.
fn stored(model: &LoadedModel, options: &[f64], grid: &[f64], magnitude: &[f64]) -> Option<Stored> {
    let request = FitInput {
        band: BAND,
        frequency_hz: grid,
        magnitude,
        signal: &[],
        signal_rate_hz: 4_000.0,
        options,
        condition: FitCondition::default(),
    };
    let fit = model.fit(&request).ok()?;
    let parameters = round_parameters(&stored_fields(model.descriptor()), &fit.parameters).unwrap();
    let reference = SpectrumRef { band: BAND, frequency_hz: grid, magnitude };
    let level = |level| stored_level(model, &fit, &parameters, reference, level).unwrap();
    Some(Stored {
        fitted_n: level(Level::Fitted),
        default_n: level(Level::Recording),
        shape: model.magnitude(&parameters, BAND, grid).unwrap(),
        parameters,
        fit,
    })
}

fn rms(magnitude: &[f64]) -> f64 {
    (magnitude.iter().map(|m| m * m).sum::<f64>() / 3.0).sqrt()
}

/// The least-squares level of a shape for magnitudes at some bins.
fn least_squares(shape: &[f64], magnitude: &[f64], bins: impl Iterator<Item = usize>) -> f64 {
    let (mut both, mut own) = (0.0, 0.0);
    for bin in bins {
        both += shape[bin] * magnitude[bin];
        own += shape[bin] * shape[bin];
    }
    both / own
}

fn off_db(level: f64, wanted: f64) -> f64 {
    (20.0 * (level / wanted).log10()).abs()
}

/// The level of each model's fit for the stored shape, by its definition but computed in another
/// way than in the model. If a fit may end in several ways, the result must be one of several
/// levels.
fn wanted(
    model: &LoadedModel,
    options: &[f64],
    grid: &[f64],
    magnitude: &[f64],
    stored: &Stored,
) -> Vec<f64> {
    let bin = |hz: f64| (hz / 5.0) as usize - 4;
    match model.short_name() {
        "sbeta" => {
            let peaks = select_peaks(grid, magnitude, 10, 0.12);
            let peaks: Vec<usize> = peaks.iter().map(|peak| bin(peak.frequency_hz)).collect();
            match options[SBETA_BINS] as usize {
                0 => sbeta_levels(&stored.shape, grid, magnitude, &peaks),
                bins => sbeta_energy_levels(&stored.shape, grid, magnitude, &peaks, bins),
            }
        }
        // The recording's magnitude at the peak.
        "sslope" => {
            let peak = bin(stored.parameters[0]);
            vec![magnitude[peak] / stored.shape[peak]]
        }
        // Least squares over the band, for the fitted data.
        _ => {
            let fitted = model.magnitude(&stored.fit.parameters, BAND, grid).unwrap();
            let newtons: Vec<f64> = fitted.iter().map(|m| m * stored.fit.level_rms).collect();
            vec![least_squares(&stored.shape, &newtons, 0..grid.len())]
        }
    }
}

/// Bins evenly spaced in log frequency; the largest one comes last.
fn spread(count: usize, grid: &[f64], magnitude: &[f64]) -> Vec<usize> {
    let larger = |a: &usize, b: &usize| magnitude[*a].total_cmp(&magnitude[*b]);
    let largest = (0..grid.len()).max_by(larger).unwrap();
    let mut spread: Vec<usize> = (0..count)
        .map(|i| {
            let hz = 20.0 * 50f64.powf(i as f64 / (count - 1) as f64);
            grid.partition_point(|g| *g < hz).min(grid.len() - 1)
        })
        .collect();
    if !spread.contains(&largest) {
        spread.push(largest);
    }
    spread
}

/// The level at which a shape is as high as the largest bin.
fn as_high(shape: &[f64], magnitude: &[f64]) -> f64 {
    let highest = |values: &[f64]| values.iter().copied().fold(0.0, f64::max);
    highest(magnitude) / highest(shape)
}

/// Least squares at the ten peaks. Bins from the whole band are added if the density would exceed
/// twice the largest bin or there are too few peaks. If it still does, the shape is as high as the
/// largest bin.
fn sbeta_levels(shape: &[f64], grid: &[f64], magnitude: &[f64], peaks: &[usize]) -> Vec<f64> {
    let spread = spread(10, grid, magnitude);
    let all = peaks.iter().chain(&spread).copied();
    vec![
        least_squares(shape, magnitude, peaks.iter().copied()),
        least_squares(shape, magnitude, all),
        least_squares(shape, magnitude, spread.iter().copied()),
        as_high(shape, magnitude),
    ]
}

/// The energy of the peaks and bins, or the level at which the shape is as high as the largest bin.
fn sbeta_energy_levels(
    shape: &[f64],
    grid: &[f64],
    magnitude: &[f64],
    peaks: &[usize],
    bins: usize,
) -> Vec<f64> {
    let spread = spread(bins, grid, magnitude);
    let points = || peaks.iter().chain(&spread);
    let energy = |values: &[f64]| points().map(|bin| values[*bin].powi(2)).sum::<f64>();
    let level = (energy(magnitude) / energy(shape)).sqrt();
    vec![level, as_high(shape, magnitude)]
}

fn hold(name: &str, options: &[(&str, &str)]) {
    let model = Registry::builtin().find(name).unwrap().clone();
    let options = model.options(options).unwrap();
    let grid = BAND.grid_hz();
    let config = ProptestConfig {
        failure_persistence: None,
        max_global_rejects: count(),
        ..ProptestConfig::with_cases(count())
    };
    proptest!(config, |(magnitude in spectra())| {
        let stored = stored(&model, &options, &grid, &magnitude);
        prop_assume!(stored.is_some());
        let stored = stored.unwrap();
        let played: Vec<f64> = stored.shape.iter().map(|m| m * stored.default_n).collect();
        let recorded = if model.descriptor().keeps_level { stored.fitted_n } else { rms(&magnitude) };
        let part = model.played_part(&stored.parameters, BAND).unwrap();
        prop_assert!(off_db(part * rms(&played), recorded) < 0.02);
        let wanted = wanted(&model, &options, &grid, &magnitude, &stored);
        prop_assert!(
            wanted.iter().any(|wanted| off_db(stored.fitted_n, *wanted) < 0.02),
            "{:?}: {} N, and {wanted:?} N by least squares", stored.parameters, stored.fitted_n
        );
    });
}

#[test]
fn ar() {
    hold("ar", &[]);
}

#[test]
fn mfcc() {
    hold("mfcc", &[]);
}

#[test]
fn speak() {
    hold("speak", &[]);
}

#[test]
fn sbeta() {
    hold("sbeta", &[]);
}

#[test]
fn sbeta_as_in_the_paper() {
    let paper = [("error", "magnitude"), ("lower_bound", "1"), ("bins", "0"), ("refit", "never")];
    hold("sbeta", &paper);
}

#[test]
fn sslope() {
    // Not a multiple of the steps in which files store orders.
    hold("sslope", &[("rounding_db_per_decade", "1.37")]);
}

#[test]
fn bands() {
    hold("bands", &[]);
}
