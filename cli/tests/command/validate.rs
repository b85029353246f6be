//! `htex validate`: fields of models, licences, JSON Schemas.

use crate::common::Place;
use serde_json::{Value, json};

const CONFORMANCE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/conformance");

fn report(place: &Place, arguments: &[&str]) -> (i32, Value) {
    let run = place.run(&[&["validate", "--json"], arguments].concat());
    let reports: Value = serde_json::from_str(&run.text()).unwrap();
    (run.code(), reports[0].clone())
}

#[test]
fn findings_name_the_rule_of_the_schema() {
    let place = Place::new();
    let file = format!("{CONFORMANCE}/level_invalid.htex");
    let (code, level) = report(&place, &[&file]);
    assert_eq!(code, 1);
    assert_eq!(level["findings"].as_array().unwrap().len(), 1, "{level}");
    let rule = "manifest-1.json#/$defs/AtCondition/properties/level_rms/minimum";
    assert_eq!(level["findings"][0]["code"], "LEVEL_INVALID");
    assert_eq!(level["findings"][0]["schema_rule"], rule);
    let shown = place.run(&["validate", &file]).text();
    assert!(shown.contains(&format!("schema: {rule}")), "{shown}");
}

#[test]
fn an_extension_is_held_to_its_authors_schema() {
    let place = Place::new();
    let file = format!("{CONFORMANCE}/valid_extension.htex");
    let of_colour = |kind: &str| json!({ "properties": { "colour": { "type": kind } } });
    place.write("right.json", of_colour("string").to_string());
    place.write("wrong.json", of_colour("number").to_string());
    let remote = json!({ "$ref": "https://example.org/look.json" });
    place.write("remote.json", remote.to_string());
    let held = |schema: &str| {
        let argument = format!("com.example.LOOK/1={schema}");
        report(&place, &[&file, "--extension-schema", &argument])
    };
    assert_eq!(held("right.json").0, 0);
    let (code, broken) = held("wrong.json");
    assert_eq!(code, 1);
    let finding = &broken["findings"][0];
    assert_eq!(finding["code"], "EXTENSION_SCHEMA_BROKEN");
    assert_eq!(finding["pointer"], "/extensions/com.example.LOOK~11/colour");
    assert_eq!(finding["schema_rule"], "wrong.json#/properties/colour/type");
    for (argument, words) in [
        ("com.example.LOOK/1=remote.json", "nothing is fetched"),
        ("com.example.LOOK/1=absent.json", "absent.json"),
        ("LOOK=right.json", "com.vendor.NAME/REVISION"),
    ] {
        let run = place.run(&["validate", &file, "--extension-schema", argument]);
        assert_ne!(run.code(), 0, "{argument}");
        assert!(run.error().contains(words), "{argument}: {}", run.error());
    }
}

#[test]
fn descriptors_are_held_to_their_schemas() {
    let place = Place::new();
    let models = place.json(&["schema", "models"]);
    for model in models.as_array().unwrap() {
        place.write("model.json", model.to_string());
        assert_eq!(
            report(&place, &["model.json"]),
            (
                0,
                json!({
                    "file": "model.json", "valid": true, "findings": [],
                })
            )
        );
    }
    let mut model = models[0].clone();
    model["fields"][0]["store"] = json!({ "type": "u8", "scale": 0, "offset": 0 });
    model["id"] = json!("org.example.AR");
    place.write("model.json", model.to_string());
    let (code, broken) = report(&place, &["model.json"]);
    assert_eq!(code, 1);
    let codes: Vec<&Value> = broken["findings"].as_array().unwrap().iter().collect();
    let found = |code: &str, pointer: &str| {
        codes.iter().any(|f| f["code"] == code && f["pointer"] == pointer)
    };
    assert!(found("DESCRIPTOR_INVALID", "") && found("SCHEMA_BROKEN", "/id"), "{broken}");
    assert!(codes.iter().any(|f| f["pointer"] == "/fields/0/store"), "{broken}");

    let device = |limit: f64| {
        json!({
            "id": "org.example.knob", "name": "Knob", "version": "1.0.0", "summary": "Turns.",
            "direction": "output",
            "settings": [{ "name": "limit_v", "kind": { "type": "number", "min": 0, "max": limit },
                           "description": "Volts." }],
        })
    };
    place.write("device.json", device(10.0).to_string());
    assert_eq!(report(&place, &["device.json"]).0, 0);
    place.write("device.json", device(-10.0).to_string());
    let (code, broken) = report(&place, &["device.json"]);
    assert_eq!((code, &broken["findings"][0]["code"]), (1, &json!("DESCRIPTOR_INVALID")));
    let mut device = device(10.0);
    device["settings"][0]["kind"] = json!({ "type": "numbr" });
    place.write("device.json", device.to_string());
    let (code, broken) = report(&place, &["device.json"]);
    let rule = broken["findings"][1]["schema_rule"].as_str().unwrap_or_default();
    assert!(code == 1 && rule.starts_with("device-descriptor-1.json#/"), "{broken}");
}

#[test]
fn a_scene_is_held_to_its_schema_and_to_its_devices() {
    let place = Place::new();
    let file = concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/../spec/scene-conformance/surface_gain_invalid.scene.json"
    );
    let (_, gain) = report(&place, &[file]);
    let rule = "scene-1.json#/$defs/Surface/properties/gain/minimum";
    assert_eq!(gain["findings"][0]["schema_rule"], rule, "{gain}");
    let file = file.replace("surface_gain_invalid", "device_setting");
    let (_, setting) = report(&place, &[&file]);
    let rule = setting["findings"][0]["schema_rule"].as_str().unwrap_or_default();
    assert!(rule.starts_with("settings of org.htex.file#/"), "{setting}");
}

#[test]
fn a_licence_is_checked_before_a_fit_begins() {
    let place = Place::new();
    let csv = place.recording("vinyl");
    let fit = |license: &str| {
        place.run(&["fit", &csv, "--model", "sbeta", "--license", license, "-o", "a.htex"])
    };
    let refused = fit("CC BY 4.0");
    assert_eq!(refused.code(), 2, "{}", refused.error());
    assert!(refused.error().contains("--license: \"CC BY 4.0\" is not an SPDX expression"));
    let doubtful = fit("CC-BY-9.0");
    assert_eq!(doubtful.code(), 0);
    assert!(doubtful.error().contains("LicenseRef-NAME"), "{}", doubtful.error());
    assert!(!fit("LicenseRef-Ours").error().contains("--license"));
}

#[test]
fn info_says_of_fields_that_are_not_the_models() {
    let place = Place::new();
    let shown = |file: &str| {
        let run = place.run(&["info", &format!("{CONFORMANCE}/{file}")]);
        run.text()
    };
    let reordered = shown("valid_field_order.htex");
    assert!(reordered.contains("alpha=2.5 beta=1.5"), "{reordered}");
    let newer = shown("valid_field_of_newer_model.htex");
    assert!(newer.contains("the model has no field \"gamma\""), "{newer}");
}

/// Reports for continuous integration have the files and codes of the text.
#[test]
fn findings_are_annotations_and_test_cases() {
    let place = Place::new();
    place.write("a.htex", "no asset");
    let by = |format: &str| place.run(&["validate", "a.htex", "--format", format]);
    let github = by("github");
    assert_eq!(github.code(), 1);
    assert!(github.text().starts_with("::error file=a.htex,title=ARCHIVE_INVALID::"));
    let junit = by("junit").text();
    assert!(junit.contains("<testcase name=\"a.htex\"") && junit.contains("failures=\"1\""));
    assert_eq!(by("json").code(), 2);
}

/// `--quiet` leaves results and errors; `--verbose` says how long a command took.
#[test]
fn commands_are_quiet_or_verbose() {
    let place = Place::new();
    let make = ["make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02"];
    let at = ["--at", "speed=80,force=0.5", "-o", "a.htex"];
    assert_eq!(place.run(&[&make[..], &at].concat()).code(), 0);
    // A motion that was not recorded is a warning.
    let synth = |more: &[&str]| {
        place.run(&[&["synth", "a.htex", "-o", "a.wav", "--speed", "500"], more].concat())
    };
    assert!(!synth(&[]).error().is_empty());
    assert_eq!(synth(&["-q"]).error(), "");
    assert!(synth(&["--verbose"]).error().contains("note: it took 0."));
    let failed = place.run(&["-q", "info", "absent.htex"]);
    assert!(failed.code() == 1 && failed.error().contains("absent.htex"));
    assert_eq!(place.run(&["-q", "-v", "info", "a.htex"]).code(), 2);
}
