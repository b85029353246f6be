//! `manifest.json`, in a container with all entries that it names.

use serde_json::Value;

use crate::asset::open;
use crate::container::container;

/// Largest size of a generated entry, bytes.
const MOST: usize = 1 << 16;

/// Opens an asset with this manifest, and with entries as it describes them.
pub fn manifest(json: &[u8]) -> bool {
    let value: Value = serde_json::from_slice(json).unwrap_or_default();
    let mut entries: Vec<(&str, Vec<u8>)> = Vec::new();
    for representation in list(&value, "/representations") {
        if let Some(name) = text(representation, "/parameters") {
            entries.push((name, block(representation)));
        }
    }
    if let Some(name) = text(&value, "/reference/file") {
        entries.push((name, vec![0; reference_bytes(&value)]));
    }
    for plugin in list(&value, "/plugins") {
        entries.extend(text(plugin, "/file").map(|name| (name, b"\0asm\x01\0\0\0".to_vec())));
    }
    let entries = entries.iter().map(|(name, bytes)| (*name, &bytes[..]));
    open(&container(json, entries))
}

fn list<'a>(value: &'a Value, pointer: &str) -> &'a [Value] {
    let list = value.pointer(pointer).and_then(Value::as_array);
    list.map_or(&[], Vec::as_slice)
}

fn text<'a>(value: &'a Value, pointer: &str) -> Option<&'a str> {
    value.pointer(pointer)?.as_str()
}

/// A parameter block for the fields. Lists have one number, and all bytes are 1.
fn block(representation: &Value) -> Vec<u8> {
    let one = |field: &Value| {
        let store = field.get("store");
        let width = match store.and_then(Value::as_str) {
            Some("f32") => 4,
            Some(_) => 8,
            None if store.and_then(|store| store.get("u16")).is_some() => 2,
            None if store.and_then(|store| store.get("u8")).is_some() => 1,
            None => 8,
        };
        width + usize::from(field.get("list") == Some(&Value::Bool(true)))
    };
    let condition: usize = list(representation, "/fields").iter().map(one).sum();
    let bytes = condition * list(representation, "/at").len();
    vec![1; bytes.min(MOST)]
}

/// Size of the spectra on a 5 Hz grid, one for each condition, bytes.
fn reference_bytes(manifest: &Value) -> usize {
    let edge = |name: &str| manifest.pointer(name).and_then(Value::as_f64).unwrap_or(0.0);
    let first = (edge("/band/low_hz") / 5.0).ceil();
    let last = (edge("/band/high_hz") / 5.0).floor();
    let points = (last - first + 1.0).clamp(0.0, 1e4) as usize;
    (4 * points * list(manifest, "/conditions").len()).min(MOST)
}
