//! Adds a version of a plugin to a registry that is a folder.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, OwnFolder, read_regular};
use htex_base::native::description::read_descriptor;
use htex_build::registry::{Entry, MODULE, PlatformFile, PluginKind, own_platform};
use htex_format::signing::{FileSignature, read_signature};
use serde::Deserialize;

use super::check::check_bytes;
use super::{ENTRIES, MOST_ENTRY_BYTES, MOST_PLUGIN_BYTES};
use crate::failure::{Failure, Result};
use crate::keys::signature_path;
use crate::output::{OutputFile, shown};

/// The folder of a registry with the plugins' files.
const FILES: &str = "files";

/// The texts of an entry that no plugin states itself. An entry that already exists keeps its own.
pub(crate) struct Texts {
    pub(crate) summary: Option<String>,
    pub(crate) license: Option<String>,
    pub(crate) source: Option<String>,
}

/// What was added to an entry.
pub(crate) struct Added {
    pub(crate) entry: PathBuf,
    pub(crate) id: String,
    pub(crate) version: String,
    pub(crate) platform: String,
}

/// The part of a descriptor that an entry repeats.
#[derive(Deserialize)]
struct Summary {
    summary: Option<String>,
}

/// Adds a signed plugin: copies its file and its signature, and extends its entry. Comments in the
/// entry remain. Changes nothing if an error is returned.
pub(crate) fn add(registry: &Path, plugin: &Path, texts: &Texts) -> Result<Added> {
    let bytes = read_regular(plugin, MOST_PLUGIN_BYTES).reading(plugin)?;
    let signature = read_signature(plugin).map_err(Failure::other)?.ok_or_else(|| {
        let file = shown(plugin);
        Failure::Usage(format!("{file} is not signed; `htex sign {file}` signs it"))
    })?;
    let signed = FileSignature::from_json(&signature)
        .map_err(|error| Failure::Other(format!("{}: {error}", shown(&signature_path(plugin)))))?;
    let (id, version) = (signed.content.name.clone(), signed.content.version.clone());
    if !htex_model::is_model_id(&id) {
        return Err(Failure::Other(format!("{}: it names no id of a plugin", shown(plugin))));
    }
    let kind = PluginKind::of(&bytes)
        .ok_or_else(|| Failure::Other(format!("{}: it is no plugin", shown(plugin))))?;
    let (platform, ending) = if bytes.starts_with(b"\0asm") {
        (MODULE.to_owned(), ".wasm".to_owned())
    } else {
        let platform = own_platform();
        let ending = format!("-{platform}.{}", std::env::consts::DLL_EXTENSION);
        (platform, ending)
    };
    let file = PlatformFile {
        file: format!("{FILES}/{id}-{version}{ending}"),
        platform,
        blake3: blake3::hash(&bytes).to_hex().to_string(),
    };

    let folder = OwnFolder::new(registry);
    let name = format!("{ENTRIES}/{id}.toml");
    let entry = registry.join(&name);
    let text = match folder.read(name.as_ref(), MOST_ENTRY_BYTES) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            let described = read_descriptor(plugin).reading(plugin)?;
            begin(&signed, kind, described.as_deref(), texts)?
        }
        read => String::from_utf8(read.reading(&entry)?).map_err(Failure::other)?,
    };
    let text = with_file(&text, &version, &file)
        .map_err(|problem| Failure::Other(format!("{}: {problem}", shown(&entry))))?;
    let parsed = Entry::parse(text.as_bytes())
        .map_err(|problem| Failure::Other(format!("{}: {problem}", shown(&entry))))?;
    check_bytes(&parsed, &version, &file, &bytes, &signature)
        .map_err(|problem| Failure::Other(format!("{}: {problem}", shown(plugin))))?;

    // The entry comes last: without it, nobody looks for the files.
    let signature_name = signature_path(file.file.as_ref());
    OutputFile::Inside(&folder, file.file.as_ref()).write(&bytes)?;
    OutputFile::Inside(&folder, &signature_name).write(&signature)?;
    OutputFile::Inside(&folder, name.as_ref()).write(text.as_bytes())?;
    Ok(Added { entry, id, version, platform: file.platform })
}

/// Returns the text of a new entry, without versions.
fn begin(
    signed: &FileSignature,
    kind: PluginKind,
    descriptor: Option<&str>,
    texts: &Texts,
) -> Result<String> {
    let described = descriptor.and_then(|json| serde_json::from_str::<Summary>(json).ok());
    let summary = texts.summary.clone().or(described.and_then(|described| described.summary));
    let needed = |value: Option<String>, option: &str| {
        let id = &signed.content.name;
        value.ok_or_else(|| Failure::Usage(format!("{id} is new in this registry; give {option}")))
    };
    let mut text = String::new();
    for (key, value) in [
        ("id", signed.content.name.clone()),
        ("kind", kind.name().to_owned()),
        ("summary", needed(summary, "--summary")?),
        ("license", needed(texts.license.clone(), "--license")?),
        ("source", needed(texts.source.clone(), "--source")?),
        ("key", signed.public_key.to_string()),
    ] {
        // A JSON string without control characters is also a TOML string.
        let _ = writeln!(text, "{key} = {}", serde_json::to_string(&value)?);
    }
    Ok(text)
}

/// Returns the text of an entry with another file: at the end of its last version, or as a new
/// version.
fn with_file(text: &str, version: &str, file: &PlatformFile) -> Result<String, String> {
    // A new entry has no version yet, so it is no valid entry.
    let entry = Entry::parse(text.as_bytes()).ok();
    let versions = entry.as_ref().map_or(&[][..], |entry| &entry.versions);
    let is_there = |number: &semver::Version| number.to_string() == version;
    let mut text = format!("{}\n", text.trim_end());
    match versions.iter().position(|one| is_there(&one.version)) {
        None => text += &format!("\n[[versions]]\nversion = \"{version}\"\n"),
        Some(at) if versions[at].files.iter().any(|one| one.platform == file.platform) => {
            let platform = &file.platform;
            return Err(format!("it already has version {version} for {platform}"));
        }
        Some(at) if at + 1 < versions.len() => {
            return Err(format!("version {version} is not its last one; add the file by hand"));
        }
        Some(_) => {}
    }
    let PlatformFile { platform, file, blake3 } = file;
    text += &format!(
        "\n[[versions.files]]\nplatform = \"{platform}\"\nfile = \"{file}\"\nblake3 = \"{blake3}\"\n"
    );
    Ok(text)
}
