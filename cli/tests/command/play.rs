//! Played samples agree with the asset's levels and spectra.

use crate::common::{Place, computed, numbers, stated};
use htex_host::Registry;

#[test]
fn a_minute_of_each_model_has_its_spectrum_and_its_level() {
    let place = Place::new();
    let csv = place.recording("corrugated-paper");
    let models = Registry::builtin_names();
    let fit = ["fit", &csv, "--model", &models.join(","), "-o", "t.htex"];
    let fit = place.json(&[&fit[..], &["--json"]].concat());
    for (i, model) in models.into_iter().enumerate() {
        let synth = ["synth", "t.htex", "--model", model, "--seconds", "60", "--rate", "20000"];
        let run = place.run(&[&synth[..], &["--seed", "9", "-o", "t.wav"]].concat());
        assert_eq!(run.code(), 0, "{}", run.error());
        let mut wav = hound::WavReader::open(place.path("t.wav")).unwrap();
        assert_eq!((wav.spec().sample_rate, wav.len()), (20_000, 1_200_000));
        let samples = wav.samples::<f32>().map(|x| f64::from(x.unwrap()));
        let power = samples.map(|x| x * x).sum::<f64>() / 1_200_000.0;
        let level = stated(&fit, i)["level_rms"].as_f64().unwrap();

        let stated = place.json(&["spectrum", "t.htex", "--model", model, "--json"]);
        let process = ["process", "t.wav", "--segments", "windows", "--averaging", "rms"];
        let measured = place.json(&[&process[..], &["--scale", "1", "--json"]].concat());
        let (stated, measured) = (numbers(&stated["magnitude"]), numbers(&measured["magnitude"]));
        // In the band's bins; in all it may be more at the band's edges, and lines are in all what
        // they are.
        let read = (measured.iter().map(|m| m * m).sum::<f64>() / 3.0).sqrt() / level;
        let in_all = power.sqrt() / level;
        let ratio = if model == "speak" { in_all } else { read };
        let distance = if model == "speak" {
            let lines = &computed(&fit, i)["parameters"]["frequency_hz"];
            let bins = numbers(lines).iter().map(|f| (f / 5.0) as usize - 4).collect();
            distance_db(&stated, &measured, bins)
        } else {
            let bins = strongest_bins(&stated);
            let read = distance_db(&read_as_noise(&stated), &measured, bins.clone());
            distance_db(&stated, &measured, bins).min(read)
        };
        println!("{model:8} level {ratio:.4}, spectrum {distance:.3} dB RMS");
        // Of a resonance that is narrower than the bins, the bins tell the level less exactly.
        let tolerance = if model == "arma" { 0.03 } else { 0.02 };
        let allowed = 1.0 - tolerance..1.1;
        assert!(allowed.contains(&in_all), "{model}: {in_all}");
        assert!((ratio - 1.0).abs() < tolerance, "{model}: RMS over level {ratio}");
        assert!(distance < 1.0, "{model}: {distance} dB");
    }
}

/// The bins that hold 99 % of the energy, strongest first.
fn strongest_bins(magnitude: &[f64]) -> Vec<usize> {
    let mut bins: Vec<usize> = (0..magnitude.len()).collect();
    bins.sort_by(|&a, &b| magnitude[b].total_cmp(&magnitude[a]));
    let total: f64 = magnitude.iter().map(|m| m * m).sum();
    let mut held = 0.0;
    let enough = bins.iter().position(|&i| {
        held += magnitude[i] * magnitude[i];
        held >= 0.99 * total
    });
    bins.truncate(enough.unwrap() + 1);
    bins
}

/// What noise of this density reads through the window: two thirds of the power in its own bin, a
/// sixth in each neighbour. At steep flanks that differs from the magnitude.
fn read_as_noise(magnitude: &[f64]) -> Vec<f64> {
    let power = |i: usize| magnitude.get(i).map_or(0.0, |m| m * m);
    let read = |i: usize| (power(i.wrapping_sub(1)) + 4.0 * power(i) + power(i + 1)) / 6.0;
    (0..magnitude.len()).map(|i| read(i).sqrt()).collect()
}

fn distance_db(stated: &[f64], measured: &[f64], bins: Vec<usize>) -> f64 {
    let squares = bins.iter().map(|&i| (20.0 * (measured[i] / stated[i]).log10()).powi(2));
    (squares.sum::<f64>() / bins.len() as f64).sqrt()
}
