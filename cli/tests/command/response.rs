//! `htex response`: hits of a simulated rig become the response that other commands divide by.

#[path = "../../../sdk/lab/tests/it/rig.rs"]
mod simulated;

use std::f64::consts::TAU;
use std::fmt::Write;

use crate::common::{Place, numbers};
use htex_dsp::noise::GaussianNoise;
use simulated::{RATE_HZ, Rig, pulses};

/// The rig: 1 plus a fifth of a resonance at 180 Hz with a damping of 2 %.
fn rig(input: &[f64]) -> Vec<f64> {
    let resonance = Rig::new(180.0, 0.02).filter(input);
    input.iter().zip(resonance).map(|(direct, out)| direct + 0.2 * out).collect()
}

/// A recording of both channels with noise 30 dB below each; the hammer in volts of 22.5 N.
fn recording(place: &Place, name: &str, force: &[f64], seed: u64) {
    let answer = rig(force);
    let rms = |x: &[f64]| (x.iter().map(|x| x * x).sum::<f64>() / x.len() as f64).sqrt();
    let levels = [rms(force), rms(&answer)].map(|rms| rms * 10_f64.powf(-30.0 / 20.0));
    let mut noise = GaussianNoise::new(seed);
    let mut csv = String::from("t_s,hammer_V,fx_n\n");
    for (i, (force, answer)) in force.iter().zip(&answer).enumerate() {
        let [a, b] = levels.map(|level| level * f64::from(noise.next_sample()));
        // The converter ends at 20 N.
        let volts = (force + a).min(20.0) / 22.5;
        writeln!(csv, "{:.4},{volts:.7},{:.7}", i as f64 / RATE_HZ, answer + b).unwrap();
    }
    place.write(name, csv);
}

fn run<'a>(files: &[&'a str], more: &[&'a str]) -> Vec<&'a str> {
    let usual = ["--input", "hammer_V:22.5", "--output", "fx_n"];
    [&["response"], files, &usual, more].concat()
}

#[test]
fn hits_become_the_response_that_recordings_are_divided_by() {
    let place = Place::new();
    // The third hit bounces, the fourth is too strong.
    let first = [(0.2, 10.0), (1.4, 12.0), (2.6, 11.0), (2.64, 4.0), (3.8, 40.0), (5.0, 9.0)];
    recording(&place, "first.csv", &pulses(6.2, &first), 1);
    let second: Vec<(f64, f64)> = (0..5).map(|i| (0.3 + 1.21 * f64::from(i), 10.0)).collect();
    recording(&place, "second.csv", &pulses(6.2, &second), 2);
    let files = ["first.csv", "second.csv"];
    let more = ["--force-window", "0.005", "-o", "response.csv", "--svg", "response.svg"];

    let done = place.run(&run(&files, &more));
    assert_eq!(done.code(), 0, "{}", done.error());
    let text = done.text();
    println!("{text}{}", done.error());
    assert!(text.contains("8 used, 2 thrown out\n"), "{text}");
    let lines: Vec<&str> = text.lines().filter(|line| line.contains("thrown out:")).collect();
    assert!(
        lines[0].contains("2.6001 s")
            && lines[0].contains("double hit: second contact at 2.6401 s"),
        "{text}"
    );
    assert!(lines[1].contains("overload: the input is at its limit of 20.0000"), "{text}");
    assert!(std::fs::read_to_string(place.path("response.svg")).unwrap().contains("coherence"));

    let json = place.json(&run(&files, &["--json", "--force-window", "0.005"]));
    assert_eq!(json["averages"], 8);
    assert_eq!(json["pieces"][2]["thrown_out"]["reason"], "double_hit");
    assert_eq!(json["settings"]["excitation"]["hits"]["force_window_s"], 0.005);
    let (hz, coherence) = (numbers(&json["frequency_hz"]), numbers(&json["coherence"]));
    assert_eq!((hz[0], hz[980]), (20.0, 1000.0));
    assert!(coherence[..500].iter().all(|c| *c > 0.9));

    // The sum of sinusoids on the grid of texture spectra, at the finger and as the rig shows it.
    let tones: Vec<f64> = (2..=48).map(|k| 20.0 * f64::from(k)).collect();
    let tone = |t: f64| {
        tones.iter().enumerate().map(|(k, hz)| 0.01 * (TAU * hz * t + (k * k) as f64).sin()).sum()
    };
    let finger: Vec<f64> = (0..40_000).map(|i| tone(i as f64 / RATE_HZ)).collect();
    for (name, signal) in [("finger.csv", finger.clone()), ("rig.csv", rig(&finger))] {
        let rows = signal[10_000..].iter().enumerate();
        let rows: String =
            rows.map(|(i, f)| format!("{:.4},{f:.9}\n", i as f64 / RATE_HZ)).collect();
        place.write(name, format!("t_s,fx_n\n{rows}"));
    }
    let spectrum = |file: &str, more: &[&str]| {
        let usual = ["process", file, "--json", "--segments", "windows"];
        place.json(&[&usual, more].concat())
    };
    let (truth, seen) = (spectrum("finger.csv", &[]), spectrum("rig.csv", &[]));
    let divided = spectrum("rig.csv", &["--frf", "response.csv"]);
    let [truth, seen, divided] = [truth, seen, divided].map(|json| numbers(&json["magnitude"]));
    let worst = |of: &[f64]| {
        let at = tones.iter().map(|hz| ((hz - 20.0) / 5.0) as usize);
        at.map(|at| (20.0 * (of[at] / truth[at]).log10()).abs()).fold(0.0, f64::max)
    };
    println!("largest difference {:.3} dB, divided {:.3} dB", worst(&seen), worst(&divided));
    assert!(worst(&seen) > 10.0 && worst(&divided) < 0.5, "{} {}", worst(&seen), worst(&divided));
}

#[test]
fn wrong_use_and_unusable_recordings_are_named() {
    let place = Place::new();
    recording(&place, "one.csv", &pulses(2.0, &[(0.2, 10.0)]), 3);
    let half: String =
        (0..20_000).map(|i| format!("{},{},{}\n", f64::from(i) / 5000.0, i % 9, i % 7)).collect();
    place.write("half.csv", format!("t_s,hammer_V,fx_n\n{half}"));
    for (arguments, code, words) in [
        (
            run(&["one.csv", "half.csv"], &["-o", "x.csv"]),
            1,
            "half.csv was recorded at 5000 Hz and one.csv at 10000 Hz",
        ),
        (
            run(&["half.csv"], &["--window", "9"]),
            1,
            "one window of 9 s; record longer or choose a shorter window (see --window)",
        ),
        (run(&["one.csv"], &["--window", "0"]), 2, "(see --window)"),
        (run(&["one.csv"], &["--trigger", "2"]), 2, "(see --trigger)"),
        (run(&["one.csv"], &["-o", "one.csv"]), 2, "it is read here, and would be lost"),
        (
            vec!["response", "one.csv", "--input", "hammer", "--output", "fx_n"],
            1,
            "(see --input, --output)",
        ),
        (vec!["response", "one.csv", "--input", "fx_n*", "--output", "fx_n"], 2, "the input: "),
        (vec!["response", "one.csv", "--input", "fx_n", "--output", "fx_n"], 1, "twice"),
    ] {
        let done = place.run(&arguments);
        assert_eq!(done.code(), code, "{arguments:?}: {}", done.error());
        assert!(done.error().contains(words), "{arguments:?}: {}", done.error());
    }
    assert!(!place.path("x.csv").exists());
}
