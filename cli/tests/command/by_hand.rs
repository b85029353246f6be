//! Textures from no recording, as a user makes them.

use crate::common::Place;

/// A made texture says so, is valid, and plays with the level that was asked for.
#[test]
fn a_texture_is_made_of_parameters() {
    let place = Place::new();
    let make = ["make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02"];
    let more = ["--at", "speed=80,force=0.4", "--license", "CC0-1.0", "-o", "new.htex"];
    let made = place.json(&[&make[..], &more, &["--json"]].concat());
    let made = &made["manifest"];
    assert_eq!(made["name"], "new");
    assert_eq!(made["provenance"]["made"]["how"], "parameters");
    let info = place.json(&["info", "new.htex", "--json"]);
    assert_eq!(info["manifest"]["provenance"]["made"]["how"], "parameters");
    assert!(place.run(&["info", "new.htex"]).text().contains("made by hand"));
    assert_eq!(place.run(&["validate", "new.htex"]).code(), 0);
    assert_eq!(place.run(&["synth", "new.htex", "--seconds", "20", "-o", "new.wav"]).code(), 0);
    let rms = crate::common::rms(&place.samples("new.wav"));
    assert!((rms / 0.02 - 1.0).abs() < 0.05, "{rms}");
}

#[test]
fn parameters_are_checked() {
    let place = Place::new();
    let make = |model: &str, set: &[&str], level: &str| {
        let words =
            [&["make", "--model", model, "--level", level, "-o", "x.htex", "--set"], set].concat();
        let run = place.run(&words);
        assert!(!place.path("x.htex").exists());
        (run.code(), run.error())
    };
    for (model, set, level, words) in [
        ("sbeta", &["alpha=2"][..], "0.02", "needs a value for beta ("),
        (
            "sbeta",
            &["alpha=2", "beta=5", "gamma=1"],
            "0.02",
            "no parameter \"gamma\"; it has alpha (",
        ),
        ("sbeta", &["alpha=2", "alpha=3"], "0.02", "given twice"),
        ("sbeta", &["alpha=-1", "beta=5"], "0.02", "alpha = -1: it is "),
        ("sbeta", &["alpha=2,3", "beta=5"], "0.02", "it is one number"),
        ("sbeta", &["alpha=x", "beta=5"], "0.02", "not a number"),
        ("sbeta", &["alpha"], "0.02", "no `=`"),
        ("sbeta", &["alpha=2", "beta=5"], "2e6", "from 0 to 1000000"),
        ("nothing", &["alpha=2"], "0.02", "nothing"),
    ] {
        let (code, error) = make(model, set, level);
        assert!(code != 0 && error.contains(words), "{code} {error}");
    }
}

/// Between two textures each model interpolates as between conditions: weight 0 and 1 are the
/// textures themselves.
#[test]
fn textures_are_mixed() {
    let place = Place::new();
    for surface in ["vinyl", "sandpaper"] {
        let recording = place.recording(surface);
        let asset = format!("{surface}.htex");
        let fit = ["fit", &recording, "--model", "bands,sbeta", "--at", "speed=80,force=0.4"];
        assert_eq!(place.run(&[&fit[..], &["-o", &asset]].concat()).code(), 0);
    }
    let mix = |weight: &str, output: &str| {
        let words = ["mix", "vinyl.htex", "sandpaper.htex", "--weight", weight];
        place.json(&[&words[..], &["-o", output, "--json"]].concat())
    };
    let half = mix("0.25", "mixed.htex")["manifest"]["provenance"].clone();
    assert_eq!(half["made"]["how"], "mixed");
    assert_eq!(half["made"]["from"][0]["weight"], 0.75);
    assert_eq!(half["simulated"], true);
    let hash = |file: &str| blake3::hash(&std::fs::read(place.path(file)).unwrap()).to_hex();
    assert_eq!(half["made"]["from"][1]["blake3"], hash("sandpaper.htex").to_string());
    assert_eq!(place.run(&["validate", "mixed.htex"]).code(), 0);
    let magnitude = |file: &str| {
        let asset = htex::Texture::open(place.path(file)).unwrap();
        let hertz: Vec<f64> = (4..=200).map(|k| 5.0 * f64::from(k)).collect();
        asset.representation("bands").unwrap().magnitude(None, &hertz).unwrap()
    };
    mix("0", "first.htex");
    mix("1", "second.htex");
    let level = |m: &[f64]| m.iter().map(|x| x * x).sum::<f64>().sqrt();
    let (a, b, c) = (magnitude("vinyl.htex"), magnitude("mixed.htex"), magnitude("sandpaper.htex"));
    for (one, other) in [(&a, magnitude("first.htex")), (&c, magnitude("second.htex"))] {
        let off = one.iter().zip(&other).map(|(x, y)| (x - y).abs()).fold(0.0, f64::max);
        assert!(off <= 1e-6 * level(one), "{off}");
    }
    let expected = 0.75 * level(&a) + 0.25 * level(&c);
    assert!((level(&b) / expected - 1.0).abs() < 1e-3, "{} {expected}", level(&b));

    let fit = ["fit", "vinyl.csv", "--model", "ar", "--at", "speed=80,force=0.4", "-o", "ar.htex"];
    assert_eq!(place.run(&fit).code(), 0);
    let other = place.run(&["mix", "ar.htex", "sandpaper.htex", "--weight", "0.5", "-o", "x.htex"]);
    assert!(
        other.code() == 1 && other.error().contains("no model describes both"),
        "{}",
        other.error()
    );
    let wrong =
        place.run(&["mix", "vinyl.htex", "sandpaper.htex", "--weight", "1.5", "-o", "x.htex"]);
    assert!(wrong.code() != 0 && wrong.error().contains("from 0"), "{}", wrong.error());
}
