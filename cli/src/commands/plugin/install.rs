use std::fmt::{Display, Formatter};
use std::io::{BufRead as _, IsTerminal as _, Write as _};
use std::path::{Path, PathBuf};

use clap::Args;
use htex_base::files::{AtFile, OwnFolder};
use htex_base::finding::plain;
use htex_base::native::description::{description, description_path, read_descriptor};
use htex_base::storage::{Location, Storage};
use htex_build::registry::{Entry, PlatformFile, PluginKind, Version};
use htex_format::signing::{FileSignature, PublicKey, SignedContent, SignedKind};
use serde::{Deserialize, Serialize};
use tempfile::TempDir;

use crate::failure::{Exit, Failure, Result};
use crate::installed::{Identity, InstalledPlugin, file_name, folder_of, remove};
use crate::invocation;
use crate::keys::{KeyRing, Signer, signature_path};
use crate::output::{OutputFile, note, print, show, shown};
use crate::plugin_registry::{Fetched, PluginRegistry};

/// Install a model or a device in your own folder
///
/// The command checks the hash and the signature, runs `htex plugin check` or `htex device check`
/// in processes of their own, and compares a newer version of an installed model with the installed
/// one. If anything is wrong, it installs nothing.
///
/// A WASM module can do nothing outside its sandbox. A native library can do everything that you
/// can, so the command asks before it runs one.
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

/// Remove plugins from your own folder
#[derive(Args)]
pub(crate) struct Remove {
    /// Id of the plugin
    id: String,

    /// Remove only this version
    #[arg(long, value_name = "VERSION")]
    version: Option<semver::Version>,
}

/// Install newer versions of installed plugins from a registry
///
/// For each plugin, the command installs the newest version with the same major version, as `htex
/// plugin install` does. If it cannot install one, it still updates the others.
#[derive(Args)]
pub(crate) struct Update {
    /// Ids of the plugins [default: all that are installed and in the registry]
    ids: Vec<String>,

    /// Registry: a folder, or an address
    #[arg(long, value_name = "DIR|URL")]
    registry: String,

    #[command(flatten)]
    consent: Consent,
}

/// A plugin that may be installed, in a folder of its own.
struct Candidate {
    folder: TempDir,
    file: PathBuf,
    bytes: Vec<u8>,
    signature: Option<Vec<u8>>,
    kind: PluginKind,
    is_module: bool,
}

/// What the registry says of a candidate.
struct Promise<'a> {
    entry: &'a Entry,
    version: &'a Version,
    file: &'a PlatformFile,
}

/// A plugin that was installed.
#[derive(Serialize)]
struct Installation {
    kind: PluginKind,
    id: String,
    version: semver::Version,
    file: PathBuf,
    /// Who signed it; left out if nobody did.
    #[serde(skip_serializing_if = "Option::is_none")]
    signer: Option<Signer>,
    may: &'static str,
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

/// Installs the newest version of a registry's plugin that is wanted.
fn install_from(
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

/// Returns the candidate in a file or at an address.
fn candidate_at(text: &str) -> Result<Candidate> {
    let location = Location::parse(text.as_ref())?;
    if location.local().is_some_and(|path| !path.exists()) {
        return Err(Failure::Usage(format!(
            "{}: there is no such file; name the registry of an id with --registry",
            plain(text)
        )));
    }
    let storage = Storage::from_environment()?;
    let bytes = storage.read(&location, MOST_BYTES)?;
    let beside = Location::parse(format!("{text}.sig").as_ref())?;
    let signature = if storage.exists(&beside)? {
        Some(storage.read(&beside, MOST_SIGNATURE_BYTES)?)
    } else {
        None
    };
    Candidate::new(bytes, signature, text)
}

/// The largest plugin, bytes.
const MOST_BYTES: u64 = 1 << 28;
/// Larger than any signature; the reader of signatures refuses what is too large.
const MOST_SIGNATURE_BYTES: u64 = 1 << 16;

impl Candidate {
    fn new(bytes: Vec<u8>, signature: Option<Vec<u8>>, shown: &str) -> Result<Self> {
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

    fn may(&self) -> &'static str {
        if self.is_module {
            "nothing outside its sandbox"
        } else {
            "everything that you can: it is a native library"
        }
    }

    /// Returns who signed the plugin, and what the signature says.
    fn signed(&self) -> Result<Option<(Signer, SignedContent)>> {
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

    /// Returns id and version, read in another process.
    fn identity(&self) -> Result<(Identity, String)> {
        if read_descriptor(&self.file).reading(&self.file)?.is_none() {
            let copy = self.folder.path().join("described.wasm");
            let mut arguments = vec!["plugin", "export", path_text(&self.file)?];
            if self.is_module {
                arguments.extend(["--output", path_text(&copy)?]);
            }
            let (status, _, error) = run_again(&arguments)?;
            if status != Some(0) {
                return Err(Failure::Other(format!("it cannot be loaded: {}", error.trim())));
            }
            if self.is_module {
                return identity_of(&copy);
            }
        }
        identity_of(&self.file)
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

/// Asks the user, or takes what was allowed beforehand.
fn ask(question: &str, is_allowed: bool, flag: &str) -> Result<()> {
    if is_allowed {
        return Ok(());
    }
    let refuse = || Failure::Other(format!("{question}; not installed ({flag} installs it)"));
    if !std::io::stdin().is_terminal() {
        return Err(refuse());
    }
    eprint!("{question}. Install it? [y/N] ");
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
    // Before the plugin runs, by the id that its signer states.
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
    note(&["the plugin is checked, which takes a while".to_owned()]);
    let bad = first_bad(candidate.kind, &candidate.file, None)?;
    if let Some(problem) = bad {
        return Err(Failure::Other(format!(
            "it breaks a rule of plugins: {problem}; not installed"
        )));
    }
    let (Identity { id, version }, descriptor) = candidate.identity()?;
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
    // The plugin comes last, since it is what makes the others count. A signature of a file that is
    // replaced would be refused in between, which is safe.
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

impl Remove {
    pub(crate) fn run(self) -> Result {
        let wanted = |one: &InstalledPlugin| {
            self.version.as_ref().is_none_or(|version| *version == one.version)
        };
        let named: Vec<InstalledPlugin> =
            InstalledPlugin::named(&self.id)?.into_iter().filter(wanted).collect();
        if named.is_empty() {
            let id = plain(&self.id);
            return Err(Failure::Usage(format!(
                "`{id}` is not installed in your folder; `htex plugin list` shows what is used"
            )));
        }
        for one in named {
            one.remove()?;
            print(&format!("removed {} {}\n", one.id, one.version))?;
        }
        Ok(Exit::SUCCESS)
    }
}

impl Update {
    pub(crate) fn run(self) -> Result {
        let registry = PluginRegistry::at(Location::parse(self.registry.as_ref())?)?;
        let mut ids: Vec<String> = if self.ids.is_empty() {
            InstalledPlugin::all()?.into_iter().map(|one| one.id).collect()
        } else {
            self.ids.clone()
        };
        ids.sort();
        ids.dedup();
        let mut is_clean = true;
        for id in ids {
            match update(&registry, &id, &self.consent) {
                Ok(Some(installation)) => print(&installation.to_string())?,
                Ok(None) => print(&format!("{id}: there is no newer version\n"))?,
                // Only what is in the registry is updated if no id was given.
                Err(Failure::Usage(_)) if self.ids.is_empty() => {}
                Err(error) => {
                    is_clean = false;
                    eprintln!("htex: {}", plain(&error.to_string()));
                }
            }
        }
        Ok(Exit::ok_if(is_clean))
    }
}

fn update(registry: &PluginRegistry, id: &str, consent: &Consent) -> Result<Option<Installation>> {
    let installed = InstalledPlugin::named(id)?;
    let newest = installed.first().ok_or_else(|| {
        Failure::Usage(format!("`{}` is not installed; `htex plugin install` does it", plain(id)))
    })?;
    let entry = registry.entry(id)?;
    let is_newer = |version: &semver::Version| {
        *version > newest.version && version.major == newest.version.major
    };
    if entry.newest(is_newer).is_none() {
        return Ok(None);
    }
    install_from(registry, &entry, is_newer, consent).map(Some)
}
