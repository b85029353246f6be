//! Every number has a single range: schema and reader refuse the same values. In a document that
//! has all keys, every number is replaced by numbers around and beyond the ranges, texts by other
//! texts, and every key is left out.
//!
//! With `HTEX_PROBES_OUT` the documents are written to the file with that name, for another reader.
//! Each line is JSON with `kind`, `what`, `document`, `valid` (the reader's verdict) and `schema`
//! (the schema's verdict). Manifests are read in an archive with an entry `a.bin` of nine zero
//! bytes.

#[path = "../../../sdk/core/format/tests/it/common/raw_zip.rs"]
#[allow(dead_code)]
mod raw_zip;

use std::env;
use std::fs::{self, File};
use std::io::Write;
use std::sync::{Mutex, OnceLock};

use htex_base::finding::{Finding, Findings};
use htex_base::schema::Schema;
use htex_format::{Limits, manifest_json, validate};
use htex_tests::workspace;
use serde_json::{Map, Value, json};

/// Numbers on both sides of the ranges' ends, including fractions.
const PROBES: [f64; 38] = [
    -1e300, -1e13, -1e10, -3e9, -2e6, -1e6, -4e3, -1e3, -121.0, -100.0, -81.0, -20.0, -5.0, -4.0,
    -1.5, -1.0, -1e-10, 0.0, 1e-300, 1e-13, 1e-10, 0.004, 0.04, 0.5, 1.0, 1.5, 5.0, 15.0, 30.0,
    55.0, 300.0, 1e3, 5e3, 2e4, 2e6, 2e9, 2e12, 1e300,
];

/// Texts that are not names, or have another form.
const TEXTS: [&str; 8] = ["", " ", "a", "a/b", "\u{7}é", "0123", "\u{85}\u{2003}", "\u{feff}"];

fn schema(stem: &str) -> Value {
    let path = workspace().join(format!("spec/schemas/{stem}.json"));
    serde_json::from_slice(&fs::read(path).unwrap()).unwrap()
}

/// JSON pointers to a document's values for which `is` holds.
fn pointers(value: &Value, at: &str, is: &dyn Fn(&Value) -> bool, out: &mut Vec<String>) {
    if is(value) {
        out.push(at.to_owned());
    }
    let escape = |key: &str| key.replace('~', "~0").replace('/', "~1");
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                pointers(value, &format!("{at}/{}", escape(key)), is, out);
            }
        }
        Value::Array(items) => {
            for (i, value) in items.iter().enumerate() {
                pointers(value, &format!("{at}/{i}"), is, out);
            }
        }
        _ => {}
    }
}

/// Returns documents with one change each: another number or text, or a missing key.
fn changes_of(document: &Value) -> Vec<(String, Value)> {
    let mut numbers = Vec::new();
    pointers(document, "", &Value::is_number, &mut numbers);
    let mut changes: Vec<(String, Value)> = Vec::new();
    let mut change = |pointer: &str, what: &dyn std::fmt::Display, to: &dyn Fn(&mut Value)| {
        let mut changed = document.clone();
        to(&mut changed);
        changes.push((format!("{pointer} {what}"), changed));
    };
    for pointer in &numbers {
        for probe in PROBES {
            // Integers are written as such if they fit into 64 bits.
            let whole = probe.fract() == 0.0 && probe.abs() < 1e18;
            let probe = if whole { json!(probe as i64) } else { json!(probe) };
            change(pointer, &probe, &|all| *all.pointer_mut(pointer).unwrap() = probe.clone());
        }
    }
    let mut texts = Vec::new();
    pointers(document, "", &Value::is_string, &mut texts);
    for pointer in &texts {
        for probe in TEXTS {
            let put = |all: &mut Value| *all.pointer_mut(pointer).unwrap() = json!(probe);
            change(pointer, &format!("{probe:?}"), &put);
        }
    }
    let mut objects = Vec::new();
    pointers(document, "", &Value::is_object, &mut objects);
    for pointer in &objects {
        let keys = document.pointer(pointer).unwrap().as_object().unwrap().keys();
        for key in keys {
            let without = |all: &mut Value| {
                drop(all.pointer_mut(pointer).unwrap().as_object_mut().unwrap().remove(key))
            };
            change(&format!("{pointer}/{key}"), &"absent", &without);
        }
    }
    changes
}

/// A changed document, and the verdicts on it.
struct Change {
    what: String,
    document: Value,
    /// Whether the schema allows it.
    by_schema: bool,
    /// The reader's errors.
    errors: Vec<Finding>,
}

/// Writes changed documents, with the verdicts of the reader and the schema, to the file that
/// `HTEX_PROBES_OUT` names, if it is set.
fn write_out(stem: &str, changes: &[Change]) {
    static OUT: OnceLock<Option<Mutex<File>>> = OnceLock::new();
    let open =
        || env::var_os("HTEX_PROBES_OUT").map(|path| Mutex::new(File::create(path).unwrap()));
    let Some(out) = OUT.get_or_init(open) else {
        return;
    };
    let kind = stem.strip_suffix("-1").unwrap_or(stem);
    let line = |change: &Change| {
        let verdicts = json!({
            "kind": kind,
            "what": change.what,
            "document": change.document,
            "valid": change.errors.is_empty(),
            "schema": change.by_schema,
        });
        format!("{verdicts}\n")
    };
    let lines: String = changes.iter().map(line).collect();
    out.lock().unwrap().write_all(lines.as_bytes()).unwrap();
}

/// Compares a schema with the errors of reading, at every number of a document. `depends`: parts of
/// pointers to numbers of which the range depends on other values, so that reading may refuse more
/// than the schema.
fn compare(stem: &str, document: &Value, depends: &[&str], read: &dyn Fn(&Value) -> Vec<Finding>) {
    let schema = Schema::new(&schema(stem)).unwrap();
    assert_eq!(schema.violations(document), [], "{stem}");
    let errors = |document: &Value| -> Vec<Finding> {
        let mut found = read(document);
        found.retain(|finding| finding.severity == htex_base::finding::Severity::Error);
        found
    };
    assert_eq!(errors(document), [], "{stem}");
    let judged = |(what, document): (String, Value)| Change {
        by_schema: schema.violations(&document).is_empty(),
        errors: errors(&document),
        what,
        document,
    };
    let changes: Vec<Change> = changes_of(document).into_iter().map(judged).collect();
    assert!(changes.len() >= 80, "{stem}");
    write_out(stem, &changes);
    let mut differ = Vec::new();
    for change in changes {
        let may_depend = depends.iter().any(|part| change.what.contains(part));
        let by_reading = change.errors.is_empty();
        if change.by_schema != by_reading && (by_reading || !may_depend) {
            differ.push(format!(
                "{}: the schema allows it: {}; reading: {:?}",
                change.what, change.by_schema, change.errors
            ));
        }
    }
    assert!(differ.is_empty(), "{stem}: {} differ\n{}", differ.len(), differ.join("\n"));
}

/// A value in TOML.
fn toml(value: &Value) -> String {
    let joined = |all: Vec<String>| all.join(", ");
    match value {
        Value::Object(map) => {
            let pair = |(key, value): (&String, &Value)| format!("{key} = {}", toml(value));
            format!("{{ {} }}", joined(map.iter().map(pair).collect()))
        }
        Value::Array(items) => format!("[{}]", joined(items.iter().map(toml).collect())),
        other => other.to_string(),
    }
}

/// A manifest with every key that has a number.
fn manifest() -> Value {
    let bytes = fs::read(workspace().join("spec/conformance/valid_law.htex")).unwrap();
    let mut manifest = manifest_json(&bytes, &Limits::default()).unwrap();
    manifest["provenance"] = json!({
        "recordings": [{ "file": "a.csv", "rate_hz": 20000, "segments": 8 }],
        "made": { "how": "mixed", "from": [{ "name": "a", "weight": 0.5, "blake3": "0".repeat(64) }] },
    });
    manifest["conditions"] = json!([
        { "speed_mm_s": 80, "force_n": 0.5, "repeatability_rms_db": 0.5, "segments": 8 },
        { "speed_mm_s": 160, "force_n": 0.5 },
        { "speed_mm_s": 80, "force_n": 1.5 },
    ]);
    let error = |estimate: f64| json!({ "exponent": 0.5, "source": "measured", "estimate": estimate, "standard_error": 0.1 });
    manifest["law"] = json!({ "frequency_speed": error(0.5), "level_speed": error(0.6), "level_force": error(0.7) });
    manifest["fluctuation"] =
        json!({ "slow": 96, "fast": 48, "held_out_error_db": 4.5, "halves_error_db": 3.5 });
    let keys = |name: &str| -> Map<String, Value> {
        let schema = schema("manifest-1");
        let all = schema["$defs"][name]["properties"].as_object().unwrap();
        let value = |key: &str| {
            if key == "band_error_db" { json!(vec![0; 9]) } else { json!(0.5) }
        };
        all.keys().map(|key| (key.clone(), value(key))).collect()
    };
    let fields = json!([
        { "name": "a", "store": { "u16": { "scale": 0.5, "offset": 1.0 } } },
        { "name": "b", "store": { "u8": { "scale": 0.5, "offset": 1.0 } } },
    ]);
    manifest["representations"] = json!([{
        "model": "org.example.model", "model_version": "1.0.0", "fields": fields, "parameters": "a.bin",
        "at": [
            { "condition": 0, "level_rms": 0.1, "quality": keys("Quality"), "left_out": keys("LeftOut") },
            { "condition": 1, "level_rms": 0.1 },
            { "condition": 2, "level_rms": 0.1 },
        ],
        "triangles": [[0, 1, 2]],
    }]);
    for key in ["reference", "plugins", "extensions", "extensions_required"] {
        manifest.as_object_mut().unwrap().remove(key);
    }
    manifest
}

#[test]
fn manifests_have_the_ranges_of_their_schema() {
    let read = |manifest: &Value| {
        let entries = [
            raw_zip::Entry::stored("mimetype", b"application/vnd.htex+zip"),
            raw_zip::Entry::stored("manifest.json", manifest.to_string().as_bytes()),
            raw_zip::Entry::stored("a.bin", &[0; 9]),
        ];
        validate(&raw_zip::archive(&entries), &Limits::default()).findings
    };
    compare(
        "manifest-1",
        &manifest(),
        &[
            "/band/",
            "/condition",
            "/store",
            "/license",
            "/parameters",
            "/fields/1/name",
            "/triangles/",
        ],
        &read,
    );
}

#[test]
fn names_of_entries_are_those_that_an_archive_may_have() {
    let schema = Schema::new(&schema("manifest-1")).unwrap();
    let names = [
        "a", ".a", "..a", "...", "a.", "a..", "a/b", "a/.b", "-", "a b", "[]", "", ".", "..", "/a",
        "a/", "a//b", "./a", "../a", "a/.", "a/..", "a/./b", "a/../b", "a\\b", "a:b", "é",
        "\u{7f}",
    ];
    let mut safe = 0;
    for name in names {
        let mut manifest = manifest();
        manifest["representations"][0]["parameters"] = json!(name);
        manifest["reference"] = json!({ "file": name });
        let entries = [raw_zip::Entry::stored(name, b"")];
        let found = validate(&raw_zip::archive(&entries), &Limits::default()).findings;
        let is_safe = found.iter().all(|f| f.code != "ENTRY_NAME_UNSAFE");
        let violations = schema.violations(&manifest);
        let at = |pointer: &str| violations.iter().all(|v| v.pointer != pointer);
        assert_eq!(at("/representations/0/parameters"), is_safe, "{name:?}");
        assert_eq!(at("/reference/file"), is_safe, "{name:?}");
        safe += usize::from(is_safe);
    }
    assert_eq!(safe, 11);
}

#[test]
fn scenes_have_the_ranges_of_their_schema() {
    let scene = json!({
        "htex_scene": "1.0",
        "surfaces": [{
            "asset": "a.htex", "region": { "x_mm": [-10, 10], "y_mm": [-10, 10] }, "layer": 1, "gain": 1,
        }],
        "motion": { "constant": { "speed_mm_s": 80, "force_n": 0.4, "from_mm": [0, 0], "direction_deg": 0 } },
        "device": {
            "rate_hz": 48000, "gain_db": 0, "quantity_gain": 1, "drive_v": 1, "level_dbfs": -18, "levels": "own", "reference_rms": 1,
            "pitch": 1, "response_depth_db": 40,
        },
        "duration_s": 1,
        "seed": 1,
        "budget": { "ns_per_sample": 100, "max_error_db": 1 },
    });
    let read = |scene: &Value| {
        let mut findings = Findings::default();
        htex_scene::read_scene(
            scene.to_string().as_bytes(),
            &htex_scene::Limits::default(),
            &mut findings,
        );
        findings.into_list()
    };
    compare("scene-1", &scene, &["/region/", "/from_mm absent"], &read);
}

#[test]
fn studies_have_the_ranges_of_their_schema() {
    let study = json!({
        "htex_study": "1.0", "name": "Study", "participants": 2,
        "textures": [{ "asset": "a.htex" }],
        "models": ["ar"], "repetitions": 2, "trial_s": 1, "phases": ["training", "gain", "testing"],
        "motion": "live",
        "seed": 1,
        "start_db": -20,
        "training": { "trials": 2 },
        "gain": { "model": "ar", "step_db": 1, "large_step_db": 4, "lowest_db": -60, "reversals": 6 },
        "scale": { "min": 0, "max": 6 },
        "rests": { "every": 10, "seconds": 60 },
        "masking_noise": { "level_dbfs": -30 },
        "device": {},
    });
    let read = |study: &Value| {
        let mut findings = Findings::default();
        let keys = study.as_object().unwrap().iter();
        let text: String = keys.map(|(key, value)| format!("{key} = {}\n", toml(value))).collect();
        htex_lab::study::read_study(text.as_bytes(), &mut findings);
        findings.into_list()
    };
    // Motion and device are checked in the same way as a scene's.
    compare("study-1", &study, &["/scale/", "/repetitions", "/participants", "/asset"], &read);
}

#[test]
fn takes_have_the_ranges_of_their_schema() {
    let take = json!({
        "htex_take": 1, "name": "vinyl", "number": 7, "tool": "htex", "source": "daq:Dev1/ai0:5", "map": "0=x",
        "calibrations": [[1.0, 0.0], [0.0, 1.0]], "quantity": "lateral_force", "rate_hz": 10000, "seconds": 10,
        "signals": [["lateral", "N"], ["normal", "N"]], "tare": [0.1, 0.2], "tracker": [["x", "mm"]],
        "target_speed_mm_s": 80, "target_force_n": 0.4, "tolerance": 0.1,
        "required": { "on_target": 0.5, "sweeps": 3 }, "format": "csv",
    });
    let read = |take: &Value| refused(htex_lab::record::TakeHeader::of_json(take.clone()));
    compare("take-1", &take, &[], &read);
}

#[test]
fn gains_have_the_ranges_of_their_schema() {
    let gain = |device: &str| {
        json!({
            "person": "Ann", "texture": "vinyl by lab", "device": device, "profile": "lab", "file": "vinyl.htex",
            "drive_v": 40.5, "reference_rms": 0.02, "recordings": ["a.csv"], "blake3": "0".repeat(64),
        })
    };
    let gains = json!({ "gains": [gain("org.htex.daq"), gain("org.htex.audio")] });
    let read = |gains: &Value| refused(htex_scene::Gains::from_json(gains.clone()));
    compare("gains-1", &gains, &[], &read);
}

#[test]
fn answers_have_the_ranges_of_their_schema() {
    let device = json!({
        "adapter": "org.htex.daq", "profile": "lab", "settings": { "limit_v": "150" }, "limit": 150, "quantity_gain": 2,
    });
    let output = json!({ "unit": "V", "peak": 40, "rms": 12, "direct": 0.1, "duration_s": 10 });
    let signals = json!([["lateral", "N"], ["normal", "N"]]);
    let source = json!({
        "name": "daq:Dev1/ai0:5", "settings": { "rate_hz": "10000" }, "map": "0=x", "calibrations": [[1.0]],
        "quantity": "lateral_force", "rate_hz": 10000, "signals": signals, "tracker": [["x", "mm"]], "format": "csv",
    });
    let lines = [
        json!({
            "kind": "header", "htex_answers": "1.0", "study": "s", "participant": "P01", "files": { "study.toml": "0" },
            "device": device, "begun": "2026-11-25T10:25:25Z", "ratings": 25, "source": source, "tool": "htex",
            "simulated": { "seed": 1, "rule": "r" },
        }),
        json!({
            "kind": "session", "date": "2026-11-25T10:25:25Z", "at_ms": 1, "device": device, "tool": "htex", "simulated": true,
        }),
        json!({
            "kind": "answer", "number": 1, "texture": "t", "model": "m", "repetition": 1, "hidden_reference": true, "attribute": "a",
            "rating": 3, "response_ms": 500, "at_ms": 1, "gain_db": -3, "drive_v": 40, "output": output, "stops": 1, "repeats": 1,
            "felt": { "file": "f", "blake3": "0", "off_target": ["slow"] }, "simulated": true,
        }),
        json!({
            "kind": "gain", "texture": "t", "key": "accept", "gain_db": -3, "found": true, "drive_v": 40, "output": output, "stops": 0,
            "reference_rms": 0.02, "at_ms": 1, "simulated": true,
        }),
        json!({
            "kind": "rise", "phase": "training", "texture": "t", "model": "m", "key": "accept", "gain_db": -3, "found": true,
            "drive_v": 40, "output": output, "stops": 0, "reference_rms": 0.02, "at_ms": 1, "simulated": true,
        }),
        json!({
            "kind": "stopped", "phase": "gain", "texture": "t", "model": "m", "reason": "ran_dry", "gain_db": -3, "drive_v": 40,
            "output": output, "at_ms": 1, "simulated": true,
        }),
        json!({ "kind": "rest", "after": 10, "at_ms": 1, "simulated": true }),
    ];
    let read = |line: &Value| refused(htex_lab::study::Line::parse(line.to_string().as_bytes()));
    for line in lines {
        compare("answers-1", &line, &[], &read);
    }
}

/// The error from reading a document, as a finding.
fn refused<T>(read: Result<T, impl ToString>) -> Vec<Finding> {
    let error = read.err().map(|error| error.to_string());
    let finding = |error: String| Finding::new(&htex_format::RULES[0], "", &error);
    error.into_iter().map(finding).collect()
}

/// Samples as an NPY file, version 1.0 of the format.
fn npy(samples: &[f32]) -> Vec<u8> {
    let shape = samples.len();
    let header = format!("{{'descr': '<f4', 'fortran_order': False, 'shape': ({shape},), }}");
    let mut bytes = b"\x93NUMPY\x01\x00\x76\x00".to_vec();
    bytes.extend(format!("{header:<117}\n").bytes());
    bytes.extend(samples.iter().flat_map(|x| x.to_le_bytes()));
    bytes
}

#[test]
fn recipes_have_the_ranges_of_their_schema() {
    let settings = json!({
        "recordings": "a.npy", "rate_hz": 1000, "scale": 1, "at": { "speed_mm_s": 80, "force_n": 0.4 },
    });
    let recipe = json!({ "library": { "name": "x" }, "textures": [settings] });
    let recording = npy(&[0.0; 2000]);
    let tried = |recipe: &Value| -> Result<(), Box<dyn std::error::Error>> {
        let keys = recipe.as_object().unwrap().iter();
        let text: String = keys.map(|(key, value)| format!("{key} = {}\n", toml(value))).collect();
        let recipe = htex_build::Recipe::parse(&text)?;
        for textures in recipe.textures {
            let options = &textures.settings.reading.read_options(1)?[0];
            htex_author::recording::recording_from_bytes("a.npy".as_ref(), &recording, options)?;
            let number = |value| match value {
                Some(htex_build::NumberOrTemplate::Number(number)) => Some(number),
                _ => None,
            };
            let at = textures.settings.at;
            let (speed_mm_s, force_n) = (number(at.speed_mm_s), number(at.force_n));
            htex_author::Exploration { speed_mm_s, force_n }.check()?;
        }
        Ok(())
    };
    let read = |recipe: &Value| refused(tried(recipe));
    compare("recipe-1", &recipe, &["/recordings absent", "/rate_hz absent"], &read);
}

/// The places in a schema that have a default, validated by the rest of the same place.
#[test]
fn every_default_is_a_value_of_its_own_schema() {
    let mut checked = 0;
    for entry in fs::read_dir(workspace().join("spec/schemas")).unwrap() {
        let path = entry.unwrap().path();
        let stem = path.file_stem().unwrap().to_string_lossy().into_owned();
        let root = schema(&stem);
        let mut with_default = Vec::new();
        let is = |value: &Value| {
            value.get("default").is_some()
                && (value.get("type").is_some()
                    || value.get("$ref").is_some()
                    || value.get("anyOf").is_some())
        };
        pointers(&root, "", &is, &mut with_default);
        for pointer in with_default {
            let mut own = root.pointer(&pointer).unwrap().clone();
            let default = own["default"].clone();
            own["$defs"] = root["$defs"].clone();
            if root.get("$defs").is_none() {
                own.as_object_mut().unwrap().remove("$defs");
            }
            let violations = Schema::new(&own).unwrap().violations(&default);
            assert_eq!(violations, [], "{stem} {pointer}: {default}");
            checked += 1;
        }
    }
    assert!(checked >= 49, "{checked}");
}
