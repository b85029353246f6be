//! An asset that embeds its model plays where that model was never installed.

use crate::common::{Place, rms, stated};
use serde_json::json;

/// Builds the third-party example in C to `bursts.wasm`; false without a compiler for it.
fn build_bursts(place: &Place) -> bool {
    let built = xtask::c_module::build(
        "examples/model-c-bursts/bursts.c",
        place.path("bursts.wasm").as_ref(),
    );
    xtask::needs::WASM_CLANG.met(built.is_ok())
}

/// Fits a recording by the example and by sBeta to `b.htex`, which embeds the example.
fn fit_with_bursts(place: &Place, more: &[&str]) -> serde_json::Value {
    let csv = place.recording("sandpaper");
    let models = ["fit", &csv, "--model", "bursts,sbeta"];
    let output = ["--embed-plugin", "bursts.wasm", "-o", "b.htex", "--json"];
    place.json(&[&models[..], &output, more].concat())
}

#[test]
fn a_third_party_model_travels_with_its_asset() {
    let place = Place::new();
    if !build_bursts(&place) {
        return;
    }
    std::fs::write(place.path("key"), [9u8; 32]).unwrap();
    let fitted = fit_with_bursts(&place, &["--sign-with", "key"]);
    assert_eq!(fitted["representations"][0]["model"], "org.example.bursts");
    std::fs::remove_file(place.path("bursts.wasm")).unwrap();

    let info = place.json(&["info", "b.htex", "--json"]);
    let plugin = &info["manifest"]["plugins"][0];
    assert_eq!(plugin["model"], "org.example.bursts");
    assert_eq!(plugin["signature"]["public_key"].as_str().unwrap().len(), 64);
    assert!(info["plugin_bytes"][0].as_u64().unwrap() > 1000);
    let validated = place.json(&["validate", "b.htex", "--json"]);
    assert_eq!(validated[0]["valid"], true);

    let synth = ["synth", "b.htex", "--model", "bursts", "--seconds", "2", "-o", "b.wav"];
    let run = place.run(&synth);
    assert_eq!(run.code(), 0, "{}", run.error());
    let level = stated(&fitted, 0)["level_rms"].as_f64().unwrap();
    let ratio = rms(&place.samples("b.wav")) / level;
    assert!((0.8..1.2).contains(&ratio), "two seconds of bursts: {ratio}");

    let forbidden = place.run(&[&synth[..], &["--no-embedded-plugins"]].concat());
    assert_eq!(forbidden.code(), 2);
    for words in ["org.example.bursts", "embeds it", "--no-embedded-plugins"] {
        assert!(forbidden.error().contains(words), "{}", forbidden.error());
    }

    // A scene plays it too, so it is valid where embedded models may run.
    let surfaces = json!([{ "asset": "b.htex", "representation": "bursts" }]);
    place.scene("scene.json", "", &json!({ "surfaces": surfaces, "duration_s": 1 }));
    let validate = ["validate", "scene.json"];
    let unplayed = place.run(&validate);
    assert_eq!(unplayed.code(), 1);
    assert!(unplayed.text().contains("(see --embedded-plugins)"), "{}", unplayed.text());
    let allowed = place.run(&[&validate[..], &["--embedded-plugins"]].concat());
    assert_eq!(allowed.code(), 0, "{}", allowed.text());
    let rendered = place.run(&["render", "scene.json", "-o", "scene.wav"]);
    assert_eq!(rendered.code(), 0, "{}", rendered.error());
}

/// A module that is declared, or even signed, as another model does not replace it.
#[test]
fn a_module_is_the_model_it_is_said_to_be() {
    let place = Place::new();
    if !build_bursts(&place) {
        return;
    }
    fit_with_bursts(&place, &[]);
    let honest = htex_format::Asset::open(&place.path("b.htex")).unwrap();
    let true_version = honest.manifest.plugins[0].version.clone();
    let played = htex::Texture::new(honest.clone()).with_embedded();
    assert!(played.load_embedded("org.example.bursts").is_ok());
    let absent = played.load_embedded("org.htex.sbeta").unwrap_err();
    assert!(absent.to_string().contains("embeds no model"));
    for (model, version) in [
        ("org.htex.sbeta", "9.9.9"),
        ("org.htex.sbeta", &true_version),
        ("org.example.bursts", "9.9.9"),
    ] {
        let mut asset = honest.clone();
        let plugin = &mut asset.manifest.plugins[0];
        (plugin.model, plugin.version) = (model.to_owned(), version.to_owned());
        plugin.file = format!("plugins/{model}.wasm");
        plugin.signature = None;
        place.write("liar.htex", asset.to_bytes().unwrap());
        let words = format!(
            "is declared as {model} {version} but contains org.example.bursts {true_version}"
        );
        let synth = ["synth", "liar.htex", "--seconds", "1", "-o", "b.wav"];
        let run = place.run(&[&synth[..], &["--model", model]].concat());
        assert_eq!(run.code(), 1, "{}", run.error());
        assert!(run.error().contains(&words), "{}", run.error());
        // Nothing runs unless asked for; then the fault is found.
        let valid = place.run(&["validate", "liar.htex"]);
        assert_eq!(valid.code(), 0, "{}", valid.text());
        let loaded = place.run(&["validate", "--embedded-plugins", "liar.htex"]);
        assert_eq!(loaded.code(), 1, "{}", loaded.text());
        for part in ["PLUGIN_UNUSABLE at /plugins/0", &words] {
            assert!(loaded.text().contains(part), "{}", loaded.text());
        }
        // Models that are not embedded are played without it.
        let without = ["--model", "sbeta", "--no-embedded-plugins"];
        let run = place.run(&[&synth[..], &without].concat());
        assert_eq!(run.code(), 0, "{}", run.error());
    }
}

#[test]
fn a_changed_module_is_refused() {
    let place = Place::new();
    let conformance = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/conformance");
    let file = format!("{conformance}/plugin_hash_mismatch.htex");
    let run = place.run(&["spectrum", &file, "--model", "sbeta"]);
    assert_eq!(run.code(), 1);
    assert!(run.error().contains("hash"), "{}", run.error());
}
