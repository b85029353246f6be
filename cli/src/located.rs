//! Arguments that may be URIs, textures of libraries (`cloth.htexlib#oak`), or standard input
//! (`-`). Inputs are copied before the command runs, and outputs are uploaded when it is done. The
//! command itself sees only local files.
//!
//! The argument parsers ([`ASSET`], [`RECORDING`], [`OUTPUT`]) replace such an argument by a path in
//! a temporary folder. Printed messages show the argument again ([`with_uris`]).

use std::collections::HashMap;
use std::ffi::{OsStr, OsString};
use std::fmt::{Display, Formatter};
use std::fs::File;
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use clap::ArgMatches;
use clap::builder::{PathBufValueParser, TypedValueParser};
use clap::error::ErrorKind;
use clap::parser::ValueSource;
use htex_base::files::AtFile;
use htex_base::finding::plain;
use htex_base::storage::{Location, Storage, StorageError};
use htex_format::Limits;
use htex_format::library::{Library, LibraryFile, NamePattern, split_address};
use htex_format::signing::{Signers, read_signature_at, signature_path};
use tempfile::TempDir;

use crate::failure::{Failure, Result, for_file};
use crate::signers;

/// An argument for an asset, which must not exceed the maximum size of an asset.
pub(crate) const ASSET: Argument = Argument::new(Role::Asset);
/// An argument for an asset, or for several textures of a library (`cloth.htexlib#wood/*`), which
/// [`each`] lists.
pub(crate) const ASSETS: Argument = Argument { takes_several: true, ..ASSET };
/// An argument for a recording, or for any other file that is read.
pub(crate) const RECORDING: Argument = Argument::new(Role::Recording);
/// An argument for a file that is read, or for several textures of a library.
pub(crate) const FILES: Argument = Argument { takes_several: true, ..RECORDING };
/// An argument for a file to write.
pub(crate) const OUTPUT: Argument = Argument::new(Role::Output);

/// An argument for a file to write that must be local, because the command writes other files next
/// to it.
pub(crate) const LOCAL_OUTPUT: Argument = Argument::new(Role::LocalOutput);

/// The copies of the current run.
static COPIES: Mutex<Copies> =
    Mutex::new(Copies { folder: None, files: Vec::new(), signed: Vec::new() });
/// The temporary folder. It has its own lock for a signal handler, which may run while the other
/// lock is held.
static FOLDER: Mutex<Option<PathBuf>> = Mutex::new(None);

struct Copies {
    folder: Option<TempDir>,
    files: Vec<LocalCopy>,
    /// BLAKE3 of the textures whose libraries are signed as the command requires.
    signed: Vec<[u8; 32]>,
}

/// A local copy of something that is no local file.
#[derive(Clone)]
struct LocalCopy {
    origin: Origin,
    local: PathBuf,
    role: Role,
    /// The argument from which this copy comes, if this argument stands for several copies.
    group: Option<PathBuf>,
}

/// What a copy is a copy of.
#[derive(Clone, PartialEq)]
enum Origin {
    /// A file at a URI.
    File(Location),
    /// A texture of a library, or all textures whose names match.
    Texture {
        library: Location,
        name: NamePattern,
    },
    StandardInput,
}

impl Origin {
    /// Parses an argument. Returns `None` for a local file.
    fn parse(argument: &OsStr, role: Role) -> Result<Option<Self>, String> {
        let is_read = matches!(role, Role::Asset | Role::Recording);
        if is_read && argument == "-" {
            return Ok(Some(Self::StandardInput));
        }
        let parse = |text: &OsStr| Location::parse(text).map_err(|error| error.to_string());
        match argument.to_str().and_then(split_address).filter(|_| is_read) {
            Some((library, name)) => {
                let (library, name) = (parse(library.as_ref())?, name.parse()?);
                Ok(Some(Self::Texture { library, name }))
            }
            None => {
                let location = parse(argument)?;
                Ok(location.local().is_none().then_some(Self::File(location)))
            }
        }
    }

    /// Returns the name for a copy. Messages and formats depend on it.
    fn file_name(&self, role: Role) -> Option<String> {
        match self {
            Self::File(location) => location.file_name(),
            Self::Texture { name, .. } if name.is_pattern() => Some("textures".to_owned()),
            Self::Texture { name, .. } => {
                let last = name.as_str().rsplit('/').next().unwrap_or_default();
                Some(format!("{last}.htex"))
            }
            Self::StandardInput if role == Role::Asset => Some("standard-input.htex".to_owned()),
            Self::StandardInput => Some("standard-input".to_owned()),
        }
    }
}

impl Display for Origin {
    fn fmt(&self, f: &mut Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::File(location) => Display::fmt(location, f),
            Self::Texture { library, name } => write!(f, "{library}#{name}"),
            Self::StandardInput => f.write_str("-"),
        }
    }
}

#[derive(Clone, Copy, PartialEq)]
enum Role {
    Asset,
    Recording,
    Output,
    LocalOutput,
}

/// The parser of an argument that is a path or a URI, or may be something else that is copied.
#[derive(Clone, Copy)]
pub(crate) struct Argument {
    role: Role,
    /// Whether the argument may be a pattern for several textures of a library.
    takes_several: bool,
}

impl Argument {
    const fn new(role: Role) -> Self {
        Self { role, takes_several: false }
    }
}

impl TypedValueParser for Argument {
    type Value = PathBuf;

    fn parse_ref(
        &self,
        command: &clap::Command,
        argument: Option<&clap::Arg>,
        value: &OsStr,
    ) -> Result<PathBuf, clap::Error> {
        let wrong = |words: String| {
            let text = format!("{}\n", plain(&words));
            clap::Error::raw(ErrorKind::ValueValidation, text).with_cmd(command)
        };
        let origin = Origin::parse(value, self.role).map_err(wrong)?;
        if let Some(Origin::Texture { name, .. }) = &origin
            && name.is_pattern()
            && !self.takes_several
        {
            let text = value.to_string_lossy();
            return Err(wrong(format!(
                "{text}: one texture is needed here; `htex lib ls` lists their names"
            )));
        }
        let location = || Location::parse(value).map_err(|error| wrong(error.to_string()));
        if matches!(self.role, Role::Output | Role::LocalOutput) {
            check_format(&location()?, argument).map_err(wrong)?;
        }
        if self.role == Role::LocalOutput {
            // `check_paths` refuses a URI.
            return PathBufValueParser::new().parse_ref(command, argument, value);
        }
        match origin {
            Some(origin) => copies().copy_of(origin, self.role).map_err(wrong),
            None => {
                let location = location()?;
                let path = location.local().map_or(value, Path::as_os_str);
                PathBufValueParser::new().parse_ref(command, argument, path)
            }
        }
    }
}

/// Extensions of formats that some command writes, or that a user may expect for a table.
const FORMATS: [&str; 27] = [
    "ahap", "arrow", "csv", "feather", "flac", "glb", "gltf", "h5", "haptic", "hdf5", "hjif",
    "htex", "htexlib", "html", "json", "jsonl", "mat", "mp3", "npy", "ogg", "parquet", "png",
    "svg", "toml", "tsv", "wav", "xlsx",
];

/// Refuses an output whose extension names another format than the command writes. The argument's
/// value name states the written format (`CSV`, `OUT.htexlib`). If the value name is no format
/// (`FILE`), any extension is allowed, because the extension or the command chooses the format.
fn check_format(location: &Location, argument: Option<&clap::Arg>) -> Result<(), String> {
    let names = argument.and_then(clap::Arg::get_value_names);
    let written = names
        .and_then(<[_]>::first)
        .map(|name| name.as_str())
        .map(|name| name.rsplit('.').next().unwrap_or(name).to_ascii_lowercase());
    let name = location.file_name().unwrap_or_default();
    let given = name.rsplit_once('.').map(|(_, end)| end.to_ascii_lowercase());
    let (Some(written), Some(given)) = (written, given) else {
        return Ok(());
    };
    let is_format = |extension: &String| FORMATS.contains(&&extension[..]);
    if is_format(&written) && is_format(&given) && written != given {
        Err(format!(
            "{location}: {} is written here, and .{given} is another format; name a file that ends in .{written}",
            written.to_ascii_uppercase()
        ))
    } else {
        Ok(())
    }
}

/// An argument that may be a URI, for a command that reads URIs itself.
#[cfg(feature = "build")]
#[derive(Debug, Clone)]
pub(crate) struct Anywhere(PathBuf);

#[cfg(feature = "build")]
impl From<OsString> for Anywhere {
    fn from(argument: OsString) -> Self {
        Self(argument.into())
    }
}

#[cfg(feature = "build")]
impl std::ops::Deref for Anywhere {
    type Target = Path;

    fn deref(&self) -> &Path {
        &self.0
    }
}

/// Refuses a URI in an argument for a local path, where the URI would name a folder such as `s3:`.
/// Does not affect arguments that may be URIs: either their parser [`Argument`] has already
/// replaced the URI by a local path, or their type is not a path.
///
/// # Errors
/// The error names the argument, and says what to give.
pub(crate) fn check_paths(
    command: &clap::Command,
    matches: &ArgMatches,
) -> Result<(), clap::Error> {
    let is_path =
        |arg: &&clap::Arg| arg.get_value_parser().type_id() == std::any::TypeId::of::<PathBuf>();
    for arg in command.get_arguments().filter(is_path) {
        let id = arg.get_id().as_str();
        if matches.value_source(id) != Some(ValueSource::CommandLine) {
            continue;
        }
        let given = matches.try_get_many::<PathBuf>(id).ok().flatten();
        for path in given.into_iter().flatten() {
            check_path(arg, path).map_err(|words| {
                let text = format!("{}\n", plain(&words));
                clap::Error::raw(ErrorKind::ValueValidation, text).with_cmd(command)
            })?;
        }
    }
    let inner = matches.subcommand();
    let inner = inner.and_then(|(name, inner)| Some((command.find_subcommand(name)?, inner)));
    inner.map_or(Ok(()), |(command, inner)| check_paths(command, inner))
}

fn check_path(arg: &clap::Arg, path: &Path) -> Result<(), String> {
    let is_local = |location: &Location| location.local() == Some(path);
    let shown = match Location::parse(path.as_os_str()) {
        Ok(location) if is_local(&location) => return Ok(()),
        Ok(location) => location.to_string(),
        Err(error) => return Err(error.to_string()),
    };
    Err(format!(
        "{shown}: {arg} takes a path of this machine, not a URI; give a path, and copy the results or get the file by another program"
    ))
}

impl Copies {
    /// Returns a local path that replaces an argument.
    #[allow(clippy::disallowed_methods, reason = "a new temporary folder of this user")]
    fn copy_of(&mut self, origin: Origin, role: Role) -> Result<PathBuf, String> {
        let known = self.files.iter().find(|file| file.origin == origin);
        match known {
            Some(file) if role == Role::Output && file.role == Role::Output => {
                return Err(format!(
                    "{origin}: two outputs would be written to it; name another file for one of them"
                ));
            }
            Some(file) if (role == Role::Output) != (file.role == Role::Output) => {
                return Err(format!(
                    "{origin}: it is read here, and would be lost; name another file to write"
                ));
            }
            Some(file) => return Ok(file.local.clone()),
            None => {}
        }
        let Some(name) = origin.file_name(role) else {
            return Err(format!("{origin}: it has no file name at its end; name a file"));
        };
        let failed = |error| format!("no temporary folder for {origin}: {error}");
        // Each copy has its own folder, because several URIs may have the same file name.
        let folder = self.folder().map_err(failed)?.join(self.files.len().to_string());
        std::fs::create_dir(&folder).map_err(failed)?;
        let local = folder.join(name);
        self.files.push(LocalCopy { origin, local: local.clone(), role, group: None });
        Ok(local)
    }

    fn folder(&mut self) -> std::io::Result<PathBuf> {
        if let Some(folder) = &self.folder {
            return Ok(folder.path().to_owned());
        }
        let folder = tempfile::Builder::new().prefix("htex-").tempdir()?;
        let path = folder.path().to_owned();
        // Other users must not be able to read the copies, because the files may be private.
        htex_base::files::private::close(&path)?;
        *FOLDER.lock().unwrap_or_else(PoisonError::into_inner) = Some(path.clone());
        self.folder = Some(folder);
        Ok(path)
    }
}

fn copies() -> MutexGuard<'static, Copies> {
    COPIES.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Forgets the copies of the last run and removes them.
pub(crate) fn clear() {
    let mut copies = copies();
    copies.files.clear();
    copies.signed.clear();
    copies.folder = None;
    FOLDER.lock().unwrap_or_else(PoisonError::into_inner).take();
}

/// Removes the local copies. A signal handler calls it before the process ends.
#[allow(clippy::disallowed_methods, reason = "a temporary folder of this user")]
pub(crate) fn remove_copies() {
    if let Some(folder) = FOLDER.lock().unwrap_or_else(PoisonError::into_inner).take() {
        let _ = std::fs::remove_dir_all(folder);
    }
}

/// Returns the remote files to write, with their local copies.
fn outputs() -> Vec<(Location, PathBuf)> {
    let copies = copies();
    let outputs = copies.files.iter().filter(|file| file.role == Role::Output);
    let located = outputs.filter_map(|file| match &file.origin {
        Origin::File(location) => Some((location.clone(), file.local.clone())),
        _ => None,
    });
    located.collect()
}

/// Replaces each argument for several textures by the copies of these textures. Other arguments
/// stay.
pub(crate) fn each(arguments: &[PathBuf]) -> Vec<PathBuf> {
    let copies = copies();
    let own = |argument: &PathBuf| {
        let is_own = |file: &&LocalCopy| file.group.as_ref() == Some(argument);
        let own: Vec<PathBuf> =
            copies.files.iter().filter(is_own).map(|file| file.local.clone()).collect();
        if own.is_empty() { vec![argument.clone()] } else { own }
    };
    arguments.iter().flat_map(own).collect()
}

/// Keeps the local copies after the command has ended.
fn keep() {
    let mut copies = copies();
    // From now on, messages name the copies themselves.
    copies.files.clear();
    // A signal must not remove what is kept.
    FOLDER.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(folder) = copies.folder.take() {
        let _ = folder.keep();
    }
}

/// Whether a path is a copy of something that is no local file.
pub(crate) fn is_copy(path: &Path) -> bool {
    copies().files.iter().any(|file| file.local == path)
}

/// Returns the BLAKE3 of the copied textures whose libraries are signed as the command requires.
pub(crate) fn signed_textures() -> Vec<[u8; 32]> {
    copies().signed.clone()
}

/// Returns the name of a copy's texture in its library; `None` for all other files.
pub(crate) fn texture_name(path: &Path) -> Option<PathBuf> {
    let copies = copies();
    let file = copies.files.iter().find(|file| file.local == path)?;
    match &file.origin {
        Origin::Texture { name, .. } => Some(PathBuf::from(format!("{name}.htex"))),
        _ => None,
    }
}

/// Replaces the paths of local copies in a text by what they are copies of, both in plain text and
/// inside JSON.
pub(crate) fn with_uris(text: &str) -> String {
    let mut text = text.to_owned();
    // If an argument stands for several copies, they are in its folder and come later in the list.
    // So the later copies are replaced first.
    for file in copies().files.iter().rev() {
        let (copy, uri) = (file.local.display().to_string(), file.origin.to_string());
        let escaped = |text: &str| serde_json::Value::from(text).to_string();
        let in_json = |text: &str| escaped(text).trim_matches('"').to_owned();
        if text.contains(&copy) || text.contains(&in_json(&copy)) {
            // The path is replaced first where it is a whole JSON string, because a JSON string
            // escapes the backslashes of a Windows path.
            text = text.replace(&escaped(&copy), &escaped(&uri));
            text = text.replace(&copy, &uri);
        }
    }
    text
}

/// Maximum size of a downloaded recording, bytes. `--most-numbers` limits how many of its values
/// are kept.
const MOST_RECORDING_BYTES: u64 = 16 << 30;

/// Checks that the outputs can be written, as far as this is possible without a network request.
/// Then makes the copies of the inputs. If a key must have signed them, refuses the textures of
/// libraries that it did not sign, and puts the signatures of other files beside their copies, where
/// the reader of the copies checks them.
pub(crate) fn download(key: Option<&str>) -> Result<()> {
    let files = copies().files.clone();
    if files.is_empty() {
        return Ok(());
    }
    let storage = Storage::from_environment()?;
    // The outputs are checked before any download, because a wrong output would make the download
    // useless.
    for (location, _) in outputs() {
        storage.check_writable(&location)?;
    }
    let signers = key.map(signers::signers).transpose()?;
    let mut libraries = HashMap::new();
    for file in files {
        let most_bytes = match file.role {
            Role::Output | Role::LocalOutput => continue,
            Role::Asset => Limits::default().file_bytes,
            Role::Recording => MOST_RECORDING_BYTES,
        };
        match &file.origin {
            Origin::File(location) => {
                storage.download(location, create(&file.local)?, most_bytes)?;
                let signature = signers.as_ref().map(|_| read_signature_at(&storage, location));
                if let Some(signature) = signature.transpose()?.flatten() {
                    write(&signature_path(&file.local), &signature)?;
                }
            }
            Origin::StandardInput if signers.is_some() && file.role == Role::Asset => {
                return Err(Failure::other(
                    "-: standard input has no signature; name a file that has its .sig beside it",
                ));
            }
            Origin::StandardInput => {
                // With the additional byte, the reader of assets refuses the file.
                let mut input = std::io::stdin().lock().take(most_bytes.saturating_add(1));
                std::io::copy(&mut input, &mut create(&file.local)?).writing(&file.local)?;
            }
            Origin::Texture { library, name } => {
                let opened = match libraries.remove(library) {
                    Some(opened) => opened,
                    None => open_library(&storage, library, signers.as_ref())?,
                };
                let taken = take_out(&opened, library, name, &file)?;
                if signers.is_some() {
                    copies().signed.extend(taken);
                }
                libraries.insert(library.clone(), opened);
            }
        }
    }
    Ok(())
}

/// Opens a library, if the signers signed it.
fn open_library(
    storage: &Storage,
    location: &Location,
    signers: Option<&Signers>,
) -> Result<Library<LibraryFile>> {
    let library = Library::open_located(storage, location)
        .map_err(for_file(location.to_string().as_ref()))?;
    if let Some(signers) = signers {
        signers::check_library(storage, location, &library, signers)?;
    }
    Ok(library)
}

/// Copies the textures of a library that an argument names. Returns their BLAKE3.
fn take_out(
    opened: &Library<LibraryFile>,
    library: &Location,
    name: &NamePattern,
    file: &LocalCopy,
) -> Result<Vec<[u8; 32]>> {
    let shown = PathBuf::from(library.to_string());
    if !name.is_pattern() {
        let entry = opened.needed(name.as_str()).map_err(for_file(&shown))?;
        write(&file.local, &opened.read(&entry).map_err(for_file(&shown))?)?;
        return Ok(vec![entry.blake3]);
    }
    let (mut found, mut taken, mut ratio) = (Vec::new(), Vec::new(), opened.ratio());
    for entry in opened.entries() {
        let entry = entry.map_err(for_file(&shown))?;
        if !name.matches(&entry.name) {
            continue;
        }
        ratio.add(&entry).map_err(for_file(&shown))?;
        let local = file.local.join(format!("{}.htex", entry.name));
        let folder = local.parent().unwrap_or(&file.local);
        create_folder(folder).writing(folder)?;
        write(&local, &opened.read(&entry).map_err(for_file(&shown))?)?;
        taken.push(entry.blake3);
        let name = entry.name.parse().map_err(Failure::Other)?;
        found.push(LocalCopy {
            origin: Origin::Texture { library: library.clone(), name },
            local,
            role: file.role,
            group: Some(file.local.clone()),
        });
    }
    if found.is_empty() {
        let origin = &file.origin;
        return Err(Failure::Other(format!(
            "{origin}: no texture has such a name; `htex lib ls` lists their names"
        )));
    }
    copies().files.extend(found);
    Ok(taken)
}

/// Writes the file of a copy.
fn write(path: &Path, bytes: &[u8]) -> Result<()> {
    Ok(create(path)?.write_all(bytes).writing(path)?)
}

#[allow(clippy::disallowed_methods, reason = "inside a new temporary folder of this user")]
fn create_folder(folder: &Path) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)
}

/// Creates the file of a copy.
#[allow(clippy::disallowed_methods, reason = "a new temporary folder of this user")]
fn create(path: &Path) -> Result<File> {
    let mut options = File::options();
    htex_base::files::private::only_user(&mut options);
    // `create_new` follows no link. The folder is new, so nothing is there.
    Ok(options.write(true).create_new(true).open(path).writing(path)?)
}

/// Uploads the outputs of a command that has succeeded, files and folders. Keeps the local copies if an upload fails.
pub(crate) fn upload() -> Result<()> {
    let outputs = outputs();
    if outputs.is_empty() {
        return Ok(());
    }
    let storage = Storage::from_environment()?;
    for (location, local) in outputs {
        if local.is_dir() {
            upload_folder(&storage, &location, &local)?;
        } else {
            storage.write_file(&location, &local).map_err(|error| kept(&local, error))?;
        }
    }
    Ok(())
}

/// Uploads each file of a folder, in the order of their names. Files in the store that have other
/// names stay there.
fn upload_folder(storage: &Storage, location: &Location, folder: &Path) -> Result<()> {
    let mut entries: Vec<_> =
        std::fs::read_dir(folder).reading(folder)?.collect::<Result<_, _>>().reading(folder)?;
    entries.sort_by_key(std::fs::DirEntry::file_name);
    for entry in entries {
        let (location, local) =
            (location.inside(&entry.file_name().to_string_lossy()), entry.path());
        if local.is_dir() {
            upload_folder(storage, &location, &local)?;
        } else {
            storage.write_file(&location, &local).map_err(|error| kept(folder, error))?;
        }
    }
    Ok(())
}

/// Keeps the local copies after a failed upload. Returns the error, which names the copy of the
/// output.
fn kept(copy: &Path, error: StorageError) -> Failure {
    keep();
    Failure::Other(format!("{error}; the result is kept in {}", copy.display()))
}

/// Returns an argument in a form that may be shown and stored. A URL loses its query, which may
/// contain a signature.
pub(crate) fn without_secrets(argument: OsString) -> OsString {
    let Some(text) = argument.to_str() else {
        return argument;
    };
    let (flag, value) = match text.split_once('=') {
        Some((flag, value)) if flag.starts_with('-') => (Some(flag), value),
        _ => (None, text),
    };
    match Location::parse(value.as_ref()) {
        Ok(location) if location.local().is_none() => match flag {
            Some(flag) => format!("{flag}={location}").into(),
            None => location.to_string().into(),
        },
        _ => argument,
    }
}
