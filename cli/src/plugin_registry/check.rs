//! Checks of a registry that is a folder.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, read_regular};
use htex_build::registry::{Entry, PlatformFile, PluginKind};
use htex_format::signing::{FileSignature, PublicKey, SignedContent, SignedKind, read_signature};

use super::{ENTRIES, MOST_ENTRY_BYTES, MOST_PLUGIN_BYTES};
use crate::failure::Result;

/// An entry's file, and the entry or what is wrong with it.
pub(crate) type Read = (PathBuf, Result<Entry, String>);

/// Returns the entries of a registry, sorted by id.
pub(crate) fn entries(registry: &Path) -> Result<Vec<Read>> {
    let folder = registry.join(ENTRIES);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(&folder).reading(&folder)? {
        let path = entry.reading(&folder)?.path();
        if path.extension().is_some_and(|extension| extension == "toml") {
            files.push(path);
        }
    }
    files.sort();
    let read = |path: PathBuf| {
        let bytes = read_regular(&path, MOST_ENTRY_BYTES).reading(&path)?;
        let entry = Entry::parse(&bytes).and_then(|entry| {
            let stem = path.file_stem().and_then(|stem| stem.to_str());
            if stem == Some(&*entry.id) {
                Ok(entry)
            } else {
                Err(format!("the file should have the name {}.toml", entry.id))
            }
        });
        Ok((path, entry))
    };
    files.into_iter().map(read).collect()
}

/// Returns the keys that own the ids of a registry.
pub(crate) fn owners(registry: &Path) -> Result<BTreeMap<String, PublicKey>> {
    let entries = entries(registry)?.into_iter();
    Ok(entries.filter_map(|(_, entry)| entry.ok().map(|entry| (entry.id, entry.key))).collect())
}

/// Says what is wrong with an entry's files in the registry. Files elsewhere are not read.
pub(crate) fn problems(
    registry: &Path,
    entry: &Entry,
    earlier: Option<&BTreeMap<String, PublicKey>>,
) -> Vec<String> {
    let mut problems = Vec::new();
    let owner = earlier.and_then(|owners| owners.get(&entry.id));
    if owner.is_some_and(|owner| *owner != entry.key) {
        problems.push("its key is not the one that owns this id".to_owned());
    }
    if let Some(preview) = &entry.preview
        && !registry.join(preview).is_file()
    {
        problems.push(format!("the preview {preview} is not there"));
    }
    for version in &entry.versions {
        for file in local_files(&version.files) {
            let number = version.version.to_string();
            if let Err(problem) = check_file(registry, entry, &number, file) {
                problems.push(format!("{number}, {}: {problem}", file.file));
            }
        }
    }
    problems
}

/// Returns the files that are in the registry itself.
pub(crate) fn local_files(files: &[PlatformFile]) -> impl Iterator<Item = &PlatformFile> {
    files.iter().filter(|file| !file.file.contains("://"))
}

fn check_file(
    registry: &Path,
    entry: &Entry,
    version: &str,
    file: &PlatformFile,
) -> Result<(), String> {
    let path = registry.join(&file.file);
    let bytes = read_regular(&path, MOST_PLUGIN_BYTES).map_err(|error| error.to_string())?;
    let signature = read_signature(&path).map_err(|error| error.to_string())?;
    let signature = signature.ok_or("it has no signature")?;
    check_bytes(entry, version, file, &bytes, &signature)
}

/// Checks the bytes of a file of an entry, and of the file's signature.
pub(super) fn check_bytes(
    entry: &Entry,
    version: &str,
    file: &PlatformFile,
    bytes: &[u8],
    signature: &[u8],
) -> Result<(), String> {
    if blake3::hash(bytes).to_hex().as_str() != file.blake3 {
        return Err("its BLAKE3 is another".to_owned());
    }
    if bytes.starts_with(b"\0asm") != (file.platform == "wasm") {
        return Err(format!("it is not for the platform {}", file.platform));
    }
    if PluginKind::of(bytes) != Some(entry.kind) {
        return Err(format!("it is no {}", entry.kind.name()));
    }
    let signature = FileSignature::from_json(signature).map_err(|error| error.to_string())?;
    let kind = match entry.kind {
        PluginKind::Model => SignedKind::Plugin,
        PluginKind::Device => SignedKind::Device,
    };
    let content = SignedContent::plugin(kind, &entry.id, version, bytes);
    let key = signature.check(&content).map_err(|error| error.to_string())?;
    if key != entry.key {
        return Err("it is signed with another key than the entry's".to_owned());
    }
    Ok(())
}
