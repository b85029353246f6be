//! A plugin that may be installed: its file, its signature, and what its checker says.

use std::path::{Path, PathBuf};

use htex_base::files::{AtFile, OwnFolder};
use htex_base::finding::plain;
use htex_base::native::description::{read_descriptor, section};
use htex_base::storage::{Location, Storage};
use htex_build::registry::PluginKind;
use htex_format::signing::{FileSignature, SignedContent, SignedKind, read_signature_at};
use serde::Deserialize;
use tempfile::TempDir;

use crate::failure::{Failure, Result};
use crate::installed::Identity;
use crate::invocation;
use crate::keys::{KeyRing, Signer};
use crate::plugin_registry::MOST_PLUGIN_BYTES;

/// A plugin that may be installed, in a folder of its own.
pub(super) struct Candidate {
    folder: TempDir,
    pub(super) file: PathBuf,
    pub(super) bytes: Vec<u8>,
    pub(super) signature: Option<Vec<u8>>,
    pub(super) kind: PluginKind,
    pub(super) is_module: bool,
}

/// The results of `htex plugin check --json` and `htex device check --json`.
#[derive(Deserialize)]
struct Checked {
    ok: bool,
    checks: Vec<CheckedOne>,
}

#[derive(Deserialize)]
struct CheckedOne {
    check: String,
    outcome: String,
    message: String,
}

/// Returns the candidate in a file or at an address.
pub(super) fn candidate_at(text: &str) -> Result<Candidate> {
    let location = Location::parse(text.as_ref())?;
    if location.local().is_some_and(|path| !path.exists()) {
        return Err(Failure::Usage(format!(
            "{}: there is no such file; name the registry of an id with --registry",
            plain(text)
        )));
    }
    let storage = Storage::from_environment()?;
    let bytes = storage.read(&location, MOST_PLUGIN_BYTES)?;
    let signature = read_signature_at(&storage, &location)?;
    Candidate::new(bytes, signature, text)
}

impl Candidate {
    pub(super) fn new(bytes: Vec<u8>, signature: Option<Vec<u8>>, shown: &str) -> Result<Self> {
        let kind = PluginKind::of(&bytes).ok_or_else(|| {
            Failure::Other(format!("{}: it is neither a model nor a device", plain(shown)))
        })?;
        let is_module = bytes.starts_with(b"\0asm");
        let folder = tempfile::tempdir().map_err(Failure::other)?;
        let extension = if is_module { "wasm" } else { std::env::consts::DLL_EXTENSION };
        let file = folder.path().join(format!("plugin.{extension}"));
        let own = OwnFolder::private(folder.path());
        let name = file.file_name().unwrap_or_default();
        own.write(name.as_ref(), &bytes).writing(&file)?;
        Ok(Self { folder, file, bytes, signature, kind, is_module })
    }

    pub(super) fn may(&self) -> &'static str {
        if self.is_module {
            "nothing outside its sandbox"
        } else {
            "everything that you can: it is a native library"
        }
    }

    /// Returns who signed the plugin, and what the signature says.
    pub(super) fn signed(&self) -> Result<Option<(Signer, SignedContent)>> {
        let Some(signature) = &self.signature else {
            return Ok(None);
        };
        let parsed = FileSignature::from_json(signature)
            .map_err(|error| Failure::Other(format!("its signature: {error}")))?;
        let told = parsed.content;
        let kind = match self.kind {
            PluginKind::Model => SignedKind::Plugin,
            PluginKind::Device => SignedKind::Device,
        };
        let content = SignedContent::plugin(kind, &told.name, &told.version, &self.bytes);
        Ok(Some((Signer::of(&KeyRing::new()?, signature, &content)?, content)))
    }

    /// Loads the plugin in another process. Returns the id and the version that the plugin states
    /// there, and its descriptor.
    pub(super) fn identity(&self) -> Result<(Identity, String)> {
        let copy = self.folder.path().join("described.wasm");
        let mut arguments = vec!["plugin", "export", path_text(&self.file)?];
        if self.is_module {
            arguments.extend(["--output", path_text(&copy)?]);
        }
        let (status, _, error) = run_again(&arguments)?;
        if status != Some(0) {
            return Err(Failure::Other(format!("it cannot be loaded: {}", error.trim())));
        }
        let own = identity_of(if self.is_module { &copy } else { &self.file })?;
        // Lists show the descriptor that the module contains, so this descriptor must have the same
        // id and version.
        if self.is_module && section(&self.bytes).is_some() {
            let carried = identity_of(&self.file)?.0;
            if (&carried.id, &carried.version) != (&own.0.id, &own.0.version) {
                return Err(Failure::Other(format!(
                    "it is {} {}, and carries the descriptor of {} {}; not installed",
                    own.0.id,
                    own.0.version,
                    plain(&carried.id),
                    carried.version
                )));
            }
        }
        Ok(own)
    }
}

fn path_text(path: &Path) -> Result<&str> {
    path.to_str().ok_or_else(|| Failure::other("the temporary folder's name is not Unicode"))
}

fn identity_of(file: &Path) -> Result<(Identity, String)> {
    let json = read_descriptor(file).reading(file)?;
    let json = json.ok_or_else(|| Failure::other("it has no descriptor"))?;
    let identity = serde_json::from_str(&json)
        .map_err(|error| Failure::Other(format!("its descriptor: {error}")))?;
    Ok((identity, json))
}

/// Runs this program again. Returns its exit status, its output and its errors.
fn run_again(arguments: &[&str]) -> Result<(Option<i32>, Vec<u8>, String)> {
    let output = invocation::program()?.command().args(arguments).output();
    let output = output.map_err(Failure::other)?;
    let errors = String::from_utf8_lossy(&output.stderr).into_owned();
    Ok((output.status.code(), output.stdout, errors))
}

/// Runs the checker. Returns the first finding that speaks against the plugin.
pub(in crate::commands) fn first_bad(
    kind: PluginKind,
    file: &Path,
    against: Option<&Path>,
) -> Result<Option<String>> {
    let command = match kind {
        PluginKind::Model => "plugin",
        PluginKind::Device => "device",
    };
    let mut arguments = vec![command, "check", path_text(file)?, "--json"];
    if let Some(older) = against {
        arguments.extend(["--against", path_text(older)?, "--only", "successor"]);
    }
    let (_, json, errors) = run_again(&arguments)?;
    let checked: Checked = serde_json::from_slice(&json)
        .map_err(|_| Failure::Other(format!("it cannot be checked: {}", errors.trim())))?;
    if checked.ok {
        return Ok(None);
    }
    let bad = checked.checks.into_iter();
    let mut bad = bad.filter(|one| !matches!(&*one.outcome, "passed" | "warning" | "skipped"));
    let first = bad.next().map(|one| format!("check {}: {}", one.check, one.message));
    Ok(Some(first.unwrap_or_default()))
}
