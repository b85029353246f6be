//! Gains of people, found and played with.

use std::io::Write;
use std::process::Stdio;

use crate::common::Place;
use serde_json::{Value, json};

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");

/// A place with two textures.
fn place() -> Place {
    let place = Place::new();
    for name in ["coarse-fabric.htex", "vinyl.htex"] {
        place.write(name, std::fs::read(format!("{EXAMPLES}/{name}")).unwrap());
    }
    place
}

/// A display that is a file, 100 V at most.
const DISPLAY: [&str; 6] =
    ["--device", "file", "--set", "quantity=display_voltage", "--set", "limit_v=100"];

/// Runs a command for a display, gains kept in the place: exit code and standard error.
fn felt(place: &Place, arguments: &[&str], input: &str) -> (Option<i32>, String) {
    let mut command = place.command(&[arguments, &DISPLAY].concat());
    command.env("HTEX_CONFIG_DIR", place.path("own"));
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    let mut child = command.spawn().unwrap();
    let mut stdin = child.stdin.take().unwrap();
    stdin.write_all(input.as_bytes()).unwrap();
    drop(stdin);
    let done = child.wait_with_output().unwrap();
    (done.status.code(), String::from_utf8(done.stderr).unwrap())
}

#[test]
fn a_gain_is_found_by_adjustment_and_played_with() {
    let place = place();
    let run = |arguments: &[&str], input: &str| felt(&place, arguments, input);
    let gain = ["gain", "coarse-fabric.htex", "--person", "Ann"];
    let (code, error) = run(&gain, "-\nlouder\n--\n++\n\n");
    assert_eq!(code, Some(0), "{error}");
    assert!(error.contains("10.0 V at most") && error.contains("\"louder\" is not"), "{error}");
    let text = std::fs::read_to_string(place.path("own/gains.json")).unwrap();
    let kept: Value = serde_json::from_str(&text).unwrap();
    let drive_v = kept["gains"][0]["drive_v"].as_f64().unwrap();
    assert!((drive_v - 10.0 * 10f64.powf(-1.0 / 20.0)).abs() < 1e-9, "{drive_v} V");
    // Without a match nothing changes.
    assert_eq!(run(&gain, "--\n").0, Some(1));
    assert_eq!(std::fs::read_to_string(place.path("own/gains.json")).unwrap(), text);

    let play = |person: &str, file: &str| {
        let set = format!("path={file}");
        let play =
            ["play", "coarse-fabric.htex", "--seconds", "1", "--set", &set, "--person", person];
        run(&play, "")
    };
    assert_eq!(play("Ann", "a.wav").0, Some(0));
    let peak = place.samples("a.wav").iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    assert!(f64::from(peak) < 1.1 * drive_v && f64::from(peak) > 0.6 * drive_v, "{peak} V");
    let (code, error) = play("Bob", "b.wav");
    assert_eq!(code, Some(1));
    assert!(error.contains("no gain is kept for Bob"), "{error}");
    // The device's limit may have been lowered since, or the file written by hand.
    for (wrong, what) in [
        ("-1", "not above 0"),
        ("0", "not above 0"),
        ("1e300", "device's limit of 100 V"),
        ("100.5", "device's limit of 100 V"),
    ] {
        let text = text.replace(&drive_v.to_string(), wrong);
        place.write("own/gains.json", &text);
        let (code, error) = play("Ann", "c.wav");
        assert_eq!(code, Some(1), "{wrong}: {error}");
        assert!(error.contains(what), "{error}");
    }
}

/// The paper's protocol: the gain is found with AR, and all models of the texture are played with
/// it.
#[test]
fn one_gain_serves_all_representations_of_a_texture() {
    let place = place();
    let run = |arguments: &[&str], input: &str| felt(&place, arguments, input);
    let ann = ["--person", "Ann"];
    let gain = [&["gain", "coarse-fabric.htex", "--model", "ar"], &ann[..]].concat();
    let (code, error) = run(&gain, "--\n\n");
    assert_eq!(code, Some(0), "{error}");

    // A level of each model, from the squares of the voltage.
    let level_db = |file: &str, model: &str, more: &[&str]| {
        let play = ["play", file, "--model", model, "--seconds", "4", "--set", "path=d.wav"];
        let (code, error) = run(&[&play, &ann[..], more].concat(), "");
        assert_eq!(code, Some(0), "{model}: {error}");
        let volts = place.samples("d.wav");
        let squares: Vec<f64> =
            volts[2_000..volts.len() - 2_000].iter().map(|v| f64::from(*v).powi(2)).collect();
        let mean = squares.iter().sum::<f64>() / squares.len() as f64;
        let power: f64 = squares.iter().map(|x| (x - mean).powi(2)).sum();
        (10.0 * (power / squares.len() as f64).log10(), error)
    };
    let asset = htex_format::Asset::open(&place.path("coarse-fabric.htex")).unwrap();
    let level_rms = |model: &str| {
        let mut all = asset.manifest.representations.iter();
        all.find(|r| r.model.ends_with(model)).unwrap().at[0].level_rms
    };
    let (ar_db, _) = level_db("coarse-fabric.htex", "ar", &[]);
    for model in ["sbeta", "sslope"] {
        let own_db = 20.0 * (level_rms(model) / level_rms("ar")).log10();
        assert!(own_db > 2.0, "{model}: {own_db} dB");
        for (levels, wanted_db) in [("normalised", 0.0), ("own", own_db)] {
            let (found_db, _) = level_db("coarse-fabric.htex", model, &["--levels", levels]);
            let found_db = found_db - ar_db;
            println!("{model}, {levels}: {found_db:.2} dB over AR, wanted {wanted_db:.2} dB");
            // Four seconds of noise; above half the drive some radicands are held at zero.
            assert!((found_db - wanted_db).abs() < 0.7, "{model}, {levels}: {found_db} dB");
        }
    }

    // Fitted again; of another name; of the same name, from other recordings.
    let variant = |file: &str, change: &dyn Fn(&mut htex_format::Manifest)| {
        let mut asset = htex_format::Asset::open(&place.path("coarse-fabric.htex")).unwrap();
        change(&mut asset.manifest);
        place.write(file, asset.to_bytes().unwrap());
    };
    variant("anew.htex", &|m| {
        m.name = "Coarse-Fabric  (simulated)".to_owned();
        m.tags = vec!["anew".to_owned()];
    });
    variant("silk.htex", &|m| m.name = "silk".to_owned());
    variant("other.htex", &|m| m.provenance.recordings[0].file = "cord.csv".to_owned());
    let (anew_db, error) = level_db("anew.htex", "ar", &[]);
    assert!((anew_db - ar_db).abs() < 1e-9 && !error.contains("recorded in"), "{error}");
    let (_, error) = level_db("other.htex", "ar", &[]);
    assert!(
        error.contains("recorded in coarse-fabric.csv") && error.contains("cord.csv"),
        "{error}"
    );
    level_db("silk.htex", "ar", &["--texture", "COARSE-FABRIC (simulated)"]);
    let silk = [&["play", "silk.htex", "--seconds", "1", "--set", "path=d.wav"], &ann[..]].concat();
    let (code, error) = run(&silk, "");
    assert!(code == Some(1) && error.contains("no gain is kept for Ann, `silk`"), "{error}");
}

/// Earlier versions kept gains by the hash of the asset.
#[test]
fn a_gain_kept_by_the_hash_of_its_asset_is_found_and_replaced() {
    let place = place();
    let run = |arguments: &[&str], input: &str| felt(&place, arguments, input);
    let hash = htex_scene::Gains::hash_of(&place.path("vinyl.htex")).unwrap();
    let old = json!({ "gains": [{
        "person": "Ann", "blake3": hash, "device": "org.htex.file", "profile": "",
        "file": "vinyl.htex", "drive_v": 50.0,
    }] });
    std::fs::create_dir_all(place.path("own")).unwrap();
    place.write("own/gains.json", old.to_string());
    let play = ["play", "vinyl.htex", "--seconds", "1", "--set", "path=d.wav", "--person", "Ann"];
    let (code, error) = run(&play, "");
    assert_eq!(code, Some(0), "{error}");
    let peak = place.samples("d.wav").iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    assert!((25.0..60.0).contains(&peak), "{peak} V");
    // The level at which it was found is unknown.
    let (code, error) = run(&[&play[..], &["--levels", "own"]].concat(), "");
    assert!(code == Some(1) && error.contains("does not say at which level"), "{error}");

    let gain = ["gain", "vinyl.htex", "--person", "Ann", "--start", "40"];
    assert_eq!(run(&gain, "\n").0, Some(0));
    let text = std::fs::read_to_string(place.path("own/gains.json")).unwrap();
    let kept: Value = serde_json::from_str(&text).unwrap();
    let all = kept["gains"].as_array().unwrap();
    assert!(
        all.len() == 1 && all[0]["texture"] == "vinyl (simulated)" && all[0]["drive_v"] == 40.0,
        "{text}"
    );
    assert_eq!(run(&[&play[..], &["--levels", "own"]].concat(), "").0, Some(0));
}
