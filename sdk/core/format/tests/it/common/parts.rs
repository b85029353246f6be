//! The entries of a small asset, and archives made from them with one change.

use serde_json::{Value, json};

use super::raw_zip::{Entry, archive};
use super::{asset, sbeta};

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

pub fn with_text(manifest: &[u8]) -> Vec<u8> {
    archive(&parts(manifest, &block()))
}

pub(super) fn with_manifest(change: impl Fn(&mut Value)) -> Vec<u8> {
    let mut manifest = manifest();
    change(&mut manifest);
    with_text(manifest.to_string().as_bytes())
}

pub(super) fn with_block(block: &[u8]) -> Vec<u8> {
    archive(&parts(manifest().to_string().as_bytes(), block))
}

/// An asset whose parameter block is one packed list.
pub(super) fn with_packed(block: &[u8]) -> Vec<u8> {
    let mut manifest = manifest();
    manifest["representations"][0]["fields"] =
        json!([{ "name": "steps", "list": true, "store": { "packed": { "scale": 1 } } }]);
    archive(&parts(manifest.to_string().as_bytes(), block))
}

/// A coded asset of version 1.1 with two conditions, whose parameter block is one coded list. The
/// conditions are a table.
pub(super) fn with_coded(block: &[u8], change: impl Fn(&mut Value)) -> Vec<u8> {
    archive(&parts(coded_manifest(change).to_string().as_bytes(), block))
}

/// The manifest of such an asset.
pub(super) fn coded_manifest(change: impl Fn(&mut Value)) -> Value {
    let mut manifest = manifest();
    manifest["htex"] = json!("1.1");
    manifest["extensions_required"] = json!(["org.htex.coded/1"]);
    manifest["conditions"] = json!({ "columns": { "force_n": { "per": 100, "rows": [1], "values": [50] }, "speed_mm_s": [40, 80] } });
    let representation = &mut manifest["representations"][0];
    representation["model"] = json!("org.example.steps");
    representation["fields"] =
        json!([{ "name": "steps", "list": true, "store": { "coded": { "scale": 1 } } }]);
    representation["at"] = json!({ "columns": { "level_rms": [0.01, 0.02] } });
    change(&mut manifest);
    manifest
}

pub(super) fn with_parts(change: impl Fn(&mut Vec<Entry>)) -> Vec<u8> {
    let mut parts = parts(manifest().to_string().as_bytes(), &block());
    change(&mut parts);
    archive(&parts)
}

pub(super) fn with_bytes(change: impl Fn(&mut Vec<u8>)) -> Vec<u8> {
    let mut bytes = with_manifest(|_| ());
    change(&mut bytes);
    bytes
}
