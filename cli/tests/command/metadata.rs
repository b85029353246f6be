//! Metadata in `fit` and `edit`: it is stored, shown and checked, and nothing else of an asset
//! changes.

use std::collections::BTreeMap;
use std::io::{Cursor, Read, Write};
use std::path::Path;

use crate::common::{Place, words};
use serde_json::Value;
use zip::write::SimpleFileOptions;

const METADATA: [[&str; 2]; 8] = [
    ["--name", "Coarse cloth"],
    ["--author", "A. Uthor"],
    ["--license", "CC-BY-4.0"],
    ["--description", "plain weave, 12 threads per cm"],
    ["--tag", "cloth,coarse"],
    ["--source", "Example University"],
    ["--doi", "10.5281/zenodo.1234567"],
    ["--sensor", "six-axis force sensor"],
];

/// The entries of an asset, unpacked by the package `zip`, and the bytes that this package writes
/// of them.
fn entries(file: &Path) -> (BTreeMap<String, Vec<u8>>, Vec<u8>) {
    let mut archive = zip::ZipArchive::new(std::fs::File::open(file).unwrap()).unwrap();
    let mut again = zip::ZipWriter::new(Cursor::new(Vec::new()));
    let mut entries = BTreeMap::new();
    for i in 0..archive.len() {
        let mut entry = archive.by_index(i).unwrap();
        let mut bytes = Vec::new();
        entry.read_to_end(&mut bytes).unwrap();
        let name = entry.name().unwrap().into_owned();
        let deflated = entry.compression() == zip::CompressionMethod::Deflated;
        let options = SimpleFileOptions::default()
            .last_modified_time(zip::DateTime::default())
            .system(zip::System::Unix)
            .unix_permissions(0o644)
            .compression_method(entry.compression())
            .compression_level(deflated.then_some(9));
        again.start_file(name.clone(), options).unwrap();
        again.write_all(&bytes).unwrap();
        entries.insert(name, bytes);
    }
    (entries, again.finish().unwrap().into_inner())
}

fn manifest(entries: &BTreeMap<String, Vec<u8>>) -> Value {
    serde_json::from_slice(&entries["manifest.json"]).unwrap()
}

/// Assets with a signed model, recorded spectra, packed parameters and extensions keep all of it.
#[test]
fn an_edit_changes_the_metadata_alone() {
    let spec = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/conformance");
    for name in [
        "valid_plugin",
        "valid_reference",
        "valid_packed",
        "valid_extension",
        "valid_five_models",
        "valid_newer_minor",
    ] {
        let place = Place::new();
        let file = format!("{name}.htex");
        let original = std::fs::read(format!("{spec}/{file}")).unwrap();
        place.write(&file, &original);
        let edit = [&["edit", &file, "-o", "e.htex"], METADATA.as_flattened()].concat();
        let run = place.run(&edit);
        assert_eq!(run.code(), 0, "{name}: {}", run.error());
        assert_eq!(std::fs::read(place.path(&file)).unwrap(), original);

        let (mut before, _) = entries(&place.path(&file));
        let (mut after, by_zip) = entries(&place.path("e.htex"));
        assert!(by_zip == std::fs::read(place.path("e.htex")).unwrap(), "{name}");
        let (mut was, mut is) = (manifest(&before), manifest(&after));
        assert_eq!(is["doi"], "10.5281/zenodo.1234567");
        assert_eq!(is["tags"], serde_json::json!(["cloth", "coarse"]));
        for key in METADATA.map(|[flag, _]| &flag[2..]) {
            let key = if key == "tag" { "tags" } else { key };
            for manifest in [&mut was, &mut is] {
                manifest.as_object_mut().unwrap().remove(key);
            }
        }
        assert_eq!(was, is, "{name}");
        before.remove("manifest.json");
        after.remove("manifest.json");
        assert_eq!(before, after, "{name}");
        let valid = place.json(&["validate", "e.htex", "--json"]);
        assert_eq!(valid[0]["valid"], true, "{valid}");
    }
}

/// An appearance is set, checked, kept by what changes or moves the asset, and removed.
#[test]
fn an_extension_is_set_kept_and_removed() {
    let place = Place::new();
    let schema = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/schemas/appearance-1.json");
    let look = serde_json::json!({
        "hue_deg": 28, "saturation": 0.5, "lightness": 0.4, "gloss": 0.2, "relief": 0.5, "pattern": "fibres"
    });
    place.write("look.json", look.to_string());
    let make = ["make", "--model", "sbeta", "--set", "alpha=2", "beta=5", "--level", "0.02"];
    place.json(&[&make[..], &["--license", "CC0-1.0", "-o", "oak.htex", "--json"]].concat());
    let appearance = "org.htex.appearance/1";
    let set = format!("{appearance}=look.json");
    let edited = place.json(&["edit", "oak.htex", "--extension", &set, "--json"]);
    assert_eq!(edited["manifest"]["extensions"][appearance], look);
    let of = |file: &str| {
        place.json(&["info", file, "--json"])["manifest"]["extensions"][appearance].clone()
    };
    place.json(&["edit", "oak.htex", "--author", "A", "-o", "named.htex", "--json"]);
    assert_eq!(of("named.htex"), look);
    for command in [
        "lib pack oak.htexlib oak.htex",
        "lib unpack oak.htexlib --output unpacked",
        "export oak.htex --to gltf -o oak.glb",
        "import oak.glb -o imported.htex",
    ] {
        let run = place.run(&words(command));
        assert_eq!(run.code(), 0, "{command}: {}", run.error());
    }
    assert_eq!(of("unpacked/oak.htex"), look);
    assert_eq!(of("imported.htex"), look);
    // A mixture is another surface, so it keeps neither tags nor extensions.
    let mix = ["mix", "oak.htex", "named.htex", "--weight", "0.5", "-o", "mixed.htex", "--json"];
    assert!(place.json(&mix)["manifest"]["extensions"].is_null());

    let schema = format!("{appearance}={schema}");
    let valid = place.json(&["validate", "oak.htex", "--extension-schema", &schema, "--json"]);
    assert_eq!(valid[0]["valid"], true, "{valid}");
    place.write("wrong.json", r#"{"hue_deg": 400}"#);
    let wrong = format!("{appearance}=wrong.json");
    place.json(&["edit", "oak.htex", "--extension", &wrong, "-o", "wrong.htex", "--json"]);
    assert_eq!(place.run(&["validate", "wrong.htex"]).code(), 0);
    assert_eq!(place.run(&["validate", "wrong.htex", "--extension-schema", &schema]).code(), 1);

    let none = format!("{appearance}=");
    let removed = place.json(&["edit", "oak.htex", "--extension", &none, "--json"]);
    assert!(removed["manifest"]["extensions"].is_null());
    for (argument, said) in [
        ("LOOK=look.json", "com.vendor.NAME/REVISION"),
        ("com.example.LOOK/1", "com.vendor.NAME/1=FILE"),
        ("com.example.LOOK/1=oak.htex", "oak.htex"),
        ("com.example.LOOK/1=absent.json", "absent.json"),
    ] {
        let run = place.run(&["edit", "oak.htex", "--extension", argument]);
        assert_ne!(run.code(), 0, "{argument}");
        assert!(run.error().contains(said), "{argument}: {}", run.error());
    }
}

/// Content that this version would not write again is not lost silently.
#[test]
fn an_edit_that_would_lose_something_is_refused() {
    let spec = concat!(env!("CARGO_MANIFEST_DIR"), "/../spec/conformance");
    let place = Place::new();
    for (name, words) in [
        ("entry_unreferenced", "does not refer to the entry"),
        ("json_unknown_key_inside", "the key /"),
        ("valid_newer_store", "the key /representations/0/fields/"),
    ] {
        let original = std::fs::read(format!("{spec}/{name}.htex")).unwrap();
        place.write("u.htex", &original);
        let run = place.run(&["edit", "u.htex", "--author", "A"]);
        assert_eq!(run.code(), 1, "{name}");
        assert!(run.error().contains(words), "{name}: {}", run.error());
        assert_eq!(std::fs::read(place.path("u.htex")).unwrap(), original);
    }
}

#[test]
fn metadata_is_fitted_shown_removed_and_checked() {
    let place = Place::new();
    let csv = place.recording("vinyl");
    let fit = ["fit", &csv, "--model", "sbeta", "-o", "v.htex", "--json"];
    let finger = ["--finger", "bare index finger"];
    place.json(&[&fit[..], METADATA.as_flattened(), &finger].concat());
    let info = &place.json(&["info", "v.htex", "--json"])["manifest"];
    assert_eq!(info["finger"], "bare index finger");
    assert_eq!((&info["name"], &info["htex"]), (&"Coarse cloth".into(), &"1.0".into()));
    let text = place.run(&["info", "v.htex"]).text();
    for line in METADATA.into_iter().chain([finger]).map(|[_, text]| text) {
        assert!(text.contains(&line.replace(',', ", ")) || text.contains(line), "{line}: {text}");
    }
    // In place; an empty text removes an entry.
    let run = place.run(&["edit", "v.htex", "--doi", "", "--author", "B. Uthor"]);
    assert_eq!(run.code(), 0, "{}", run.error());
    let info = &place.json(&["info", "v.htex", "--json"])["manifest"];
    assert_eq!((&info["doi"], &info["author"]), (&Value::Null, &"B. Uthor".into()));
    let kept = std::fs::read(place.path("v.htex")).unwrap();
    for (wrong, words) in [
        (&["--doi", "https://doi.org/10.1/x"][..], "without https://doi.org/"),
        (&["--license", "CC BY"], "--license"),
        (&["--name", " "], "--name"),
        (&[], "nothing to change"),
        (&["-o", "v.htex", "--author", "C"], "name another file"),
    ] {
        let run = place.run(&[&["edit", "v.htex"], wrong].concat());
        assert_eq!(run.code(), 2, "{wrong:?}");
        assert!(run.error().contains(words), "{wrong:?}: {}", run.error());
        assert_eq!(std::fs::read(place.path("v.htex")).unwrap(), kept);
    }
}

/// The page of one's own recordings: a row of spectra for each condition, in the unit of the asset.
#[test]
fn a_fit_draws_its_report() {
    let place = Place::new();
    let csv = place.recording("vinyl");
    place.simulated("slow.csv", &["--surface", "vinyl", "--seconds", "4", "--speed", "40"]);
    let two = ["fit", &csv, "slow.csv", "-o", "v.htex", "--report", "v.html"];
    let run = place.run(&two);
    assert_eq!(run.code(), 0, "{}", run.error());
    let page = std::fs::read_to_string(place.path("v.html")).unwrap();
    assert_eq!(page.matches("class=\"row\"").count(), 2);
    for words in ["v, 40.", "magnitude / mN", "sBeta", "htex fit vinyl.csv slow.csv"] {
        assert!(page.contains(words), "{words}");
    }
    let over = place.run(&["fit", &csv, "-o", "v.htex", "--report", &csv]);
    assert_eq!(over.code(), 2, "{}", over.error());

    let mut rows = String::from("ax_m_s2\n");
    let tone = |n: u32| (f64::from(n) * 0.07).sin() + (f64::from(n) * 0.031).cos();
    (0..20_000).for_each(|n| rows += &format!("{:.5}\n", tone(n)));
    place.write("tool.csv", rows);
    let tool = ["fit", "tool.csv", "--quantity", "acceleration", "--rate", "5000"];
    let run = place.run(&[&tool[..], &["-o", "t.htex", "--report", "t.html"]].concat());
    assert_eq!(run.code(), 0, "{}", run.error());
    let page = std::fs::read_to_string(place.path("t.html")).unwrap();
    assert!(page.contains("magnitude / m/s²") && !page.contains("magnitude / mN"));
}
