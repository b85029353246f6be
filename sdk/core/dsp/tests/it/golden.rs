//! Compares the crate with the golden vectors of the workspace, which were made with other software
//! (each case names it). The condition is `|got - expected| <= atol + rtol |expected|` for every
//! element.

use htex_dsp::bands::{BandBank, band_error_db, energy_matching_gain, pearson_correlation};
use htex_dsp::beta::{BetaDensity, log_unit};
use htex_dsp::biquad::{Biquad, Cascade};
use htex_dsp::butterworth;
use htex_dsp::estimation::{burg, covariance, yule_walker};
use htex_dsp::fidelity::{log_spectral_distance_db, third_octave_error_rms_db};
use htex_dsp::linear_prediction::{LinearPrediction, ar_magnitude, is_stable, levinson_durbin};
use htex_dsp::mel::MelBank;
use htex_dsp::spectrum::{SegmentAnalyzer, dft321};
use htex_dsp::triangles::TriangleBank;
use htex_dsp::window::hann_periodic;
use htex_dsp::{Band, GRID_HZ};
use serde_json::Value;

struct Case(Value);

impl Case {
    fn name(&self) -> &str {
        self.0["name"].as_str().unwrap()
    }

    fn numbers(&self, field: &str) -> Vec<f64> {
        numbers(&self.0["input"][field])
    }

    fn number(&self, field: &str) -> f64 {
        self.0["input"][field].as_f64().unwrap()
    }

    fn count(&self, field: &str) -> usize {
        self.number(field) as usize
    }

    fn text(&self, field: &str) -> &str {
        self.0["input"][field].as_str().unwrap_or("")
    }

    fn informative_only(&self) -> bool {
        self.0["informative_only"].as_bool().unwrap_or(false)
    }

    #[track_caller]
    fn check(&self, field: &str, got: &[f64]) {
        let expected = numbers(&self.0["expected"][field]);
        let (rtol, atol) = (self.0["rtol"].as_f64(), self.0["atol"].as_f64());
        let (rtol, atol) = (rtol.unwrap(), atol.unwrap());
        assert_eq!(got.len(), expected.len(), "{}: length of {field}", self.name());
        for (i, (got, expected)) in got.iter().zip(&expected).enumerate() {
            let error = (got - expected).abs();
            assert!(
                error <= atol + rtol * expected.abs(),
                "{}: {field}[{i}] is {got}, expected {expected}",
                self.name()
            );
        }
    }
}

fn numbers(value: &Value) -> Vec<f64> {
    match value {
        Value::Array(values) => values.iter().map(|v| v.as_f64().unwrap()).collect(),
        value => vec![value.as_f64().unwrap()],
    }
}

/// Returns the cases of one file whose names start with one of `prefixes`; fails if there are none.
fn cases(file: &str, prefixes: &[&str]) -> Vec<Case> {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/../../../tests/golden");
    let text = std::fs::read_to_string(format!("{folder}/{file}.json")).unwrap();
    let root: Value = serde_json::from_str(&text).unwrap();
    let all = root["cases"].as_array().unwrap().iter().cloned().map(Case);
    let chosen: Vec<Case> =
        all.filter(|case| prefixes.iter().any(|prefix| case.name().starts_with(prefix))).collect();
    assert!(!chosen.is_empty(), "{file}: no case {prefixes:?}");
    chosen
}

/// The smooth spectrum that several cases share, on the 197 grid frequencies.
fn smooth_spectrum() -> Vec<f64> {
    let m = |f: f64| {
        0.01 * (-(f / 150.0).ln().powi(2)).exp() + 0.002 * (-((f - 600.0) / 120.0).powi(2)).exp()
    };
    Band::TACTILE.grid_hz().into_iter().map(m).collect()
}

fn column(bank: &TriangleBank, f_hz: f64) -> Vec<f64> {
    let column = (f_hz / GRID_HZ) as usize - Band::TACTILE.first_bin();
    (0..bank.rows()).map(|row| bank.weight(row, column)).collect()
}

#[test]
fn windows() {
    let periodic = |case: &Case| case.text("kind") == "periodic";
    for case in cases("window", &["hann"]).into_iter().filter(periodic) {
        let window = hann_periodic(case.count("n"));
        let at_index: Vec<f64> =
            case.numbers("index").iter().map(|&i| window[i as usize]).collect();
        case.check("w", &at_index);
        case.check("sum", &[window.iter().sum()]);
        case.check("sum_sq", &[window.iter().map(|w| w * w).sum()]);
    }
}

#[test]
fn linear_prediction_models() {
    for case in cases("ar", &["ar", "signal64"]) {
        let order = case.0["input"]["order"].as_u64().unwrap_or(0) as usize;
        let model = match case.text("method") {
            "levinson" => levinson_durbin(&case.numbers("autocorr"), order),
            "yw" => yule_walker(&[&case.numbers("x")], order),
            "burg" => burg(&[&case.numbers("x")], order),
            "cov" => covariance(&[&case.numbers("x")], order),
            _ => continue,
        };
        assert!(is_stable(&model.coefficients), "{}", case.name());
        if !case.informative_only() {
            check_model(&case, &model);
        }
    }
}

fn check_model(case: &Case, model: &LinearPrediction) {
    assert!(!model.adjusted, "{}", case.name());
    case.check("a", &model.coefficients);
    case.check("error", &[model.error]);
    if !case.0["expected"]["reflection"].is_null() {
        case.check("reflection", &model.reflection);
    }
}

#[test]
fn linear_prediction_responses() {
    let mut checked = 0;
    for case in cases("ar", &["ar"]) {
        if !case.name().ends_with("_response") {
            continue;
        }
        let (a, rate_hz) = (case.numbers("a"), case.number("fs_hz"));
        let magnitude = |f: &f64| ar_magnitude(&a, *f, rate_hz);
        let got: Vec<f64> = case.numbers("f_hz").iter().map(magnitude).collect();
        case.check("mag", &got);
        checked += 1;
    }
    assert_eq!(checked, 3);
}

#[test]
fn band_banks() {
    let frequencies = Band::TACTILE.grid_hz();
    for case in cases("bands", &["bank"]) {
        let bank = BandBank::new(case.count("n"), Band::TACTILE, &frequencies);
        case.check("edges_hz", bank.edges_hz());
        case.check("row_sums", &bank.filters().row_sums());
        case.check("weights_at_100_hz", &column(bank.filters(), 100.0));
        case.check("weights_at_447_hz_bin445", &column(bank.filters(), 445.0));
    }
}

#[test]
fn measures_that_no_model_is_fitted_to() {
    let frequencies = Band::TACTILE.grid_hz();
    for case in cases("fidelity", &["fidelity"]) {
        let (reference, model) = (case.numbers("reference"), case.numbers("model"));
        let third_octave = third_octave_error_rms_db(&frequencies, &reference, &model);
        case.check("third_octave_error_rms_db", &[third_octave.unwrap()]);
        let distance = log_spectral_distance_db(&reference, &model);
        case.check("log_spectral_distance_db", &[distance.unwrap()]);
    }
}

#[test]
fn band_comparison() {
    let frequencies = Band::TACTILE.grid_hz();
    // A high-pass is a low-pass at the inverse frequency.
    let butterworth = |f: &f64| {
        0.02 * butterworth::analog_low_pass_magnitude(150.0 / f, 1.0)
            * butterworth::analog_low_pass_magnitude(f / 150.0, 2.0)
    };
    let (reference, model) = (smooth_spectrum(), frequencies.iter().map(butterworth));
    let model: Vec<f64> = model.collect();
    let bank = BandBank::new(9, Band::TACTILE, &frequencies);
    let (e_reference, e_model) = (bank.energies(&reference), bank.energies(&model));
    let gain = energy_matching_gain(&reference, &model);
    let matched: Vec<f64> = e_model.iter().map(|e| e * gain * gain).collect();
    let matched_db = band_error_db(&e_reference, &matched);
    let relative = |model: &[f64]| -> Vec<f64> {
        let pairs = model.iter().zip(&e_reference);
        pairs.map(|(m, r)| (m - r) / r).collect()
    };
    // Weighted absolute difference of the power, bin by bin.
    let mut difference = vec![0.0; 9];
    let power = reference.iter().zip(&model).map(|(r, m)| ((m * gain).powi(2) - r * r).abs());
    bank.filters().apply(&power.collect::<Vec<_>>(), &mut difference);
    for case in cases("bands", &["compare"]) {
        case.check("corr", &[pearson_correlation(&reference, &model)]);
        case.check("gain_energy_match", &[gain]);
        let decibels: Vec<f64> = e_reference.iter().map(|e| 10.0 * e.log10()).collect();
        case.check("band_ref_db", &decibels);
        case.check("band_diff_db", &band_error_db(&e_reference, &e_model));
        case.check("band_diff_rel", &relative(&e_model));
        case.check("band_diff_db_matched", &matched_db);
        case.check("band_diff_rel_matched", &relative(&matched));
        case.check("band_abs_diff_matched", &difference);
        let mean = matched_db.iter().map(|e| e.abs()).sum::<f64>() / 9.0;
        case.check("band_mean_abs_db_matched", &[mean]);
    }
}

#[test]
fn mel_banks() {
    for case in cases("mfcc", &["htk"]) {
        let (low_hz, high_hz) = (case.number("fmin_hz"), case.number("fmax_hz"));
        let band = Band { low_hz, high_hz };
        let bank = MelBank::new(case.count("n_mels"), band, &band.grid_hz());
        case.check("edges_hz", bank.edges_hz());
        case.check("row_sums", &bank.filters().row_sums());
        let rows: Vec<f64> = numbers(&case.0["expected"]["row0_f_hz"])
            .iter()
            .map(|f| bank.filters().weight(0, ((f - low_hz) / GRID_HZ) as usize))
            .collect();
        case.check("row0", &rows);
    }
}

#[test]
fn beta_density() {
    for case in cases("sbeta", &["pdf"]) {
        let (alpha, beta) = (case.number("alpha"), case.number("beta"));
        let density = BetaDensity::new(alpha, beta);
        let got: Vec<f64> = case.numbers("u").iter().map(|u| density.density_at(*u)).collect();
        case.check("pdf", &got);
    }
    for case in cases("sbeta", &["log_unit"]) {
        let unit = |f: &f64| log_unit(*f, Band::TACTILE);
        let got: Vec<f64> = case.numbers("f_hz").iter().map(unit).collect();
        case.check("u", &got);
    }
}

#[test]
fn butterworth_filters() {
    for case in cases("sslope", &["butter"]) {
        let (fc, rate) = (case.number("fc_hz"), case.number("fs_hz"));
        let (high, low) = (case.count("order_hp"), case.count("order_lp"));
        let sections: Vec<Biquad> = [
            butterworth::high_pass(high, fc, rate).unwrap(),
            butterworth::low_pass(low, fc, rate).unwrap(),
        ]
        .iter()
        .flat_map(|sections| sections.to_vec())
        .collect();
        let mut cascade = Cascade::new(&sections);

        let frequencies = case.numbers("f_hz");
        let analog = |f: &f64| {
            butterworth::analog_low_pass_magnitude(fc / f, high as f64)
                * butterworth::analog_low_pass_magnitude(f / fc, low as f64)
        };
        case.check("mag_analog", &frequencies.iter().map(analog).collect::<Vec<_>>());
        let digital = |f: &f64| cascade.magnitude(*f, rate);
        case.check("mag_digital", &frequencies.iter().map(digital).collect::<Vec<_>>());
        let mut impulse = [0.0; 8];
        impulse[0] = 1.0;
        cascade.process(&mut impulse);
        case.check("impulse_8", &impulse);
    }
}

#[test]
fn two_axes_folded_into_one() {
    for case in cases("pipeline", &["dft321"]) {
        let [x, y] = ["fx", "fy"].map(|axis| {
            let samples = case.numbers(axis);
            let mut analyzer = SegmentAnalyzer::new(samples.len());
            let mut bins = analyzer.make_bins();
            analyzer.transform(&samples, &mut bins).unwrap();
            bins
        });
        let folded = dft321(&[x.clone(), y.clone()]);
        case.check("mag", &folded.iter().map(|z| z.norm()).collect::<Vec<_>>());
        case.check("re", &folded.iter().map(|z| z.re).collect::<Vec<_>>());
        case.check("im", &folded.iter().map(|z| z.im).collect::<Vec<_>>());
    }
}
