//! Reads and validates assets. Reading and validation use the same code.

use std::borrow::Cow;
use std::collections::BTreeSet;
use std::fmt::Arguments;

use serde_json::Value;

use crate::archive::Archive;
use crate::archive::{MANIFEST, MEDIA_TYPE, MIMETYPE};
use crate::block::{self, BlockError};
use crate::check_manifest::{check_manifest, grid_points};
use crate::fields::{KnownModel, check_fields};
use crate::json_text::parse_json;
use crate::limits::Limits;
use crate::manifest_json::parse;
use crate::rules as rule;
use crate::signing::WASM_MAGIC;
use crate::table::expand_tables;
use crate::unpack::STORED;
use crate::{Asset, Manifest, Plugin, Representation};
use htex_base::finding::{Finding, Findings, Report, Severity};

/// Validates the bytes of a `.htex` file. Reports every broken rule, except errors that are only
/// consequences of another reported error. Never panics, and reads no more than `limits` allow.
pub fn validate(bytes: &[u8], limits: &Limits) -> Report {
    validate_with(bytes, limits, &|_| None)
}

/// Validates as [`validate`] does, and also compares each representation's fields with the fields
/// of its model. `known` returns the descriptor of a model that the caller knows.
pub fn validate_with(bytes: &[u8], limits: &Limits, known: KnownModel<'_>) -> Report {
    let (asset, findings) = inspect(bytes, limits, known);
    Report { valid: asset.is_some(), findings }
}

/// Returns an asset's manifest as JSON, even if the manifest is not valid. In a coded asset, each
/// table is replaced by the array that it encodes. Returns `None` if the manifest cannot be
/// unpacked or is not JSON, or if a table does not encode an array.
pub fn manifest_json(bytes: &[u8], limits: &Limits) -> Option<Value> {
    let mut manifest = parse_json(&manifest_bytes(bytes, limits)?).ok()?;
    expand_tables(&mut manifest).ok()?;
    Some(manifest)
}

/// Returns the bytes of an asset's manifest, even if the manifest is not valid. Returns `None` if
/// the manifest cannot be unpacked.
pub fn manifest_bytes(bytes: &[u8], limits: &Limits) -> Option<Vec<u8>> {
    let mut findings = Findings::default();
    let archive = Archive::open(bytes, limits, &mut findings)?;
    Some(archive.entries[archive.index(MANIFEST)?].bytes.to_vec())
}

/// Reads an asset and returns it with all findings. The asset is `None` if one of the findings is
/// an error.
pub(crate) fn inspect(
    bytes: &[u8],
    limits: &Limits,
    known: KnownModel<'_>,
) -> (Option<Asset>, Vec<Finding>) {
    let mut findings = Findings::default();
    let asset = read(bytes, limits, known, &mut findings).filter(|_| !findings.has_errors());
    let findings = findings.into_list();
    let notes = findings.iter().filter(|f| f.severity == Severity::Info).cloned().collect();
    let asset = asset.map(|asset| Asset { notes, ..asset });
    (asset, findings)
}

fn read(
    bytes: &[u8],
    limits: &Limits,
    known: KnownModel<'_>,
    findings: &mut Findings,
) -> Option<Asset> {
    let archive = Archive::open(bytes, limits, findings)?;
    check_mimetype(&archive, findings);
    let Some(index) = archive.index(MANIFEST) else {
        let message = format!("there is no entry {MANIFEST}; write the asset again");
        findings.add(rule::MANIFEST_MISSING, "", message);
        return None;
    };
    let json = &archive.entries[index].bytes;
    let manifest = parse(json, limits, findings)?;
    check_manifest(&manifest, findings);
    check_fields(&manifest, known, findings);
    let mut payload = Payload {
        archive,
        // These two entries belong to the container, so the manifest must not name them for another
        // purpose.
        claimed: BTreeSet::from([MIMETYPE.to_owned(), MANIFEST.to_owned()]),
        values_left: limits.values,
        findings,
    };
    let parameters = payload.parameters(&manifest);
    let reference = payload.reference(&manifest);
    let plugins = payload.plugins(&manifest);
    payload.check_unreferenced();
    Some(Asset { manifest, parameters, reference, plugins, notes: Vec::new() })
}

fn check_mimetype(archive: &Archive<'_>, findings: &mut Findings) {
    let Some(index) = archive.index(MIMETYPE) else {
        let message = format!("there is no entry {MIMETYPE}; write it first: {MEDIA_TYPE}");
        findings.add(rule::MIMETYPE_MISSING, "", message);
        return;
    };
    findings.require(index == 0, rule::MIMETYPE_NOT_FIRST, "", || {
        format!("{MIMETYPE} is entry {index}, counted from 0; write it first")
    });
    let entry = &archive.entries[index];
    findings.require(entry.method == STORED, rule::MIMETYPE_COMPRESSED, "", || {
        format!("{MIMETYPE} is compressed; store it")
    });
    let right = *entry.bytes == *MEDIA_TYPE.as_bytes();
    findings.require(right, rule::MIMETYPE_WRONG, "", || {
        format!("{MIMETYPE} is not {MEDIA_TYPE}, byte for byte")
    });
}

/// Reads the entries that the manifest names.
struct Payload<'a, 'f> {
    archive: Archive<'a>,
    claimed: BTreeSet<String>,
    values_left: usize,
    findings: &'f mut Findings,
}

impl<'a> Payload<'a, '_> {
    fn parameters(&mut self, manifest: &Manifest) -> Vec<Vec<Vec<f64>>> {
        let all = manifest.representations.iter().enumerate();
        all.map(|(i, representation)| {
            self.block(representation, format_args!("/representations/{i}")).unwrap_or_default()
        })
        .collect()
    }

    fn block(
        &mut self,
        representation: &Representation,
        at: Arguments<'_>,
    ) -> Option<Vec<Vec<f64>>> {
        let bytes = self.entry(&representation.parameters, format_args!("{at}/parameters"))?;
        let (fields, conditions) = (&representation.fields, representation.at.len());
        match block::decode(fields, conditions, &bytes, &mut self.values_left) {
            Ok(parameters) => Some(parameters),
            Err(error) => {
                let rule = match error {
                    BlockError::NotFinite { .. } => rule::PARAMETERS_NOT_FINITE,
                    BlockError::TooMany(_) => rule::VALUES_TOO_MANY,
                    _ => rule::PARAMETERS_INVALID,
                };
                let message =
                    format!("{}: {error}; write the asset again", representation.parameters);
                self.findings.add(rule, format!("{at}/parameters"), message);
                None
            }
        }
    }

    /// Returns the bytes of an entry. Adds a finding if another key has already named the entry.
    fn entry(&mut self, name: &str, pointer: Arguments<'_>) -> Option<Cow<'a, [u8]>> {
        let Some(index) = self.archive.index(name) else {
            let message =
                format!("there is no entry {name:?}; add it or remove the reference to it");
            self.findings.add(rule::ENTRY_MISSING, pointer.to_string(), message);
            return None;
        };
        if !self.claimed.insert(name.to_owned()) {
            let message = format!("{name} is already used; use a separate entry");
            self.findings.add(rule::PARAMETERS_ENTRY_INVALID, pointer.to_string(), message);
            return None;
        }
        // Taken without a copy. `claimed` ensures that no entry is taken twice.
        Some(std::mem::take(&mut self.archive.entries[index].bytes))
    }

    fn reference(&mut self, manifest: &Manifest) -> Option<Vec<Vec<f32>>> {
        let reference = manifest.reference.as_ref()?;
        let bytes = self.entry(&reference.file, format_args!("/reference/file"))?;
        // The entry has already been claimed above. Otherwise, an invalid band would also cause a
        // finding about an unreferenced entry.
        let points = grid_points(manifest.band)?;
        let conditions = manifest.conditions.len();
        let values = points.saturating_mul(conditions);
        if values.saturating_mul(size_of::<f32>()) != bytes.len() {
            let message = format!(
                "{} has {} bytes; expected 4 for each of {points} magnitudes at {conditions} conditions",
                reference.file,
                bytes.len()
            );
            self.findings.add(rule::REFERENCE_LENGTH, "/reference/file", message);
            return None;
        }
        // The parameter blocks were read first, and have already used a part of the limit.
        if values > self.values_left {
            let message = format!("the reference's {values} numbers exceed the limit");
            self.findings.add(rule::VALUES_TOO_MANY, "/reference/file", message);
            return None;
        }
        let magnitudes: Vec<f32> = bytes
            .chunks_exact(size_of::<f32>())
            .map(|four| f32::from_le_bytes([four[0], four[1], four[2], four[3]]))
            .collect();
        let bad = magnitudes.iter().position(|m| !(m.is_finite() && *m >= 0.0));
        if let Some(bad) = bad {
            let message = format!(
                "magnitude {bad} is {}; write one that is finite and not negative",
                magnitudes[bad]
            );
            self.findings.add(rule::REFERENCE_INVALID, "/reference/file", message);
        }
        Some(magnitudes.chunks(points).map(<[f32]>::to_vec).collect())
    }

    fn plugins(&mut self, manifest: &Manifest) -> Vec<Vec<u8>> {
        let all = manifest.plugins.iter().enumerate();
        all.map(|(i, plugin)| self.module(plugin, format_args!("/plugins/{i}")).unwrap_or_default())
            .collect()
    }

    fn module(&mut self, plugin: &Plugin, at: Arguments<'_>) -> Option<Vec<u8>> {
        let bytes = self.entry(&plugin.file, format_args!("{at}/file"))?;
        let is_wasm = bytes.starts_with(WASM_MAGIC);
        let pointer = format_args!("{at}/file");
        self.findings.require(is_wasm, rule::PLUGIN_NOT_WASM, pointer, || {
            format!("{} is not a WASM module; embed the model's .wasm", plugin.file)
        });
        let hash = blake3::hash(&bytes).to_hex();
        let pointer = format_args!("{at}/blake3");
        self.findings.require(
            hash.as_str() == plugin.blake3,
            rule::PLUGIN_HASH_MISMATCH,
            pointer,
            || format!("{} has the hash {hash}; embed the module again", plugin.file),
        );
        Some(bytes.into_owned())
    }

    fn check_unreferenced(&mut self) {
        for entry in &self.archive.entries {
            self.findings.require(
                self.claimed.contains(&entry.name),
                rule::ENTRY_UNREFERENCED,
                "",
                || format!("the manifest does not refer to the entry {}; remove it", entry.name),
            );
        }
    }
}
