//! Properties of the model: bands keep their energies, and the curve does not add structure between
//! knots.
#![allow(clippy::unwrap_used)] // A failed unwrap is a failed test.

use htex_bands::{BandEnergies, FLOOR_DB, Spectrum};
use htex_dsp::bands::{BandBank, band_error_db, rms};
use htex_dsp::grid::{Band, level_rms};
use htex_model::shaped::Curve;
use htex_model::{Error, Fit, FitCondition, FitInput, Model, Numbers, Status, Values, Voice};
use proptest::prelude::*;

const WITHIN: f64 = 1.0;
const EDGES: f64 = 2.0;

fn fit(magnitude: &[f64], band: Band, options: [f64; 3]) -> Result<Fit, Error> {
    BandEnergies::fit(&FitInput {
        band,
        frequency_hz: &band.grid_hz(),
        magnitude,
        signal: &[],
        signal_rate_hz: 20_000.0,
        options: &options,
        condition: FitCondition::default(),
    })
}

/// Returns the shape's magnitude on the grid.
fn shape(parameters: &[f64], band: Band) -> Vec<f64> {
    let descriptor = BandEnergies::DESCRIPTOR;
    let values = Values::read(&descriptor, parameters).unwrap();
    let grid = band.grid_hz();
    let mut magnitude = vec![f64::NAN; grid.len()];
    BandEnergies::magnitude(&values, band, &grid, &mut magnitude).unwrap();
    magnitude
}

/// Returns the magnitude of the shape on the grid, multiplied by the level.
fn played(fit: &Fit, band: Band) -> Vec<f64> {
    let shape = shape(&fit.parameters, band);
    shape.iter().map(|m| m * fit.level_rms).collect()
}

/// Returns the errors of the energies in log-spaced triangles within the band, dB.
fn errors_db(magnitude: &[f64], fit: &Fit, band: Band, bands: usize) -> Vec<f64> {
    let bank = BandBank::new(bands, band, &band.grid_hz());
    band_error_db(&bank.energies(magnitude), &bank.energies(&played(fit, band)))
}

/// Makes magnitudes of averaged noise with a piecewise linear envelope, similar to recordings.
fn noisy(band: Band) -> impl Strategy<Value = Vec<f64>> {
    let bins = proptest::collection::vec(0.3..2.0, band.bins());
    (bins, -2.0..2.0).prop_map(move |(bins, slope): (Vec<f64>, f64)| {
        let grid = band.grid_hz();
        let envelope = grid.iter().map(|f| (f / 150.0).powf(slope));
        bins.iter().zip(envelope).map(|(b, e)| 1e-3 * b * e).collect()
    })
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 300, failure_persistence: None, ..Default::default() })]

    /// Rounding moves a knot by up to half a step. The gain that restores the total energy adds up
    /// to half a step more.
    #[test]
    fn few_bands_keep_their_energies_to_a_step(
        magnitude in noisy(Band::TACTILE), bands in 1usize..=19, step_db in 0.05..2.0,
    ) {
        let fit = fit(&magnitude, Band::TACTILE, [bands as f64, step_db, 0.0]).unwrap();
        prop_assert_eq!(fit.parameters[bands + 2], 0.0);
        let step_db = fit.parameters[bands + 1];
        for error in errors_db(&magnitude, &fit, Band::TACTILE, bands) {
            prop_assert!(error.abs() < step_db + 0.02, "{bands} bands, {step_db}: {error} dB");
        }
    }

    /// The two lowest of nine bands, below 45 Hz, have few bins. If these bins differ by 16 dB, a
    /// curve that is linear in decibels cannot match all energies.
    #[test]
    fn many_bands_keep_nine_energies_and_the_level(magnitude in noisy(Band::TACTILE), bands in 20usize..=64) {
        let fit = fit(&magnitude, Band::TACTILE, [bands as f64, 0.5, 0.0]).unwrap();
        prop_assert_eq!(fit.parameters[bands + 2], 1.0);
        let errors = errors_db(&magnitude, &fit, Band::TACTILE, 9);
        prop_assert!(rms(&errors[2..]) < 0.5, "{bands} bands: {errors:?}");
        prop_assert!(errors.iter().all(|e| e.abs() < 4.0), "{bands} bands: {errors:?}");
        prop_assert!((fit.level_rms / level_rms(&magnitude) - 1.0).abs() < 1e-9);
    }

    #[test]
    fn the_curve_is_monotonic_between_knots(
        below in proptest::collection::vec(0.0..255.0, 1..=40),
        step_db in 0.05..6.0,
    ) {
        let count = below.len();
        let parameters = [&[count as f64][..], &below, &[step_db, 0.0]].concat();
        let band = Band::TACTILE;
        let magnitude = shape(&parameters, band);
        prop_assert!(magnitude.iter().all(|m| m.is_finite() && *m >= 0.0));
        prop_assert!((level_rms(&magnitude) - 1.0).abs() < 1e-9);
        let bank = BandBank::new(count, band, &band.grid_hz());
        let edges = bank.edges_hz();
        for apexes in edges.windows(2) {
            let inside: Vec<f64> = band
                .grid_hz()
                .iter()
                .zip(&magnitude)
                .filter(|(f, _)| (apexes[0]..=apexes[1]).contains(*f))
                .map(|(_, m)| *m)
                .collect();
            let slack = 1e-9;
            let rises = inside.windows(2).all(|w| w[1] >= w[0] * (1.0 - slack));
            let falls = inside.windows(2).all(|w| w[1] <= w[0] * (1.0 + slack));
            prop_assert!(rises || falls, "{apexes:?}: {inside:?}");
        }
    }
}

/// The curve is linear in decibels: over ln f for knots within the band, and over ln(f + 20 Hz) for
/// knots from edge to edge.
#[test]
fn knots_are_at_the_positions_of_the_layout() {
    let band = Band::TACTILE;
    let within = shape(&[9.0, 0.0, 8.0, 16.0, 24.0, 32.0, 40.0, 48.0, 56.0, 64.0, 0.5, 0.0], band);
    let edges = shape(&[3.0, 0.0, 20.0, 40.0, 0.5, 1.0], band);
    for ((f, within_m), edges_m) in band.grid_hz().iter().zip(&within).zip(&edges) {
        let x = (10.0 * (f / 20.0).ln() / 50f64.ln()).clamp(1.0, 9.0) - 1.0;
        let below_db = 20.0 * (within[0] / within_m).log10();
        assert!((below_db - 4.0 * x).abs() < 1e-9, "{f} Hz");
        let x = 2.0 * ((f + 20.0) / 40.0).ln() / (1020f64 / 40.0).ln();
        let below_db = 20.0 * (edges[0] / edges_m).log10();
        assert!((below_db - 10.0 * x).abs() < 1e-9, "{f} Hz");
    }
}

#[test]
fn lines_and_empty_bands_stay_finite_and_loud_bands_are_kept() {
    let band = Band::TACTILE;
    for options in [[9.0, 0.5, WITHIN], [30.0, 0.75, EDGES], [64.0, 0.5, EDGES]] {
        for bin in 1..band.bins() - 1 {
            let mut magnitude = vec![0.0; band.bins()];
            magnitude[bin] = 3.0;
            let fit = fit(&magnitude, band, options).unwrap();
            let below = &fit.parameters[1..=options[0] as usize];
            assert!(below.iter().all(|b| *b <= FLOOR_DB / options[1]));
            assert!(fit.level_rms.is_finite() && fit.level_rms > 0.0);
            let magnitude = shape(&fit.parameters, band);
            assert!(magnitude.iter().all(|m| m.is_finite()));
            assert!((level_rms(&magnitude) - 1.0).abs() < 1e-9);
        }
    }
}

#[test]
fn lines_over_noise_nearly_keep_the_energies_of_nine_bands() {
    let band = Band::TACTILE;
    let mut rms_db = Vec::new();
    for bin in 2..band.bins() - 2 {
        let mut magnitude = vec![0.01; band.bins()];
        // A line 40 dB above the noise, as seen through the window.
        magnitude[bin - 1] = 0.5;
        magnitude[bin] = 1.0;
        magnitude[bin + 1] = 0.5;
        let fit = fit(&magnitude, band, [9.0, 0.5, WITHIN]).unwrap();
        rms_db.push(rms(&errors_db(&magnitude, &fit, band, 9)));
    }
    // At the edges of the band, some bands have energies that could only be met by knots hundreds
    // of decibels apart.
    rms_db.sort_by(f64::total_cmp);
    let (median, most) = (rms_db[rms_db.len() / 2], rms_db[rms_db.len() - 1]);
    assert!(median < 0.3 && most < 4.0, "{median} dB, {most} dB");
}

/// The window measures two thirds of a bin's noise power in the bin itself, and a sixth in each
/// neighbouring bin.
#[test]
fn the_voice_measures_as_the_stated_magnitude() {
    let (band, descriptor) = (Band::TACTILE, BandEnergies::DESCRIPTOR);
    let parameters = [9.0, 0.0, 10.0, 20.0, 12.0, 24.0, 36.0, 30.0, 40.0, 60.0, 0.5, 0.0];
    let curve = Spectrum::new(&Values::read(&descriptor, &parameters).unwrap(), band).unwrap();
    let stated = shape(&parameters, band);
    let played = band.grid_hz().into_iter().map(|f| curve.magnitude_at(f) / curve.level());
    let power: Vec<f64> = played.map(|m| m * m).collect();
    for (read, stated) in power.windows(3).zip(&stated[1..]) {
        let read = (read[0] + 4.0 * read[1] + read[2]) / 6.0;
        let off = 10.0 * (read / (stated * stated)).log10();
        // Without sharpening the difference would be twice as large.
        assert!(off.abs() < 0.25, "{off} dB");
    }
}

#[test]
fn a_step_too_fine_for_the_range_is_coarsened() {
    let band = Band::TACTILE;
    let step_db = |slope: f64, wanted_db: f64| {
        let magnitude: Vec<f64> = band.grid_hz().iter().map(|f| f.powf(slope)).collect();
        let fit = fit(&magnitude, band, [9.0, wanted_db, WITHIN]).unwrap();
        fit.parameters[10]
    };
    // Nearly equal energies.
    assert_eq!(step_db(-0.3, 0.07), 0.05);
    assert_eq!(step_db(-0.3, 0.5), 0.5);
    // 255 steps of 0.05 dB are 12.75 dB, too little for a range of 70 dB.
    let coarse = step_db(-3.0, 0.05);
    assert!((0.3..0.4).contains(&coarse), "{coarse}");
}

#[test]
fn silence_is_refused_and_scale_does_not_matter() {
    let band = Band::TACTILE;
    let error = fit(&[0.0; 197], band, [9.0, 0.5, WITHIN]).unwrap_err();
    assert_eq!(error.status, Status::CannotFit);
    // At both edges of the band the triangles' weights are zero.
    let mut edges = [0.0; 197];
    (edges[0], edges[196]) = (1.0, 1.0);
    let error = fit(&edges, band, [9.0, 0.5, WITHIN]).unwrap_err();
    assert_eq!(error.status, Status::CannotFit);
    let magnitude: Vec<f64> = band.grid_hz().iter().map(|f| 1.0 / f).collect();
    let scaled = |by: f64| {
        let magnitude: Vec<f64> = magnitude.iter().map(|m| m * by).collect();
        fit(&magnitude, band, [9.0, 0.5, WITHIN]).unwrap()
    };
    let plain = scaled(1.0);
    for by in [1e-250, 1e250] {
        let other = scaled(by);
        assert_eq!(other.parameters, plain.parameters);
        assert!((other.level_rms / plain.level_rms / by - 1.0).abs() < 1e-12);
    }
}

#[test]
fn interpolation_is_in_decibels_between_equal_bands() {
    let descriptor = BandEnergies::DESCRIPTOR;
    let read = |parameters: &'static [f64]| Values::read(&descriptor, parameters).unwrap();
    let mix = |a: &'static [f64], b: &'static [f64]| {
        let mut room = [0.0; 8];
        let mut out = Numbers::new(&mut room);
        BandEnergies::interpolate(&[read(a), read(b)], &[0.25, 0.75], &mut out)?;
        Ok::<_, Error>(room[..a.len()].to_vec())
    };
    let loud_low: &[f64] = &[3.0, 0.0, 20.0, 40.0, 0.5, 1.0];
    let loud_high: &[f64] = &[3.0, 60.0, 40.0, 0.0, 0.5, 1.0];
    assert_eq!(mix(loud_low, loud_high).unwrap(), [3.0, 45.0, 35.0, 10.0, 0.5, 1.0]);
    let others: [&[f64]; 3] = [
        &[2.0, 0.0, 20.0, 0.5, 1.0],
        &[3.0, 0.0, 20.0, 40.0, 1.0, 1.0],
        &[3.0, 0.0, 20.0, 40.0, 0.5, 0.0],
    ];
    let band = Band::TACTILE;
    let mut voice = BandEnergies::voice(&read(loud_low), band, 2_500.0, 1).unwrap();
    for other in others {
        let refused = mix(loud_low, other).unwrap_err();
        assert_eq!(refused.status, Status::InvalidArgument);
    }
    assert!(voice.retune(&read(loud_high)).is_ok());
    for other in [others[0], others[2]] {
        let refused = voice.retune(&read(other)).unwrap_err();
        assert_eq!(refused.status, Status::InvalidArgument);
    }
    assert!(BandEnergies::voice(&read(&[0.0, 0.5, 1.0]), band, 2_500.0, 1).is_err());
}
