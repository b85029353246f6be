//! The fluctuation of a texture in time: from a recording to samples.

use crate::common::Place;
use htex_dsp::noise::GaussianNoise;
use htex_dsp::random_envelope::RandomEnvelope;
use htex_format::{Asset, Fluctuation};

const RATE_HZ: u32 = 4_000;
const STRENGTH_DB: [f64; 2] = [4.0, 3.0];

fn steps(slow: u8, fast: u8) -> Fluctuation {
    Fluctuation { slow, fast, ..Fluctuation::default() }
}

/// 30 s of white noise whose level fluctuates.
fn recorded(place: &Place) {
    let spec = hound::WavSpec {
        channels: 1,
        sample_rate: RATE_HZ,
        bits_per_sample: 32,
        sample_format: hound::SampleFormat::Float,
    };
    let mut samples = vec![0.0; 30 * RATE_HZ as usize];
    GaussianNoise::new(1).fill(&mut samples);
    RandomEnvelope::new(STRENGTH_DB, RATE_HZ.into(), 2).apply(&mut samples);
    let mut wav = hound::WavWriter::create(place.path("rec.wav"), spec).unwrap();
    samples.iter().for_each(|x| wav.write_sample(0.1 * x).unwrap());
    wav.finalize().unwrap();
}

#[test]
fn a_fit_states_the_fluctuation_and_a_voice_plays_it_when_asked() {
    let place = Place::new();
    recorded(&place);
    let fit = ["fit", "rec.wav", "--segments", "windows", "--model", "bands", "-o", "new.htex"];
    let fit = [&fit[..], &["--report", "page.html"]].concat();
    let run = place.run(&fit);
    assert_eq!(run.code(), 0, "{}", run.error());
    let info = place.json(&["info", "new.htex", "--json"]);
    assert_eq!(info["manifest"]["htex"], "1.1");
    let stored: Fluctuation =
        serde_json::from_value(info["manifest"]["fluctuation"].clone()).unwrap();
    for (found, wanted) in stored.decibels().into_iter().zip(STRENGTH_DB) {
        assert!((found / wanted - 1.0).abs() < 0.2, "{stored}");
    }
    let line = format!("fluctuation in time: {stored}");
    let text = place.run(&["info", "new.htex"]).text();
    assert!(text.contains(&line), "{text}");
    let [held_out, halves] = [stored.held_out_error_db, stored.halves_error_db].map(Option::unwrap);
    // Both halves and the parts of the rendering last 15 s and fluctuate alike.
    assert!((0.1..5.0).contains(&held_out) && (0.1..5.0).contains(&halves), "{stored:?}");
    let line = format!(
        "fluctuation error: {held_out:.2} dB held out, {halves:.2} dB between the halves of the recordings"
    );
    assert!(text.contains(&line), "{text}");
    let page = std::fs::read_to_string(place.path("page.html")).unwrap();
    assert!(page.contains(&line), "{page}");
    assert_eq!(place.run(&["validate", "new.htex"]).code(), 0);

    let mut steady = Asset::open(&place.path("new.htex")).unwrap();
    steady.manifest.fluctuation = None;
    place.write("steady.htex", steady.to_bytes().unwrap());
    let samples = |asset: &str, more: &[&str]| {
        let synth = ["synth", asset, "--seconds", "60", "--rate", "2000", "-o", "out.wav"];
        assert_eq!(place.run(&[&synth[..], more].concat()).code(), 0);
        place.samples("out.wav")
    };
    let plain = samples("steady.htex", &[]);
    assert!(plain == samples("new.htex", &[]));
    assert!(plain == samples("steady.htex", &["--fluctuation"]));
    let fluctuates = samples("new.htex", &["--fluctuation"]);
    assert!(plain != fluctuates);
    // The envelope's own mean square has a standard deviation of about 6 % over a minute.
    let change = crate::common::rms(&fluctuates) / crate::common::rms(&plain);
    assert!((change - 1.0).abs() < 0.1, "{change}");

    let compared = place.json(&["compare", "rec.wav", "new.htex", "--json"]);
    assert!(compared.to_string().contains("fluctuation_error_db"));
    let bake = place.run(&["bake", "new.htex", "-o", "new.bin"]);
    assert_eq!(bake.code(), 0);
    assert!(bake.error().contains("fluctuation in time"), "{}", bake.error());
}

/// A user sets the fluctuation of a texture that is made or edited, and removes it.
#[test]
fn a_user_sets_and_removes_the_fluctuation() {
    let place = Place::new();
    let stated = |file: &str| Asset::open(&place.path(file)).unwrap().manifest.fluctuation;
    let make = |more: &[&str]| {
        let make = ["make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02"];
        place.run(&[&make[..], &["-o", "hum.htex"], more].concat())
    };
    let bytes = || std::fs::read(place.path("hum.htex")).unwrap();
    assert_eq!(make(&["--fluctuation", "0,0"]).code(), 0);
    let steady = bytes();
    assert_eq!(make(&[]).code(), 0);
    assert!(bytes() == steady);
    assert_eq!(stated("hum.htex"), None);
    let made = make(&["--fluctuation", "3,1.52"]);
    assert!(made.text().contains("fluctuation in time: 3.00 dB"), "{}", made.text());
    assert_eq!(stated("hum.htex"), Fluctuation::from_db([3.0, 1.52]));
    assert_eq!(place.run(&["validate", "hum.htex"]).code(), 0);

    let edit = |value: &str| {
        let edit = ["edit", "hum.htex", "--fluctuation", value, "-o", "edited.htex"];
        let run = place.run(&edit);
        (run.code(), run.error())
    };
    for (value, strength_db) in
        [("0, 2", [0.0, 2.0]), ("7.97,7.97", [255.0 / 32.0; 2]), ("0.5,0", [0.5, 0.0])]
    {
        assert_eq!(edit(value).0, 0);
        assert_eq!(stated("edited.htex").unwrap().decibels(), strength_db, "{value}");
    }
    assert_eq!(edit("0,0").0, 0);
    assert!(std::fs::read(place.path("edited.htex")).unwrap() == steady);
    for (value, words) in [
        ("3", "two numbers"),
        ("3,x", "two numbers"),
        ("3,1,2", "two numbers"),
        ("", "two numbers"),
        ("8,0", "8 dB is not"),
        ("7.98,0", "from 0 to 7.97"),
        ("-1,0", "-1 dB is not"),
        ("0,nan", "from 0 to 7.97"),
        ("inf,0", "from 0 to 7.97"),
    ] {
        let (code, error) = edit(value);
        assert!(code == 2 && error.contains("--fluctuation") && error.contains(words), "{error}");
        assert_eq!(make(&["--fluctuation", value]).code(), 2);
    }
    let nothing = place.run(&["edit", "hum.htex"]);
    assert!(nothing.code() == 2 && nothing.error().contains("nothing to change"));
}

/// An edited texture keeps its fluctuation, and a mixture has the weighted mean.
#[test]
fn edits_keep_the_fluctuation_and_mixtures_have_its_mean() {
    let place = Place::new();
    let recording = place.recording("sandpaper");
    let fit = ["fit", &recording, "--model", "bands", "--at", "speed=80,force=0.4"];
    assert_eq!(place.run(&[&fit[..], &["-o", "one.htex"]].concat()).code(), 0);
    let mut asset = Asset::open(&place.path("one.htex")).unwrap();
    asset.manifest.fluctuation = None;
    place.write("steady.htex", asset.to_bytes().unwrap());
    asset.manifest.fluctuation = Some(Fluctuation {
        held_out_error_db: Some(3.5),
        halves_error_db: Some(3.0),
        ..steps(100, 40)
    });
    place.write("moving.htex", asset.to_bytes().unwrap());
    let stated = |file: &str| Asset::open(&place.path(file)).unwrap().manifest.fluctuation;

    let edit = ["edit", "moving.htex", "--name", "Other", "-o", "edited.htex"];
    assert_eq!(place.run(&edit).code(), 0);
    assert_eq!(stated("edited.htex"), stated("moving.htex"));
    assert!(stated("edited.htex").unwrap().held_out_error_db.is_some());
    let edit = ["edit", "edited.htex", "--fluctuation", "3.125,1.25"];
    assert_eq!(place.run(&edit).code(), 0);
    assert_eq!(stated("edited.htex"), Some(steps(100, 40)));
    let mix = |a: &str, b: &str| {
        let mix = ["mix", a, b, "--weight", "0.75", "-o", "mixed.htex"];
        assert_eq!(place.run(&mix).code(), 0);
        stated("mixed.htex")
    };
    let quarter = Some(steps(25, 10));
    assert!([quarter, Some(steps(75, 30))].contains(&mix("moving.htex", "steady.htex")));
    assert_ne!(mix("moving.htex", "steady.htex"), mix("steady.htex", "moving.htex"));
    assert_eq!(mix("steady.htex", "steady.htex"), None);
    assert_eq!(mix("moving.htex", "moving.htex"), Some(steps(100, 40)));
}
