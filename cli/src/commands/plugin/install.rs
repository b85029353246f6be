use std::fmt::{Display, Formatter};
use std::io::{BufRead as _, IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::files::{AtFile, OwnFolder};
use htex_base::finding::plain;
use htex_base::native::description::{description, description_path};
use htex_base::storage::Location;
use htex_build::registry::{Entry, PlatformFile, PluginKind, Version};
use htex_format::signing::PublicKey;
use serde::Serialize;

use super::candidate::{Candidate, candidate_at, first_bad};
use crate::failure::{Failure, Result};
use crate::installed::{Identity, InstalledPlugin, file_name, folder_of, remove};
use crate::keys::{KeyRing, Signer, signature_path};
use crate::output::{OutputFile, note, show, shown};
use crate::plugin_registry::{Fetched, PluginRegistry};

/// Install a model or a device in your own folder
///
/// The command checks the hash and the signature, and runs `htex plugin check` or `htex device
/// check` in separate processes. If an older version of a model with the same major version is
/// installed, the command also compares the new version with the older version. If anything is
/// wrong, it installs nothing.
///
/// A WASM module can do nothing outside its sandbox. A native library can do everything that you
/// can, so the command asks for your permission before it runs a native library.
#[derive(Args)]
pub(crate) struct Install {
    /// A file, an address (https://), or the id of a plugin in the registry
    #[arg(value_name = "FILE|URL|ID")]
    plugin: String,

    /// Registry: a folder, or an address
    #[arg(long, value_name = "DIR|URL")]
    registry: Option<String>,

    /// The version to install, from a registry [default: the newest]
    #[arg(long, value_name = "VERSION", requires = "registry")]
    version: Option<semver::Version>,

    #[command(flatten)]
    consent: Consent,

    /// Print JSON
    #[arg(long)]
    json: bool,
}

/// What the user allows beforehand.
#[derive(Args)]
pub(crate) struct Consent {
    /// Install a native library without asking
    #[arg(long)]
    yes: bool,

    /// Install a version that is not signed with the key of the installed version, without asking
    #[arg(long)]
    accept_key: bool,

    /// Refuse a plugin that this key did not sign
    #[arg(long, value_name = "NAME|KEY")]
    only_signed_by: Option<String>,
}

/// What the registry states about a candidate.
struct Promise<'a> {
    entry: &'a Entry,
    version: &'a Version,
    file: &'a PlatformFile,
}

/// A plugin that was installed.
#[derive(Serialize)]
pub(super) struct Installation {
    kind: PluginKind,
    id: String,
    version: semver::Version,
    file: PathBuf,
    /// Who signed it; left out if nobody did.
    #[serde(skip_serializing_if = "Option::is_none")]
    signer: Option<Signer>,
    may: &'static str,
}

impl Install {
    pub(crate) fn run(self) -> Result {
        let Some(place) = &self.registry else {
            let candidate = candidate_at(&self.plugin)?;
            return show(&install(&candidate, None, &self.consent)?, self.json);
        };
        let registry = PluginRegistry::at(Location::parse(place.as_ref())?)?;
        let entry = registry.entry(&self.plugin)?;
        let wanted = |version: &semver::Version| self.version.as_ref().is_none_or(|w| w == version);
        let installation = install_from(&registry, &entry, wanted, &self.consent)?;
        show(&installation, self.json)
    }
}

/// Installs a plugin from a registry, in the newest version for which `wanted` returns true.
pub(super) fn install_from(
    registry: &PluginRegistry,
    entry: &Entry,
    wanted: impl Fn(&semver::Version) -> bool,
    consent: &Consent,
) -> Result<Installation> {
    let (version, file) = entry.newest(wanted).ok_or_else(|| {
        let id = &entry.id;
        Failure::Other(format!("{id}: the registry has no such version for this machine"))
    })?;
    let Fetched { file: bytes, signature } = registry.fetch(file)?;
    let candidate = Candidate::new(bytes, Some(signature), &entry.id)?;
    install(&candidate, Some(&Promise { entry, version, file }), consent)
}

/// Asks the user for permission, unless a flag has already given the permission.
fn ask(question: &str, is_allowed: bool, flag: &str) -> Result<()> {
    if is_allowed {
        return Ok(());
    }
    let refuse = || Failure::Other(format!("{question}; not installed ({flag} installs it)"));
    if !std::io::stdin().is_terminal() {
        return Err(refuse());
    }
    eprint!("{}. Install it? [y/N] ", plain(question));
    let _ = std::io::stderr().flush();
    let mut answer = String::new();
    std::io::stdin().lock().read_line(&mut answer).map_err(Failure::other)?;
    if matches!(answer.trim(), "y" | "Y" | "yes") { Ok(()) } else { Err(refuse()) }
}

fn install(
    candidate: &Candidate,
    promise: Option<&Promise<'_>>,
    consent: &Consent,
) -> Result<Installation> {
    let signed = candidate.signed()?;
    let key = signed.as_ref().and_then(|(signer, _)| signer.public_key());
    check_signature(signed.as_ref().map(|(signer, _)| signer), consent)?;
    if let Some(promise) = promise {
        check_promise(candidate, promise, key)?;
    }
    // The key is checked before the plugin runs, so the id comes from the signature.
    if let Some((_, content)) = &signed {
        check_key(candidate, &content.name, key, consent)?;
    }
    if !candidate.is_module {
        let by = match &signed {
            Some((signer, _)) => plain(&signer.to_string()).into_owned(),
            None => "not signed".to_owned(),
        };
        let question =
            format!("it is a native library ({by}), which can do everything that you can");
        ask(&question, consent.yes, "--yes")?;
    }
    let (Identity { id, version }, descriptor) = candidate.identity()?;
    note(&["the plugin is checked, which takes a while".to_owned()]);
    let bad = first_bad(candidate.kind, &candidate.file, None)?;
    if let Some(problem) = bad {
        return Err(Failure::Other(format!(
            "it breaks a rule of plugins: {problem}; not installed"
        )));
    }
    let is = (id.as_str(), version.to_string());
    if let Some((_, content)) = &signed
        && (content.name.as_str(), content.version.clone()) != is
    {
        return Err(other_plugin(&id, &version, "signed", &content.name, &content.version));
    }
    if let Some(Promise { entry, version: promised, .. }) = promise
        && (entry.id.as_str(), promised.version.to_string()) != is
    {
        let stated = promised.version.to_string();
        return Err(other_plugin(&id, &version, "listed", &entry.id, &stated));
    }
    check_key(candidate, &id, key, consent)?;
    check_successor(candidate, &id, &version)?;
    let file = write(candidate, &id, &version, &descriptor)?;
    let (kind, may) = (candidate.kind, candidate.may());
    Ok(Installation { kind, id, version, file, signer: signed.map(|(signer, _)| signer), may })
}

fn other_plugin(
    id: &str,
    version: &semver::Version,
    how: &str,
    name: &str,
    other: &str,
) -> Failure {
    Failure::Other(format!(
        "it is {id} {version}, and {how} as {} {}; not installed",
        plain(name),
        plain(other)
    ))
}

fn check_signature(signer: Option<&Signer>, consent: &Consent) -> Result<()> {
    if let Some(signer @ (Signer::Invalid { .. } | Signer::Revoked { .. })) = signer {
        return Err(Failure::Other(format!("{}; not installed", plain(&signer.to_string()))));
    }
    let Some(wanted) = &consent.only_signed_by else {
        return Ok(());
    };
    let key = KeyRing::new()?.signer(wanted)?;
    if signer.and_then(Signer::public_key) == Some(key) {
        return Ok(());
    }
    let wanted = plain(wanted);
    Err(Failure::Other(format!("it is not signed by {wanted}; not installed")))
}

/// Compares a plugin with its registry's entry: hash, kind and key.
fn check_promise(
    candidate: &Candidate,
    promise: &Promise<'_>,
    key: Option<PublicKey>,
) -> Result<()> {
    let Promise { entry, file, .. } = promise;
    let hash = blake3::hash(&candidate.bytes).to_hex();
    let problem = if hash.as_str() != file.blake3 {
        "the file is not the one that the registry lists: its hash differs".to_owned()
    } else if candidate.kind != entry.kind {
        let (is, listed) = (candidate.kind.name(), entry.kind.name());
        format!("it is a {is}, and listed as a {listed}")
    } else if key != Some(entry.key) {
        "it is not signed with the key that the registry lists".to_owned()
    } else {
        return Ok(());
    };
    Err(Failure::Other(format!("{}: {problem}; not installed", plain(&entry.id))))
}

/// Returns the installed versions of a plugin, the newest first.
fn installed(candidate: &Candidate, id: &str) -> Result<Vec<InstalledPlugin>> {
    let all = InstalledPlugin::named(id)?.into_iter();
    Ok(all.filter(|one| one.kind == candidate.kind).collect())
}

/// Asks the user if the key is not the one of the installed version.
fn check_key(
    candidate: &Candidate,
    id: &str,
    key: Option<PublicKey>,
    consent: &Consent,
) -> Result<()> {
    let installed = installed(candidate, id)?;
    let Some(newest) = installed.first() else {
        return Ok(());
    };
    let before = newest.signer()?.and_then(|signer| signer.public_key());
    if before.is_none() || before == key {
        return Ok(());
    }
    let version = &newest.version;
    let question = format!("{id} is not signed with the key of the installed version {version}");
    ask(&question, consent.accept_key, "--accept-key")
}

/// Checks that a model plays what the installed older version plays.
fn check_successor(candidate: &Candidate, id: &str, version: &semver::Version) -> Result<()> {
    let is_older =
        |one: &InstalledPlugin| one.version < *version && one.version.major == version.major;
    let older = installed(candidate, id)?.into_iter().find(is_older);
    let Some(older) = older.filter(|_| candidate.kind == PluginKind::Model) else {
        return Ok(());
    };
    let Some(problem) = first_bad(candidate.kind, &candidate.file, Some(&older.file))? else {
        return Ok(());
    };
    let before = older.version;
    Err(Failure::Other(format!(
        "{id} {version} does not play what {before} plays: {problem}; not installed"
    )))
}

/// Writes the plugin, its signature and its descriptor to the user's folder.
fn write(
    candidate: &Candidate,
    id: &str,
    version: &semver::Version,
    descriptor: &str,
) -> Result<PathBuf> {
    let folder = folder_of(candidate.kind)?;
    let own = OwnFolder::new(&folder);
    own.make_folder(Path::new("")).writing(&folder)?;
    let name = file_name(id, version, &candidate.file);
    let path = folder.join(&name);
    let put = |path: PathBuf, bytes: &[u8]| {
        let name = path.file_name().unwrap_or_default();
        OutputFile::Inside(&own, name.as_ref()).write(bytes)
    };
    // The plugin is written last, because the other files have no effect without it. If it replaces
    // an older file, the new signature does not fit the older file until then, and htex refuses the
    // older file, which is safe.
    match &candidate.signature {
        Some(signature) => put(signature_path(&path), signature)?,
        None => remove(&signature_path(&path))?,
    }
    let described = description(&candidate.bytes, descriptor)?;
    put(description_path(&path), described.as_bytes())?;
    put(path.clone(), &candidate.bytes)?;
    Ok(path)
}

impl Display for Installation {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        let Self { kind, id, version, file, signer, may } = self;
        let signer = signer.as_ref().map_or("not signed".to_owned(), ToString::to_string);
        writeln!(f, "{} {id} {version}: {}", kind.name(), shown(file))?;
        writeln!(f, "{}; it may do {may}", plain(&signer))
    }
}
