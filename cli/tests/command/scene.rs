//! Scenes as a user plans, renders and plays them.

use std::collections::BTreeSet;
use std::io::Write;
use std::path::PathBuf;
use std::process::{Child, Stdio};
use std::time::Duration;

use crate::common::{Place, entries, signal, until};
use serde_json::{Value, json};

const EXAMPLES: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../examples/scenes");

/// A place with the assets of the examples.
fn place() -> Place {
    let place = Place::new();
    for name in ["coarse-fabric.htex", "vinyl.htex", "hand.csv", "display.csv"] {
        place.write(name, std::fs::read(format!("{EXAMPLES}/{name}")).unwrap());
    }
    place
}

/// A scene of one surface, with `more` over it.
fn scene(place: &Place, more: Value) -> PathBuf {
    place.scene("s.scene.json", "coarse-fabric.htex", &more)
}

fn keys(value: &Value) -> BTreeSet<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}

fn names(list: &Value) -> Vec<&str> {
    let all = list.as_array().unwrap().iter();
    all.map(|entry| entry["name"].as_str().unwrap()).collect()
}

/// Starts `htex` with a pipe to its standard input.
fn start(place: &Place, arguments: &[&str]) -> Child {
    let mut command = place.command(arguments);
    command.stdin(Stdio::piped()).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().unwrap()
}

/// Waits until a file is being written in the place.
fn wait_for_part(place: &Place) {
    let is_part = |name: &String| name.ends_with(".part");
    until("something is written", || entries(&place.path("")).iter().any(is_part));
}

#[test]
fn the_examples_are_planned_and_rendered_and_what_is_planned_runs() {
    let place = Place::new();
    for name in ["constant", "two-swatches", "electrovibration"] {
        let file = format!("{EXAMPLES}/{name}.scene.json");
        let plan = place.json(&["plan", &file, "--json"]);
        for key in ["stages", "left_out", "representation", "ns_per_sample_total"] {
            assert!(keys(&plan).contains(key), "{name}: no {key}");
        }
        for stage in plan["stages"].as_array().unwrap() {
            for key in ["name", "reason", "rate_hz", "ns_per_sample"] {
                assert!(keys(stage).contains(key), "{name}: {stage} has no {key}");
            }
        }
        let reasons = plan["left_out"].as_array().unwrap().iter();
        assert!(reasons.clone().all(|out| !out["reason"].as_str().unwrap().is_empty()));
        let run = place.json(&["render", &file, "-o", "o.wav", "--json"]);
        for key in ["file", "frames", "rate_hz", "stages_run", "peak", "limited_samples"] {
            assert!(keys(&run).contains(key), "{name}: no {key}");
        }
        assert_eq!(names(&run["stages_run"]), names(&plan["stages"]), "{name}");
        assert_eq!(run["file"], "o.wav");
        let samples = place.samples("o.wav");
        assert_eq!(run["frames"], samples.len(), "{name}");
        let peak = samples.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
        assert!((run["peak"].as_f64().unwrap() - f64::from(peak)).abs() < 1e-6 && peak > 0.0);
    }
    assert_eq!(entries(&place.path("")), ["o.wav"]);
    let constant = format!("{EXAMPLES}/constant.scene.json");
    let plan = place.json(&["plan", &constant, "--json"]);
    assert_eq!(names(&plan["stages"]), ["synthesis", "level", "resampling"]);
    let text = place.run(&["plan", &constant, "--svg", "c.svg"]).text();
    let svg = std::fs::read_to_string(place.path("c.svg")).unwrap();
    for name in names(&plan["stages"]).iter().chain(&names(&plan["left_out"])) {
        assert!(text.contains(name) && svg.contains(name), "{name}");
    }
    assert!(svg.starts_with("<svg ") && svg.ends_with("</svg>"));
}

#[test]
fn the_drive_of_a_card_that_is_not_there_is_rendered_as_its_volts() {
    let place = place();
    let mut device = json!({
        "adapter": "daq",
        "profile": "pcie-6321_tabor-9200a_sct3250",
        "settings": { "device": "NoSuchCard/ao0" },
        "drive_v": 60,
    });
    scene(&place, json!({ "device": device, "duration_s": 1 }));
    let run = place.json(&["render", "s.scene.json", "-o", "v.wav", "--json"]);
    assert_eq!((&run["unit"], &run["limited_samples"]), (&json!("V"), &json!(0)));
    let peak = run["peak"].as_f64().unwrap();
    assert!((40.0..66.0).contains(&peak), "{peak} V");
    assert!(names(&run["stages_run"]).contains(&"carrier"), "{run}");
    // It is not played, and a scene cannot name a driver.
    assert_eq!(place.run(&["play", "s.scene.json"]).code(), 1);
    device["settings"]["driver"] = json!("libother.so");
    scene(&place, json!({ "device": device }));
    let plan = place.run(&["plan", "s.scene.json"]);
    assert!(plan.error().contains("DEVICE_PATH_UNSAFE"), "{}", plan.error());
}

#[test]
fn what_is_wrong_is_told_with_code_and_pointer_and_nothing_is_written() {
    let place = place();
    scene(&place, json!({ "duration_s": -1, "effects": {}, "loudness": 3 }));
    for command in ["plan", "render", "play"] {
        let run = place.run(&[command, "s.scene.json"]);
        assert_eq!(run.code(), 1, "{command}");
        for finding in ["SCENE_UNKNOWN_KEY at /loudness", "DURATION_INVALID at /duration_s"] {
            assert!(run.error().contains(finding), "{command}: {}", run.error());
        }
    }
    scene(&place, json!({}));
    let endless = place.run(&["render", "s.scene.json"]);
    assert_eq!(endless.code(), 1);
    assert!(endless.error().contains("--seconds"), "{}", endless.error());
    assert_eq!(place.run(&["render", "gone.scene.json"]).code(), 1);
    assert!(!entries(&place.path("")).iter().any(|name| name.ends_with(".wav")));
}

#[test]
fn the_schema_of_scenes_is_printed() {
    assert_eq!(Place::new().json(&["schema", "scene"])["title"], "Scene of htex 1");
}

#[test]
fn a_live_motion_comes_through_standard_input() {
    let place = place();
    scene(&place, json!({ "motion": "live" }));
    let mut child =
        start(&place, &["play", "s.scene.json", "--motion", "-", "--set", "path=l.wav"]);
    let mut input = child.stdin.take().unwrap();
    for line in ["80 0.4\n", "faster\n", "-80 0.4\n"] {
        input.write_all(line.as_bytes()).unwrap();
        std::thread::sleep(Duration::from_millis(300));
    }
    drop(input);
    let done = child.wait_with_output().unwrap();
    let error = String::from_utf8(done.stderr).unwrap();
    assert!(done.status.success(), "{error}");
    assert!(error.contains("line 2, \"faster\""), "{error}");
    let samples = place.samples("l.wav");
    assert!(samples.iter().any(|x| x.abs() > 1e-3), "it is silent");
    assert!(samples.len() > 5000, "{} samples", samples.len());
    // Without the option the same scene says what it wants.
    assert_eq!(place.run(&["play", "s.scene.json"]).code(), 2);
}

#[cfg(unix)]
#[test]
fn an_interrupted_play_ends_at_zero_and_an_interrupted_render_leaves_nothing() {
    let place = place();
    let device = json!({ "settings": { "quantity": "display_voltage", "limit_v": 100 } });
    scene(&place, json!({ "device": device }));
    let child = start(&place, &["play", "s.scene.json", "--set", "path=p.wav"]);
    wait_for_part(&place);
    std::thread::sleep(Duration::from_millis(300));
    signal(&child, "-INT");
    let done = child.wait_with_output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let played = place.samples("p.wav");
    let peak = played.iter().fold(0.0f32, |peak, x| peak.max(x.abs()));
    let last = played.last().unwrap();
    assert!(last.abs() < 0.02 * peak, "it ends at {last} V, and its peak is {peak} V");

    scene(&place, json!({ "duration_s": 1e6 }));
    let before = entries(&place.path(""));
    let child = start(&place, &["render", "s.scene.json", "-o", "r.raw"]);
    wait_for_part(&place);
    signal(&child, "-INT");
    let done = child.wait_with_output().unwrap();
    assert_eq!(done.status.code(), Some(1));
    assert_eq!(entries(&place.path("")), before);
}
