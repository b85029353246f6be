//! The descriptions of `spec/kaitai`, compiled by the compiler of Kaitai Struct, read every valid
//! library and parameter block of the conformance files, if Node and the packages are installed.

use std::io::Read;
use std::path::{Path, PathBuf};

use crate::common::node::{packages, ran};
use htex_format::library::{Entry, Interval, Library};
use htex_format::{Asset, Limits, entry_ranges, manifest_json};
use htex_tests::workspace;
use serde_json::{Value, json};

#[test]
fn what_the_descriptions_read_is_what_the_files_hold() {
    let needed = ["kaitai-struct-compiler", "kaitai-struct", "yaml"];
    let there = needed.iter().all(|name| packages().join(name).exists());
    if !xtask::needs::KAITAI.met(there) {
        return;
    }
    let spec = workspace().join("spec");
    let libraries = valid(&spec.join("library-conformance"), "htexlib");
    let (blocks, numbers) = blocks(&spec);
    assert!(libraries.len() >= 10 && blocks.len() >= 90, "{} {}", libraries.len(), blocks.len());
    let questions = json!({
        "folder": spec.join("kaitai"), "libraries": libraries, "blocks": blocks,
    });
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("questions.json");
    std::fs::write(&file, questions.to_string()).unwrap();
    let told = ran("kaitai.cjs", &[file]);
    let mut entries = 0;
    for (path, told) in libraries.iter().zip(told["libraries"].as_array().unwrap()) {
        let (known, mut told) = (library(path), told.clone());
        // A reader ignores a key that it does not know.
        told["metadata"].as_object_mut().unwrap().remove("mood");
        assert_eq!(with_floats(&told), with_floats(&known), "{}", path.display());
        entries += known["entries"].as_array().unwrap().len();
    }
    assert!(entries >= 30, "{entries} entries");
    let told = told["blocks"].as_array().unwrap();
    assert_eq!(told.len(), numbers.len());
    for ((block, known), told) in blocks.iter().zip(&numbers).zip(told) {
        let told: Vec<Vec<f64>> = serde_json::from_value(told.clone()).unwrap();
        assert_eq!(told.len(), known.len(), "{}", block["file"]);
        for (told, known) in told.iter().flatten().zip(known.iter().flatten()) {
            // JavaScript's exponential may differ in its last digit.
            let near = (told - known).abs() <= 1e-14 * known.abs();
            assert!(near, "{}: {told} instead of {known}", block["file"]);
        }
        let counts = |sets: &[Vec<f64>]| sets.iter().map(Vec::len).collect::<Vec<_>>();
        assert_eq!(counts(&told), counts(known), "{}", block["file"]);
    }
}

/// The value with all numbers as binary64, since JavaScript writes 80 where Rust writes 80.0.
fn with_floats(value: &Value) -> Value {
    match value {
        Value::Number(number) => json!(number.as_f64()),
        Value::Array(list) => list.iter().map(with_floats).collect(),
        Value::Object(map) => {
            map.iter().map(|(key, value)| (key.clone(), with_floats(value))).collect()
        }
        other => other.clone(),
    }
}

/// The valid files of a folder.
fn valid(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path());
    let mut files: Vec<PathBuf> = entries
        .filter(|path| path.extension().is_some_and(|e| e == extension))
        .filter(|path| {
            let report = std::fs::read(path.with_extension("report.json"));
            // A folder of assets to play has no reports.
            report.map_or(true, |report| {
                serde_json::from_slice::<Value>(&report).unwrap()["valid"] == true
            })
        })
        .collect();
    files.sort();
    files
}

fn library(path: &Path) -> Value {
    let library = Library::open(path).unwrap();
    let mut spectra = 0;
    for leaf in 0..library.index().leaves() {
        let Some(range) = library.index().spectra_range(leaf).filter(|range| !range.is_empty())
        else {
            continue;
        };
        let bytes = std::fs::read(path).unwrap();
        let page = &bytes[range.start as usize..range.end as usize];
        let read = library.index().read_spectra(leaf, page).unwrap();
        spectra += read.iter().flatten().count();
    }
    let entries: Vec<Value> = library
        .entries()
        .map(|entry| {
            let entry = entry.unwrap();
            described(&entry, &library.read(&entry).unwrap())
        })
        .collect();
    json!({
        "name": library.name(),
        "metadata": library.metadata(),
        "entries": entries,
        "spectra": spectra,
    })
}

fn described(entry: &Entry, texture: &[u8]) -> Value {
    let ends = |range: Option<Interval>| range.map(|range| [range.min, range.max]);
    let law = [entry.law.frequency_speed, entry.law.level_speed, entry.law.level_force];
    json!({
        "name": entry.name,
        "tags": entry.tags,
        "models": entry.models,
        "speed": ends(entry.conditions.speed_mm_s),
        "force": ends(entry.conditions.force_n),
        "contact": entry.contact,
        "law": law.map(|one| one.exponent),
        "sources": law.map(|one| one.source),
        "blake3": hex(&entry.blake3),
        "licence": entry.license,
        "author": entry.author,
        "quantity": entry.quantity,
        "felt": entry.felt_error_rms_db,
        "heldOut": entry.held_out_error_db,
        "texture": hex(texture),
    })
}

/// The parameter blocks of the valid assets, with their fields, and the numbers that they hold.
fn blocks(spec: &Path) -> (Vec<Value>, Vec<Vec<Vec<f64>>>) {
    let (mut blocks, mut numbers) = (Vec::new(), Vec::new());
    for folder in ["conformance", "playing-conformance"] {
        for file in valid(&spec.join(folder), "htex") {
            let bytes = std::fs::read(&file).unwrap();
            let manifest = manifest_json(&bytes, &Limits::default()).unwrap();
            if manifest.get("extensions_required").is_some() {
                continue;
            }
            let asset = Asset::from_bytes(&bytes).unwrap();
            let representations = manifest["representations"].as_array().unwrap();
            for (one, sets) in representations.iter().zip(asset.parameters) {
                let field = |field: &Value| {
                    let store = field.get("store").cloned().unwrap_or("f64".into());
                    json!({ "store": store, "list": field["list"] == true })
                };
                let fields: Vec<Value> =
                    one["fields"].as_array().unwrap().iter().map(field).collect();
                blocks.push(json!({
                    "file": file,
                    "bytes": hex(&entry(&bytes, one["parameters"].as_str().unwrap())),
                    "fields": fields,
                    "conditions": sets.len(),
                }));
                numbers.push(sets);
            }
        }
    }
    (blocks, numbers)
}

/// The contents of an entry of an asset.
fn entry(bytes: &[u8], name: &str) -> Vec<u8> {
    let entry = entry_ranges(bytes).into_iter().find(|entry| entry.name == name).unwrap();
    // The local header has 30 bytes, then the name. The method is at byte 8.
    let header = entry.data.start - name.len() - 30;
    let data = &bytes[entry.data];
    match bytes[header + 8] {
        0 => data.to_vec(),
        _ => {
            let mut unpacked = Vec::new();
            flate2::read::DeflateDecoder::new(data).read_to_end(&mut unpacked).unwrap();
            unpacked
        }
    }
}

fn hex(bytes: &[u8]) -> String {
    bytes.iter().map(|byte| format!("{byte:02x}")).collect()
}
