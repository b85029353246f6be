//! Findings in recordings, as commands report them.

use std::fmt::Write;

use crate::common::{Place, numbers};
use serde_json::Value;

#[test]
fn fit_warns_of_what_strict_refuses() {
    let place = Place::new();
    let spec = |name: &str| {
        format!("{}/../spec/recording-conformance/{name}.csv", env!("CARGO_MANIFEST_DIR"))
    };
    for (name, place_of_it) in [
        ("recording_clipped", "samples of the lateral force are at"),
        ("recording_spike", "N at 0.6000 s"),
    ] {
        let csv = spec(name);
        let fit = ["fit", &csv, "-o", "x.htex", "--model", "bands"];
        let run = place.run(&fit);
        assert_eq!(run.code(), 0, "{}", run.error());
        let code = name.to_uppercase();
        let warned = run.error().lines().any(|line| {
            line.starts_with("warning: ") && line.contains(&code) && line.contains(place_of_it)
        });
        assert!(warned, "{}", run.error());
        std::fs::remove_file(place.path("x.htex")).unwrap();
        let run = place.run(&[&fit[..], &["--strict"]].concat());
        assert_eq!(run.code(), 1);
        assert!(run.error().contains(&code), "{}", run.error());
        assert!(run.error().contains("(see --strict"), "{}", run.error());
        assert!(!place.path("x.htex").exists());
    }
    // The command names the flags that set what the libraries describe.
    for arguments in [
        &["fit", &spec("recording_spike"), "-o", "x.htex", "--model", "bands"][..],
        &["fit", &spec("recording_spike"), "-o", "x.htex", "--strict"],
        &["validate", &spec("recording_spike")],
        &["explain", "recording_spike"],
    ] {
        let run = place.run(arguments);
        let printed = run.text() + &run.error();
        let named = printed
            .lines()
            .any(|line| line.contains("repair") && line.ends_with("(see --from, --to)"));
        assert!(named || printed.contains("again (see --from, --to)."), "{printed}");
    }
    let run = place.run(&["fit", &spec("valid"), "-o", "x.htex", "--model", "bands", "--strict"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    let fitted = place.json(&["fit", &spec("valid"), "-o", "x.htex", "--model", "bands", "--json"]);
    assert!(fitted["notes"].to_string().contains("1 of 4 sweeps left out"), "{fitted}");
    let run = place.run(&["validate", "x.htex", "--rate", "1000"]);
    assert_eq!(run.code(), 2, "an option that nothing takes is wrong usage: {}", run.error());
}

/// One stroke of 8.5 s at 10 kHz in volts, between two rests: where its middle lies the surface is
/// smooth.
fn stroke() -> String {
    let mut csv = String::from("lateral_V,normal_V\n");
    let mut state = 1u64;
    for at in 0..85_000 {
        let t = f64::from(at) / 10_000.0;
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let noise = (state >> 40) as f64 / f64::from(1u32 << 23) - 1.0;
        let slides = ((t - 0.3).min(8.2 - t) / 0.1).clamp(0.0, 1.0);
        let rough = if (t - 4.25).abs() < 0.5 { 0.2 } else { 1.0 };
        let lateral = slides * (0.3 + 0.01 * rough * noise) + 1e-4 * noise;
        writeln!(csv, "{:.6},{:.5}", lateral / 0.4444, (0.4 + 1e-3 * noise) / 0.31).unwrap();
    }
    csv
}

#[test]
fn a_long_stroke_is_read_in_windows_and_drawn() {
    let place = Place::new();
    place.write("stroke.csv", stroke());
    let map = "lateral=lateral_V:0.4444,normal=normal_V:0.31";
    let process = |more: &[&str]| {
        let all = ["process", "stroke.csv", "--rate", "10000", "--map", map, "--json"];
        place.json(&[&all[..], more].concat())
    };
    let level = |of: &Value| numbers(&of["magnitude"]).iter().map(|m| m * m).sum::<f64>().sqrt();
    let auto = process(&["--svg", "stroke.svg"]);
    assert_eq!(auto["segments_from"], "windows");
    assert_eq!(auto["read_s"].to_string(), "[[0.0,8.5]]");
    let told = auto["findings"].as_array().unwrap();
    assert!(told.iter().any(|f| f["code"] == "RECORDING_READ_IN_WINDOWS"), "{told:?}");
    let sweeps = process(&["--segments", "sweeps"]);
    assert_eq!(sweeps["segments"], 1);
    let apart_db = 20.0 * (level(&auto) / level(&sweeps)).log10();
    assert!(apart_db > 10.0, "{apart_db}");
    // A range is read as if the file held no more; seconds stay the file's.
    let part = process(&["--from", "1", "--to", "3", "--segments", "windows"]);
    assert_eq!(part["segments"], 19);
    assert_eq!(part["read_s"].to_string(), "[[1.0,3.0]]");
    let picture = std::fs::read_to_string(place.path("stroke.svg")).unwrap();
    assert!(picture.starts_with("<svg ") && picture.contains("read (84 segments)"));
    let range = ["process", "stroke.csv", "--rate", "10000", "--map", map, "--from", "9"];
    let run = place.run(&range);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("0.000 to 8.500 s"), "{}", run.error());
}
