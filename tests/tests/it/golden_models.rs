//! The models, called through the ABI, against numbers computed independently with SciPy.

use crate::common;
use htex_author::settings::Preset;
use htex_host::{Band, Fit, LoadedModel, Registry};
use htex_tests::{Golden, smooth_spectrum};

/// The options with which `--as paper` fits a model.
fn as_paper(model: &str) -> Vec<(&'static str, &'static str)> {
    let own = Preset::Paper.options().iter().filter(|(owner, ..)| *owner == model);
    own.map(|(_, option, value)| (*option, *value)).collect()
}

fn model(name: &str) -> LoadedModel {
    Registry::builtin().find(name).unwrap().clone()
}

fn fit(model: &LoadedModel, magnitude: &[f64], options: &[(&str, &str)]) -> Fit {
    common::fit(model, Band::TACTILE, magnitude, (20_000.0, options))
}

fn fitted_magnitude(model: &LoadedModel, fit: &Fit) -> Vec<f64> {
    let band = Band::TACTILE;
    let shape = model.magnitude(&fit.parameters, band, &band.grid_hz()).unwrap();
    shape.iter().map(|m| m * fit.level_rms).collect()
}

#[test]
fn mfcc_of_a_smooth_spectrum() {
    let case = Golden::case("mfcc", "mfcc_smooth");
    let spectrum = smooth_spectrum(&Band::TACTILE.grid_hz());
    let mfcc = model("mfcc");
    for (inverse, key) in [("pinv", "/inverse_mag_pinv"), ("interpolate", "/inverse_mag_interp")] {
        let fit = fit(&mfcc, &spectrum, &[("inverse", inverse)]);
        case.hold("/mfcc", &fit.parameters[1..11]);
        let mut magnitude = fitted_magnitude(&mfcc, &fit);
        if inverse == "pinv" {
            // At the outermost edges the triangles have exactly zero weight; the reference
            // computation has the square root of a rounding error there.
            for i in [0, 196] {
                assert_eq!(magnitude[i], 0.0);
                magnitude[i] = case.expected(key)[i];
                assert!(magnitude[i] < 1e-9);
            }
        }
        case.hold(key, &magnitude);
    }
}

#[test]
fn speak_peaks_and_samples() {
    let speak = model("speak");
    for name in ["rippled", "few_peaks"] {
        let case = Golden::case("speak", name);
        let fit = fit(&speak, &case.input("mag"), &as_paper("speak"));
        let n = fit.parameters[0] as usize;
        case.hold("/f_hz", &fit.parameters[1..=n]);
        let amplitudes = &fit.parameters[n + 2..2 * n + 2];
        let newtons: Vec<f64> = amplitudes.iter().map(|a| a * fit.level_rms).collect();
        // Shape times level gives the original back within one rounding each.
        for (got, expected) in newtons.iter().zip(case.expected("/amp")) {
            assert!((got / expected - 1.0).abs() < 1e-14);
        }
    }
    let case = Golden::case("speak", "sum_of_sinusoids");
    let (f, a) = (case.input("f_hz"), case.input("amp"));
    let level = a.iter().map(|a| a * a / 2.0).sum::<f64>().sqrt();
    let count = [f.len() as f64];
    let relative: Vec<f64> = a.iter().map(|a| a / level).collect();
    let parameters = [&count[..], &f, &count, &relative, &[0.0]].concat();
    let mut voice = speak.voice(&parameters, Band::TACTILE, 20_000.0, 1).unwrap();
    let mut out = vec![0.0f32; 200_000];
    voice.render(&mut out).unwrap();
    for (n, y) in case.input("n").iter().zip(case.expected("/y")) {
        // The sum is rounded to a 32-bit float, so the tolerance is for samples near 5 times the
        // level.
        let got = f64::from(out[*n as usize]) * level;
        assert!((got - y).abs() < 5.0 * level * f64::from(f32::EPSILON), "sample {n}: {got} {y}");
    }
}

/// A spectrum whose peaks are exactly the given points: each on its own bin between zeros, if the
/// points lie on the grid.
fn spectrum_of_points(f_hz: &[f64], amp: &[f64]) -> Option<Vec<f64>> {
    let mut magnitude = vec![0.0; Band::TACTILE.bins()];
    for (f, a) in f_hz.iter().zip(amp) {
        let bin = f / 5.0 - 4.0;
        if bin.fract() != 0.0 {
            return None;
        }
        magnitude[bin as usize] = *a;
    }
    Some(magnitude)
}

#[test]
fn sbeta_fits_of_ten_points() {
    let sbeta = model("sbeta");
    let mut held = 0;
    for case in Golden::all("sbeta").iter().filter(|c| c.name().starts_with("fit_")) {
        let Some(spectrum) = spectrum_of_points(&case.input("f_hz"), &case.input("amp")) else {
            continue;
        };
        let fit = fit(&sbeta, &spectrum, &as_paper("sbeta"));
        case.hold("/alpha", &fit.parameters[..1]);
        case.hold("/beta", &fit.parameters[1..]);
        // The scale is part of the level: newtons at a frequency divided by the density there.
        let magnitude = fitted_magnitude(&sbeta, &fit);
        let u = htex_dsp::beta::log_unit(150.0, Band::TACTILE);
        let [alpha, beta] = [fit.parameters[0], fit.parameters[1]];
        let density = htex_dsp::beta::BetaDensity::new(alpha, beta).density_at(u);
        case.hold("/scale", &[magnitude[26] / density]);
        held += 1;
    }
    assert_eq!(held, 4);
}

#[test]
fn sslope_orders_by_each_way_of_measuring() {
    let sslope = model("sslope");
    let grid = Band::TACTILE.grid_hz();
    for case in Golden::all("sslope").iter().filter(|c| c.name().starts_with("powerlaw")) {
        let (peak, up, down) = (case.input("pk_hz")[0], case.input("up")[0], case.input("dn")[0]);
        let curve =
            |f: &f64| 0.01 * if *f < peak { (f / peak).powf(up) } else { (f / peak).powf(-down) };
        let spectrum: Vec<f64> = grid.iter().map(curve).collect();
        let fit = fit(&sslope, &spectrum, &as_paper("sslope"));
        case.hold("/peak_hz", &fit.parameters[..1]);
        case.hold("/order_hp", &fit.parameters[1..2]);
        case.hold("/order_lp", &fit.parameters[2..]);
        let bin = (peak / 5.0) as usize - 4;
        assert!((fitted_magnitude(&sslope, &fit)[bin] / 0.01 - 1.0).abs() < 1e-12);
    }
    let case = Golden::case("sslope", "conventions_on_smooth");
    let ways = [("least-squares", "ols"), ("end-points", "endpoint"), ("anchored", "anchored")];
    for (way, key) in ways {
        let options = [as_paper("sslope"), vec![("slopes", way)]].concat();
        let fit = fit(&sslope, &smooth_spectrum(&grid), &options);
        case.hold(&format!("/{key}/peak_hz"), &fit.parameters[..1]);
        case.hold(&format!("/{key}/order_hp"), &fit.parameters[1..2]);
        case.hold(&format!("/{key}/order_lp"), &fit.parameters[2..]);
    }
}

#[test]
fn bands_of_whole_and_narrow_spectra() {
    let bands = model("bands");
    for case in Golden::all("band_energies") {
        let one = |key: &str| case.input(key)[0];
        let band = Band { low_hz: one("low_hz"), high_hz: one("high_hz") };
        let grid = band.grid_hz();
        let magnitude =
            if case.has_input("mag") { case.input("mag") } else { smooth_spectrum(&grid) };
        let options = ["bands", "step_db", "layout"].map(|key| (key, case.input_text(key)));
        let options = options.each_ref().map(|(key, value)| (*key, &value[..]));
        let fit = common::fit(&bands, band, &magnitude, (20_000.0, &options));
        let count = fit.parameters[0] as usize;
        case.hold("/below_highest", &fit.parameters[1..=count]);
        case.hold("/step_db", &fit.parameters[count + 1..count + 2]);
        case.hold("/layout", &fit.parameters[count + 2..]);
        case.hold("/level_rms", &[fit.level_rms]);
        let shape = bands.magnitude(&fit.parameters, band, &grid).unwrap();
        let newtons: Vec<f64> = shape.iter().map(|m| m * fit.level_rms).collect();
        case.hold("/magnitude", &newtons);
    }
}

#[test]
fn arma_is_the_filter_of_its_lines() {
    let arma = model("arma");
    for case in Golden::all("arma") {
        let [poles, zeros] = ["pole_lines", "zero_lines"].map(|key| case.input(key));
        let counts = [&poles, &zeros].map(|lines| vec![lines.len() as f64]);
        let rate_hz = case.input("rate_hz");
        let parameters = [&counts[0], &poles, &counts[1], &zeros, &rate_hz].map(|part| &part[..]);
        let band = Band { low_hz: 20.0, high_hz: 500.0 };
        let grid = band.grid_hz();
        let magnitude = arma.magnitude(&parameters.concat(), band, &grid).unwrap();
        case.hold("/magnitude", &magnitude);
        let negated = |key: &str| -> Vec<f64> { case.input(key).iter().map(|a| -a).collect() };
        let mut samples = case.input("x");
        let mut zeros = htex_dsp::all_zero::AllZero::new(&negated("b")).unwrap();
        zeros.process(&mut samples);
        let mut poles = htex_dsp::all_pole::AllPole::new(&negated("a")).unwrap();
        poles.process(samples.as_chunks_mut().0);
        case.hold("/y", &samples);
    }
}

/// The spectrum of a known filter is described to half a decibel with as many poles and zeros.
#[test]
fn arma_of_the_spectrum_of_a_known_filter_is_near_it() {
    let arma = model("arma");
    let band = Band { low_hz: 20.0, high_hz: 500.0 };
    let grid = band.grid_hz();
    for case in Golden::all("arma") {
        let expected = case.expected("/magnitude");
        let [poles, zeros] = ["a", "b"].map(|key| case.input(key).len().to_string());
        let options = [("poles", &poles[..]), ("zeros", &zeros[..]), ("rate_hz", "1000")];
        let fit = common::fit(&arma, band, &expected, (1_000.0, &options));
        let magnitude = arma.magnitude(&fit.parameters, band, &grid).unwrap();
        // The last bins are next to a zero at the Nyquist frequency.
        let errors = magnitude
            .iter()
            .zip(&expected)
            .take(93)
            .map(|(m, e)| 20.0 * (m * fit.level_rms / e).log10());
        let rms = (errors.map(|db| db * db).sum::<f64>() / 93.0).sqrt();
        println!("{}: {rms:.3} dB", case.name());
        assert!(rms < 1.0, "{}: {rms} dB", case.name());
    }
}

#[test]
fn ar_of_the_spectrum_of_a_known_filter_is_that_filter() {
    // Yule–Walker on the exact one-sided spectrum of an AR(2) process at 2 kHz, over the whole
    // band.
    let band = Band { low_hz: 5.0, high_hz: 1000.0 };
    let truth = [1.2, -0.8];
    let (rate_hz, error): (f64, f64) = (2_000.0, 0.03);
    let gain = (4.0 * error * 7.5 / rate_hz).sqrt();
    let magnitude: Vec<f64> = band
        .grid_hz()
        .iter()
        .map(|&f| gain * htex_dsp::linear_prediction::ar_magnitude(&truth, f, rate_hz))
        .collect();
    let ar = model("ar");
    let fit = common::fit(&ar, band, &magnitude, (rate_hz, &[("order", "2")]));
    // The bin at 0 Hz and half of the bin at 1 kHz do not belong to the process: 1 % of the power.
    assert!((fit.parameters[1] - truth[0]).abs() < 0.01, "{:?}", fit.parameters);
    assert!((fit.parameters[2] - truth[1]).abs() < 0.01, "{:?}", fit.parameters);
}
