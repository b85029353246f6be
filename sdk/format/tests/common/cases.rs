//! The conformance files: sound assets, and one for each way to break a rule.

use std::collections::BTreeMap;

use htex_format::*;
use htex_host::Registry;
use serde_json::{Value, json};

use super::manifest_cases::manifests;
use super::raw_zip::{Entry, archive};
use super::{asset, bands, five, reference, sbeta};

/// A conformance file.
pub struct Case {
    pub name: String,
    pub bytes: Vec<u8>,
    pub limits: Limits,
}

impl Case {
    /// What a reader reports that knows the models of the specification.
    pub fn report(&self) -> Report {
        let models = Registry::builtin();
        let known = |r: &Representation| models.find(&r.model).ok().map(|m| m.descriptor());
        validate_with(&self.bytes, &self.limits, &known)
    }

    /// The report the file must get, as pretty JSON.
    pub fn golden(&self) -> String {
        let report = FileReport {
            limits: overrides(&self.limits),
            ..self.report().of_file(&format!("{}.htex", self.name))
        };
        // Through a value, for its keys in alphabetical order.
        serde_json::to_string_pretty(&json!(report)).unwrap() + "\n"
    }
}

fn overrides(limits: &Limits) -> BTreeMap<String, u64> {
    let pairs = |l: &Limits| {
        [
            ("file_bytes", l.file_bytes),
            ("entries", l.entries as u64),
            ("entry_bytes", l.entry_bytes),
            ("total_bytes", l.total_bytes),
            ("ratio", l.ratio),
            ("json_depth", l.json_depth as u64),
            ("values", l.values as u64),
        ]
    };
    let all = pairs(limits).into_iter().zip(pairs(&Limits::default()));
    all.filter(|(ours, default)| ours != default)
        .map(|((name, ours), _)| (name.to_owned(), ours))
        .collect()
}

/// All files.
pub fn cases() -> Vec<Case> {
    let mut all: Vec<Case> = valid().into_iter().map(|(n, b)| case(n, b)).collect();
    let broken = archives()
        .into_iter()
        .chain(entries())
        .chain(texts())
        .chain(manifests())
        .chain(plugins());
    all.extend(broken.map(|(n, b)| case(n, b)));
    all.extend(limited());
    all
}

pub(super) type Named = (&'static str, Vec<u8>);

fn case(name: &str, bytes: Vec<u8>) -> Case {
    Case {
        name: name.to_owned(),
        bytes,
        limits: Limits::default(),
    }
}

fn valid() -> Vec<Named> {
    let mut with_reference = asset(2, vec![sbeta(2)]);
    with_reference.manifest.reference = Some(Reference {
        file: "reference.bin".to_owned(),
    });
    with_reference.reference = Some(reference(2));
    let mut extended = asset(1, vec![sbeta(1)]);
    let colour = json!({ "colour": "#a08060" });
    extended
        .manifest
        .extensions
        .insert("com.example.LOOK/1".to_owned(), colour);
    vec![
        (
            "valid_minimal",
            asset(1, vec![sbeta(1)]).to_bytes().unwrap(),
        ),
        ("valid_five_models", asset(1, five(1)).to_bytes().unwrap()),
        ("valid_conditions", asset(3, five(3)).to_bytes().unwrap()),
        ("valid_packed", asset(2, vec![bands(2)]).to_bytes().unwrap()),
        ("valid_reference", with_reference.to_bytes().unwrap()),
        ("valid_plugin", with_plugin(|_| ())),
        ("valid_extension", extended.to_bytes().unwrap()),
        ("valid_acceleration", of(Quantity::Acceleration)),
        ("valid_velocity", of(Quantity::Velocity)),
        ("valid_displacement", of(Quantity::Displacement)),
        ("valid_normal_force", of(Quantity::NormalForce)),
        (
            "valid_license_ref",
            with_manifest(|m| m["license"] = json!("LicenseRef-Example OR CC0-1.0")),
        ),
        (
            "valid_metadata",
            with_manifest(|m| {
                m["htex"] = json!("1.1");
                m["description"] = json!("Coarse cotton, plain weave, 12 threads per cm");
                m["source"] = json!("Example University, touch laboratory");
                m["doi"] = json!("10.5281/zenodo.1234567");
                m["sensor"] = json!("six-axis force and torque sensor");
                m["finger"] = json!("bare index finger");
            }),
        ),
        (
            "valid_field_order",
            with_manifest(|m| {
                let fields = m["representations"][0]["fields"].as_array_mut();
                fields.unwrap().reverse();
            }),
        ),
        ("valid_newer_store", with_store_key("1.2")),
        ("valid_field_of_newer_model", with_newer_model()),
        (
            "valid_newer_minor",
            with_manifest(|m| {
                m["htex"] = json!("1.7");
                m["friction"] = json!({ "static": 0.4 });
            }),
        ),
    ]
}

/// An asset of another quantity.
fn of(quantity: Quantity) -> Vec<u8> {
    let mut asset = asset(1, vec![sbeta(1)]);
    asset.manifest.quantity = quantity;
    asset.manifest.unit = quantity.unit().to_owned();
    asset.to_bytes().unwrap()
}

/// Two fields in steps, with a key beside those that this version knows.
pub(super) fn with_store_key(version: &str) -> Vec<u8> {
    let mut manifest = manifest();
    manifest["htex"] = json!(version);
    let fields = manifest["representations"][0]["fields"].as_array_mut();
    for field in fields.unwrap() {
        field["store"] = json!({ "u8": { "scale": 0.5 }, "entropy": { "order": 2 } });
    }
    archive(&parts(manifest.to_string().as_bytes(), &[3, 5]))
}

/// An asset fitted by a later minor version of its model, which had one more field.
fn with_newer_model() -> Vec<u8> {
    let mut manifest = manifest();
    let representation = &mut manifest["representations"][0];
    representation["model_version"] = json!("1.9.0");
    let fields = representation["fields"].as_array_mut().unwrap();
    fields.push(json!({ "name": "gamma", "store": "f32" }));
    let block = [&block()[..], &0.25f32.to_le_bytes()].concat();
    archive(&parts(manifest.to_string().as_bytes(), &block))
}

/// An asset that brings the (empty) module of its model, signed; `change` comes after signing.
fn with_plugin(change: impl Fn(&mut Asset)) -> Vec<u8> {
    let mut asset = asset(1, vec![sbeta(1)]);
    let module = b"\0asm\x01\0\0\0".to_vec();
    let plugin = Plugin::new("org.htex.sbeta", "1.0.0", &module).signed(&[7; 32]);
    asset.manifest.plugins.push(plugin);
    asset.plugins.push(module);
    change(&mut asset);
    let manifest = serde_json::to_vec(&asset.manifest).unwrap();
    let mut parts = parts(&manifest, &block());
    for (plugin, module) in asset.manifest.plugins.iter().zip(&asset.plugins) {
        parts.push(Entry::stored(&plugin.file, module));
    }
    archive(&parts)
}

fn plugins() -> Vec<Named> {
    vec![
        (
            "plugin_invalid",
            with_plugin(|a| a.manifest.plugins[0].blake3.make_ascii_uppercase()),
        ),
        (
            "plugin_duplicate",
            with_plugin(|a| a.manifest.plugins.extend_from_within(..)),
        ),
        (
            "plugin_unused",
            with_plugin(|a| {
                let module = &a.plugins[0];
                a.manifest.plugins[0] = Plugin::new("com.example.other", "1.0.0", module);
            }),
        ),
        (
            "plugin_not_wasm",
            with_plugin(|a| {
                a.plugins[0] = b"\x7fELF".to_vec();
                a.manifest.plugins[0] = Plugin::new("org.htex.sbeta", "1.0.0", &a.plugins[0]);
            }),
        ),
        (
            "plugin_hash_mismatch",
            with_plugin(|a| a.plugins[0].push(0)),
        ),
        (
            "plugin_signature_invalid",
            with_plugin(|a| a.manifest.plugins[0].version = "1.0.1".to_owned()),
        ),
    ]
}

/// The manifest of a small asset.
pub fn manifest() -> Value {
    serde_json::to_value(asset(1, vec![sbeta(1)]).manifest).unwrap()
}

pub(super) fn block() -> Vec<u8> {
    [1.5f32, 2.5].iter().flat_map(|x| x.to_le_bytes()).collect()
}

/// The entries of a small asset.
pub fn parts(manifest: &[u8], block: &[u8]) -> Vec<Entry> {
    vec![
        Entry::stored("mimetype", b"application/vnd.htex+zip"),
        Entry::stored("manifest.json", manifest),
        Entry::stored("parameters/sbeta.bin", block),
    ]
}

fn with_text(manifest: &[u8]) -> Vec<u8> {
    archive(&parts(manifest, &block()))
}

pub(super) fn with_manifest(change: impl Fn(&mut Value)) -> Vec<u8> {
    let mut manifest = manifest();
    change(&mut manifest);
    with_text(manifest.to_string().as_bytes())
}

fn with_block(block: &[u8]) -> Vec<u8> {
    archive(&parts(manifest().to_string().as_bytes(), block))
}

/// A block of one packed list.
fn with_packed(block: &[u8]) -> Vec<u8> {
    let mut manifest = manifest();
    manifest["representations"][0]["fields"] =
        json!([{ "name": "steps", "list": true, "store": { "packed": { "scale": 1 } } }]);
    archive(&parts(manifest.to_string().as_bytes(), block))
}

fn with_parts(change: impl Fn(&mut Vec<Entry>)) -> Vec<u8> {
    let mut parts = parts(manifest().to_string().as_bytes(), &block());
    change(&mut parts);
    archive(&parts)
}

fn with_bytes(change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = with_manifest(|_| ());
    change(&mut bytes);
    bytes
}

fn archives() -> Vec<Named> {
    vec![
        (
            "archive_invalid",
            b"This is no archive, but a text.".to_vec(),
        ),
        (
            "archive_invalid_cut_off",
            with_bytes(|b| b.truncate(b.len() - 9)),
        ),
        (
            "archive_invalid_directory",
            with_bytes(|b| {
                let directory = b.windows(4).position(|w| w == b"PK\x01\x02").unwrap();
                b[directory] = b'Q';
            }),
        ),
        (
            "archive_extra_data_after",
            with_bytes(|b| b.extend(b"more")),
        ),
        (
            "archive_extra_data_before",
            with_bytes(|b| {
                b.splice(0..0, *b"#!/bin/sh\n");
            }),
        ),
        (
            "archive_zip64",
            with_bytes(|b| {
                let end = b.len() - 22;
                b[end + 16..end + 20].fill(0xFF);
            }),
        ),
    ]
}

fn entries() -> Vec<Named> {
    let named = |name: &'static [u8]| {
        with_parts(move |p| p.push(Entry::stored("", b"x").with(|h| h.name = name.to_vec())))
    };
    let changed = |change: fn(&mut Entry)| with_parts(move |p| change(&mut p[2]));
    vec![
        ("entry_name_unsafe", named(b"../outside.bin")),
        ("entry_name_unsafe_absolute", named(b"/etc/passwd")),
        ("entry_name_unsafe_backslash", named(b"..\\outside.bin")),
        ("entry_name_unsafe_drive", named(b"C:outside.bin")),
        ("entry_name_unsafe_nul", named(b"a.bin\0.txt")),
        ("entry_name_duplicate", named(b"Manifest.JSON")),
        ("entry_unreferenced", named(b"notes.txt")),
        (
            "entry_encrypted_and_others",
            with_parts(|p| {
                p[1] = p[1].clone().with(|h| h.flags = 1 | 8);
                p[2] = p[2].clone().with(|h| h.method = 93);
                p[2].data[0] ^= 1;
            }),
        ),
        (
            "mimetype_wrong_and_others",
            with_parts(|p| {
                p[0] = Entry::stored("mimetype", b"application/zip");
                p[1] = Entry::stored("manifest.json", b"{}");
            }),
        ),
        (
            "entry_encrypted",
            changed(|e| *e = e.clone().with(|h| h.flags = 1)),
        ),
        (
            "entry_compression_unknown",
            changed(|e| *e = e.clone().with(|h| h.method = 93)),
        ),
        (
            "entry_data_descriptor",
            changed(|e| *e = e.clone().with(|h| h.flags = 8)),
        ),
        (
            "entry_extra_field",
            changed(|e| e.central.extra = vec![0x55, 0x54, 0, 0]),
        ),
        ("entry_header_mismatch", changed(|e| e.local.name[0] = b'P')),
        ("entry_header_mismatch_size", changed(|e| e.local.size += 1)),
        ("entry_corrupt", changed(|e| e.data[3] ^= 1)),
        (
            "entry_corrupt_unreferenced",
            with_parts(|p| {
                let mut notes = Entry::stored("notes.txt", b"x");
                notes.data[0] ^= 1;
                p.push(notes);
            }),
        ),
        (
            "entry_corrupt_deflate",
            with_parts(|p| {
                p[1] = deflated(&p[1]);
                p[1].data[0] = 7;
            }),
        ),
        (
            "entry_corrupt_trailing",
            with_parts(|p| {
                p[1] = deflated(&p[1]);
                p[1].data.extend(b"more");
                let packed = p[1].data.len() as u32;
                p[1] = p[1].clone().with(|h| h.packed = packed);
            }),
        ),
        ("mimetype_missing", with_parts(|p| p.truncate_front(1))),
        ("mimetype_not_first", with_parts(|p| p.swap(0, 1))),
        (
            "mimetype_compressed",
            with_parts(|p| p[0] = deflated(&p[0])),
        ),
        (
            "mimetype_wrong",
            with_parts(|p| p[0] = Entry::stored("mimetype", b"application/zip")),
        ),
        (
            "manifest_missing",
            with_parts(|p| {
                p.remove(1);
            }),
        ),
        ("entry_missing", with_parts(|p| p.truncate(2))),
    ]
}

trait TruncateFront {
    fn truncate_front(&mut self, count: usize);
}

impl TruncateFront for Vec<Entry> {
    fn truncate_front(&mut self, count: usize) {
        self.drain(..count);
    }
}

/// The entry as a deflate stream of one stored block (RFC 1951, section 3.2.4).
fn deflated(entry: &Entry) -> Entry {
    let length = entry.data.len() as u16;
    let mut data = vec![1];
    data.extend(length.to_le_bytes());
    data.extend((!length).to_le_bytes());
    data.extend(&entry.data);
    let packed = data.len() as u32;
    let headers = entry.clone().with(|h| {
        h.method = 8;
        h.packed = packed;
    });
    Entry { data, ..headers }
}

fn texts() -> Vec<Named> {
    let text = manifest().to_string();
    let twice = text.replacen('{', "{\"name\":\"Twice\",", 1);
    let with = |key: &str| with_text(text.replacen('{', &format!("{{{key},"), 1).as_bytes());
    let deep = format!("{}{}", "[".repeat(40), "]".repeat(40));
    vec![
        ("json_syntax", with_text(b"{\"htex\": \"1.0\",}")),
        (
            "json_syntax_utf8",
            with_text(b"{\"htex\": \"1.0\", \"name\": \"\xFF\"}"),
        ),
        (
            "json_syntax_not_finite",
            with_text(text.replacen("20.0", "1e999", 1).as_bytes()),
        ),
        ("json_too_deep", with_text(deep.as_bytes())),
        ("json_type_twice", with_text(twice.as_bytes())),
        (
            "json_type_twice_extension",
            with(r#""extensions":{"com.example.LOOK/1":[{"a~b":{"x":1,"x":1}}]}"#),
        ),
        (
            "json_type_twice_unknown",
            with(r#""friction":{"static":0.4,"static":0.4}"#),
        ),
        (
            "valid_null_in_extension",
            with(r#""extensions":{"com.example.LOOK/1":{"colour":null}}"#),
        ),
        (
            "valid_whole_numbers",
            with_text(
                text.replacen("\"condition\":0", "\"condition\":0e0", 1)
                    .replacen("\"segments\":48", "\"segments\":4.8e1", 1)
                    .as_bytes(),
            ),
        ),
        ("parameters_invalid_short", with_block(&block()[..7])),
        ("parameters_invalid_long", with_block(&[0; 9])),
        ("parameters_invalid_packed", with_packed(&[1, 0x1F, 0xE1])),
        (
            "parameters_not_finite",
            with_block(&[0, 0, 0xC0, 0x7F, 0, 0, 0, 0]),
        ),
    ]
}

/// Sound files, and limits below what they take.
fn limited() -> Vec<Case> {
    let sound = asset(1, vec![sbeta(1)]).to_bytes().unwrap();
    let default = Limits::default();
    let case = |name: &str, limits| Case {
        name: name.to_owned(),
        bytes: sound.clone(),
        limits,
    };
    vec![
        case(
            "file_too_large",
            Limits {
                file_bytes: 400,
                ..default
            },
        ),
        case(
            "archive_too_many_entries",
            Limits {
                entries: 2,
                ..default
            },
        ),
        case(
            "archive_too_large",
            Limits {
                total_bytes: 500,
                ..default
            },
        ),
        case(
            "entry_too_large",
            Limits {
                entry_bytes: 500,
                ..default
            },
        ),
        case(
            "entry_ratio",
            Limits {
                ratio: 1,
                ..default
            },
        ),
        case(
            "json_too_deep_limit",
            Limits {
                json_depth: 4,
                ..default
            },
        ),
        case(
            "values_too_many",
            Limits {
                values: 1,
                ..default
            },
        ),
    ]
}
