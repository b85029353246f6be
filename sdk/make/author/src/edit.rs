//! Edits an asset's metadata without a new fit.

use htex_base::finding::Finding;
use htex_format::{Asset, Limits};
use serde_json::Value;

use crate::AuthorError;
use crate::settings::Metadata;

/// Reads an asset and changes its metadata. Parameters, recorded spectra, embedded models and their
/// signatures stay as they are.
///
/// # Errors
/// Returns an error if the bytes are not a valid asset, or if saving the changed asset would lose
/// data.
pub fn edit(bytes: &[u8], metadata: &Metadata) -> Result<Asset, AuthorError> {
    let limits = Limits::default();
    let (mut asset, findings) = Asset::from_bytes_with_findings(bytes, &limits)?;
    let lost = lost(bytes, &limits, &asset, &findings);
    if !lost.is_empty() {
        return Err(AuthorError::EditLoses { lost });
    }
    metadata.apply(&mut asset.manifest);
    Ok(asset)
}

/// Returns what would be lost if the asset were written again.
fn lost(bytes: &[u8], limits: &Limits, asset: &Asset, findings: &[Finding]) -> Vec<String> {
    let unnamed = findings.iter().filter(|finding| finding.code == "ENTRY_UNREFERENCED");
    let mut lost: Vec<String> = unnamed.map(|finding| finding.message.clone()).collect();
    // The manifest is converted to JSON text, as it would be written to the file, and parsed again.
    let written = serde_json::to_vec(&asset.manifest).unwrap_or_default();
    let read = htex_format::manifest_bytes(bytes, limits).unwrap_or_default();
    // If this program wrote the manifest, the bytes are the same, and nothing is lost.
    if read != written {
        let read = htex_format::manifest_json(bytes, limits).unwrap_or_default();
        let written = htex_format::parse_json(&written).unwrap_or_default();
        lost_keys(&read, &written, "", &mut lost);
    }
    lost
}

/// Collects the JSON pointers of keys that were read but would not be written. Empty values and
/// defaults are left out on purpose.
fn lost_keys(read: &Value, written: &Value, pointer: &str, lost: &mut Vec<String>) {
    match (read, written) {
        (Value::Object(read), Value::Object(written)) => {
            for (key, value) in read {
                let at = format!("{pointer}/{key}");
                match written.get(key) {
                    Some(kept) => lost_keys(value, kept, &at, lost),
                    None if is_left_out(value) => {}
                    None => lost.push(format!("the key {at}")),
                }
            }
        }
        (Value::Array(read), Value::Array(written)) => {
            for (i, (value, kept)) in read.iter().zip(written).enumerate() {
                lost_keys(value, kept, &format!("{pointer}/{i}"), lost);
            }
        }
        _ => {}
    }
}

fn is_left_out(value: &Value) -> bool {
    match value {
        Value::Object(map) => map.values().all(is_left_out),
        Value::Array(list) => list.is_empty(),
        // `f64` is the default store of a field, which is left out.
        Value::String(text) => text.is_empty() || text == "f64",
        Value::Bool(is) => !is,
        _ => false,
    }
}
