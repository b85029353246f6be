//! Recordings in other formats, and files that are not recordings.

use std::fmt::Write;

use crate::common::{Place, computed, entries, numbers, stated};

/// Friction of a to-and-fro movement with a texture, newtons, at a rate.
fn friction(rate_hz: f64, seconds: f64) -> Vec<f64> {
    let mut state = 1u64;
    (0..(rate_hz * seconds) as usize)
        .map(|n| {
            let t = n as f64 / rate_hz;
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            let noise = (state >> 40) as f64 / (1u64 << 24) as f64 - 0.5;
            let stroke = (std::f64::consts::TAU * 0.4 * t).sin();
            let texture = 0.02 * (std::f64::consts::TAU * 110.0 * t).sin() + 0.02 * noise;
            stroke.signum() * stroke.abs().powf(0.3) * (0.2 + texture)
        })
        .collect()
}

fn strongest_hz(spectrum: &serde_json::Value) -> f64 {
    let magnitude = numbers(&spectrum["magnitude"]);
    let top = (0..magnitude.len()).max_by(|&a, &b| magnitude[a].total_cmp(&magnitude[b])).unwrap();
    spectrum["frequency_hz"][top].as_f64().unwrap()
}

#[test]
fn bare_finger_csv_in_volts_at_10_khz() {
    let place = Place::new();
    let mut csv = String::from("lateral_V,normal_V\n");
    for f in friction(10_000.0, 6.0) {
        writeln!(csv, "{:.6},{:.6}", f / 0.4444, 0.4 / 0.31).unwrap();
    }
    place.write("finger.csv", csv);
    // Without a scale, volts are refused, and the message says what to give.
    let run = place.run(&["process", "finger.csv", "--rate", "10000"]);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("--map"), "{}", run.error());
    let map = "lateral=lateral_V:0.4444,normal=normal_V:0.31";
    let process = place.json(&["process", "finger.csv", "--rate", "10000", "--map", map, "--json"]);
    assert_eq!(process["rate_hz"], 10_000.0);
    assert!((process["force_n"].as_f64().unwrap() - 0.4).abs() < 1e-4);
    assert_eq!(strongest_hz(&process), 110.0);
    let magnitude = numbers(&process["magnitude"]);
    assert!((magnitude[18] - 0.02).abs() < 0.005, "{}", magnitude[18]);
    let arguments =
        ["fit", "finger.csv", "--rate", "10000", "--map", map, "-o", "finger.htex", "--json"];
    assert_eq!(place.json(&arguments)["representations"].as_array().unwrap().len(), 6);
}

#[test]
fn csv_at_1_khz_with_speed_force_accel_friction() {
    let place = Place::new();
    let mut csv = String::from("speed,force,accel,friction\n");
    for f in friction(1_000.0, 8.0) {
        writeln!(csv, "80,0.5,0.01,{f:.6}").unwrap();
    }
    place.write("tribometer.csv", csv);
    let arguments = ["fit", "tribometer.csv", "--rate", "1000", "-o", "t.htex", "--json"];
    let fit = place.json(&arguments);
    let manifest = &fit["manifest"];
    assert_eq!(manifest["band"]["high_hz"], 500.0);
    let warnings = manifest["provenance"]["warnings"].to_string();
    assert!(warnings.contains("500 Hz") && warnings.contains("accel"), "{warnings}");
    assert_eq!(manifest["conditions"][0]["speed_mm_s"], 80.0);
    assert_eq!(manifest["conditions"][0]["force_n"], 0.5);
    let spectrum = place.json(&["spectrum", "t.htex", "--model", "speak", "--json"]);
    assert_eq!(strongest_hz(&spectrum), 110.0);
    // Above the band there is nothing, and the asset plays at any rate all the same.
    assert_eq!(numbers(&spectrum["magnitude"])[150], 0.0);
    let run = place.run(&["synth", "t.htex", "--seconds", "1", "--rate", "48000", "-o", "t.wav"]);
    assert_eq!(run.code(), 0, "{}", run.error());
}

/// A warning about several recordings is printed once, with their number and names.
#[test]
fn warnings_of_several_recordings_are_one() {
    let place = Place::new();
    let names = ["a.csv", "b.csv", "c.csv"];
    let mut csv = String::from("lateral_n,temperature\n");
    for f in friction(10_000.0, 3.0) {
        writeln!(csv, "{f:.6},21").unwrap();
    }
    for name in names {
        place.write(name, &csv);
    }
    let mut arguments = vec!["fit", "--rate", "10000", "--model", "sbeta", "-o", "t.htex"];
    arguments.extend(names);
    let run = place.run(&arguments);
    let warnings: Vec<String> = run.error().lines().map(str::to_owned).collect();
    let of_all = warnings.iter().filter(|line| line.contains("Columns not used: temperature"));
    let of_all: Vec<&String> = of_all.collect();
    assert_eq!(of_all.len(), 1, "{warnings:?}");
    assert!(of_all[0].contains("3 recordings (a.csv, b.csv, c.csv): "), "{}", of_all[0]);
}

#[test]
fn wav_at_44_100_hz() {
    let place = Place::new();
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: 44_100,
        bits_per_sample: 16,
        sample_format: hound::SampleFormat::Int,
    };
    let mut wav = hound::WavWriter::create(place.path("stroke.wav"), spec).unwrap();
    for f in friction(44_100.0, 5.0) {
        wav.write_sample((f / 2.0 * 32_767.0) as i16).unwrap();
    }
    wav.finalize().unwrap();
    let condition = ["--scale", "2", "--at", "speed=80,force=0.4"];
    let arguments = ["fit", "stroke.wav", "-o", "w.htex", "--json"];
    let fit = place.json(&[&arguments[..], &condition].concat());
    assert_eq!(fit["manifest"]["conditions"][0]["speed_mm_s"], 80.0);
    let compared = place.json(&["compare", "stroke.wav", "w.htex", "--json", condition[0], "2"]);
    // The default model of the asset against its own recording: what fit said.
    for i in 0..5 {
        let key = "band_error_rms_db";
        let found = &compared["representations"][i];
        let (a, b) = (&stated(&fit, i)["quality"][key], &found[key]);
        assert!((a.as_f64().unwrap() - b.as_f64().unwrap()).abs() < 1e-6, "{i}: {a} {b}");
        let (felt, again) = (&computed(&fit, i)["felt"], &found["felt"]);
        for key in ["below_difference_threshold", "below_if_sensitive", "within_repeatability"] {
            assert!(felt[key].is_boolean() && felt[key] == again[key]);
        }
        let error_db = |of: &serde_json::Value| of["error_rms_db"].as_f64().unwrap();
        assert!((error_db(felt) - error_db(again)).abs() < 1e-6, "{i}");
    }
    assert_eq!(strongest_hz(&place.json(&["process", "stroke.wav", "--json"])), 110.0);
}

/// Two strokes over one kind of surface are nearer than those over two, and a recording is itself.
#[test]
fn recordings_are_compared_with_each_other() {
    let place = Place::new();
    for (file, surface, seed) in
        [("a.csv", "vinyl", "1"), ("b.csv", "vinyl", "2"), ("c.csv", "sandpaper", "1")]
    {
        place.simulated(file, &["--surface", surface, "--seed", seed]);
    }
    let compared = |other: &str| place.json(&["compare", "a.csv", other, "--json"]);
    let (same, other) = (compared("b.csv"), compared("c.csv"));
    let number = |value: &serde_json::Value| value.as_f64().unwrap();
    // Another stroke over the same kind of surface is nearer than another kind.
    for key in ["band_error_rms_db", "third_octave_error_rms_db"] {
        let (near, far) = (number(&same["other"][key]), number(&other["other"][key]));
        assert!(near < 0.6 * far, "{key}: {near} {far}");
    }
    assert!(
        number(&same["other"]["felt"]["error_rms_db"])
            < number(&other["other"]["felt"]["error_rms_db"])
    );
    assert_eq!(other["other"]["felt"]["below_difference_threshold"], false);
    assert!(number(&same["other"]["repeatability_rms_db"]) > 0.0);
    let itself = compared("a.csv");
    assert_eq!(itself["other"]["felt"]["error_rms_db"], 0.0);
    assert_eq!(itself["other"]["felt"]["below_difference_threshold"], true);
    let text = place.run(&["compare", "a.csv", "c.csv"]).text();
    assert!(text.contains("above the difference threshold"), "{text}");
}

#[test]
fn what_is_no_recording_is_refused_with_file_and_line() {
    let place = Place::new();
    place.write("nan.csv", "t_s,fx_n,fz_n\n0.0000,0.1,0.4\n0.0005,NaN,0.4\n0.0010,0.1,0.4\n");
    let run = place.run(&["fit", "nan.csv", "-o", "out.htex"]);
    run.failed(1, &["nan.csv", "line 3", "fx_n"]);
    assert!(!entries(&place.path("")).iter().any(|e| e.contains("htex")));
}

#[test]
fn a_setup_response_is_divided_out() {
    let place = Place::new();
    let csv = place.recording("sandpaper");
    place.write("flat2.csv", "frequency_hz,magnitude\n0,2\n10000,2\n");
    place.write("notch.csv", "frequency_hz,magnitude\n0,1\n400,1\n500,0\n600,1\n10000,1\n");
    let magnitude = |frf: &[&str]| {
        let process = place.json(&[&["process", &csv, "--json"][..], frf].concat());
        (numbers(&process["magnitude"]), process["warnings"].to_string())
    };
    let (plain, _) = magnitude(&[]);
    let (halved, _) = magnitude(&["--frf", "flat2.csv"]);
    for (a, b) in plain.iter().zip(&halved) {
        assert!((a / b - 2.0).abs() < 1e-9);
    }
    let (notched, warnings) = magnitude(&["--frf", "notch.csv"]);
    assert!(warnings.contains("more than 40 dB"), "{warnings}");
    let raised = "dividing by it raises 470 to 530 Hz by up to 40.0 dB";
    assert!(warnings.contains(raised), "{warnings}");
    // At the zero of the response the division stops at 40 dB.
    assert!((notched[96] / plain[96] - 100.0).abs() < 1e-6);
}
