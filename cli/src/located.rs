//! Arguments that may be URIs. Inputs are downloaded before the command runs, and outputs are
//! uploaded when it is done. The command itself sees only local files.
//!
//! The argument parsers ([`ASSET`], [`RECORDING`], [`OUTPUT`]) replace a URI by a path in a
//! temporary folder. Printed messages show the URI again ([`with_uris`]).

use std::ffi::{OsStr, OsString};
use std::fs::File;
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
use tempfile::TempDir;

use crate::failure::{Failure, Result};

/// An argument for an asset, which must not exceed the maximum size of an asset.
pub(crate) const ASSET: Argument = Argument(Role::Asset);
/// An argument for a recording, or for any other file that is read.
pub(crate) const RECORDING: Argument = Argument(Role::Recording);
/// An argument for a file to write.
pub(crate) const OUTPUT: Argument = Argument(Role::Output);

/// An argument for a file to write that must be local, because the command writes other files next
/// to it.
pub(crate) const LOCAL_OUTPUT: Argument = Argument(Role::LocalOutput);

/// The remote files of the current run.
static REMOTE: Mutex<RemoteFiles> = Mutex::new(RemoteFiles { folder: None, files: Vec::new() });
/// The temporary folder. It has its own lock for a signal handler, which may run while the other
/// lock is held.
static FOLDER: Mutex<Option<PathBuf>> = Mutex::new(None);

struct RemoteFiles {
    folder: Option<TempDir>,
    files: Vec<RemoteCopy>,
}

/// A remote file and its local copy.
struct RemoteCopy {
    location: Location,
    local: PathBuf,
    role: Role,
}

#[derive(Clone, Copy, PartialEq)]
enum Role {
    Asset,
    Recording,
    Output,
    LocalOutput,
}

/// The parser of an argument that is a path or a URI.
#[derive(Clone, Copy)]
pub(crate) struct Argument(Role);

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
        let location = Location::parse(value).map_err(|error| wrong(error.to_string()))?;
        if matches!(self.0, Role::Output | Role::LocalOutput) {
            check_format(&location, argument).map_err(wrong)?;
        }
        if self.0 == Role::LocalOutput {
            // `check_paths` refuses a URI.
            return PathBufValueParser::new().parse_ref(command, argument, value);
        }
        match location.local() {
            Some(path) => PathBufValueParser::new().parse_ref(command, argument, path.as_os_str()),
            None => remote_files().copy_of(location, self.0).map_err(wrong),
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

impl RemoteFiles {
    /// Returns a local path that replaces a URI. The file name stays the same, because messages and
    /// formats depend on it.
    #[allow(clippy::disallowed_methods, reason = "a new temporary folder of this user")]
    fn copy_of(&mut self, location: Location, role: Role) -> Result<PathBuf, String> {
        let known = self.files.iter().find(|file| file.location == location);
        match known {
            Some(file) if role == Role::Output && file.role == Role::Output => {
                return Err(format!(
                    "{location}: two outputs would be written to it; name another file for one of them"
                ));
            }
            Some(file) if (role == Role::Output) != (file.role == Role::Output) => {
                return Err(format!(
                    "{location}: it is read here, and would be lost; name another file to write"
                ));
            }
            Some(file) => return Ok(file.local.clone()),
            None => {}
        }
        let Some(name) = location.file_name() else {
            return Err(format!("{location}: it has no file name at its end; name a file"));
        };
        let failed = |error| format!("no temporary folder for {location}: {error}");
        // Each copy has its own folder, because several URIs may have the same file name.
        let folder = self.folder().map_err(failed)?.join(self.files.len().to_string());
        std::fs::create_dir(&folder).map_err(failed)?;
        let local = folder.join(name);
        self.files.push(RemoteCopy { location, local: local.clone(), role });
        Ok(local)
    }

    fn folder(&mut self) -> std::io::Result<PathBuf> {
        if let Some(folder) = &self.folder {
            return Ok(folder.path().to_owned());
        }
        let folder = tempfile::Builder::new().prefix("htex-").tempdir()?;
        let path = folder.path().to_owned();
        // Other users must not be able to read the copies, because the remote files may be private.
        htex_base::files::private::close(&path)?;
        *FOLDER.lock().unwrap_or_else(PoisonError::into_inner) = Some(path.clone());
        self.folder = Some(folder);
        Ok(path)
    }
}

fn remote_files() -> MutexGuard<'static, RemoteFiles> {
    REMOTE.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Forgets the files of the last run and removes their local copies.
pub(crate) fn clear() {
    let mut remote = remote_files();
    remote.files.clear();
    remote.folder = None;
    FOLDER.lock().unwrap_or_else(PoisonError::into_inner).take();
}

/// Removes the local copies. A signal handler calls it before the process ends.
#[allow(clippy::disallowed_methods, reason = "a temporary folder of this user")]
pub(crate) fn remove_copies() {
    if let Some(folder) = FOLDER.lock().unwrap_or_else(PoisonError::into_inner).take() {
        let _ = std::fs::remove_dir_all(folder);
    }
}

/// Returns the remote files with a certain role.
fn files(is_wanted: impl Fn(Role) -> bool) -> Vec<(Location, PathBuf, Role)> {
    let remote = remote_files();
    let wanted = remote.files.iter().filter(|file| is_wanted(file.role));
    wanted.map(|file| (file.location.clone(), file.local.clone(), file.role)).collect()
}

/// Keeps the local copies after the command has ended.
fn keep() {
    let mut remote = remote_files();
    // From now on, messages name the copies themselves.
    remote.files.clear();
    // A signal must not remove what is kept.
    FOLDER.lock().unwrap_or_else(PoisonError::into_inner).take();
    if let Some(folder) = remote.folder.take() {
        let _ = folder.keep();
    }
}

/// Whether a path is the copy of a remote file.
pub(crate) fn is_copy(path: &Path) -> bool {
    remote_files().files.iter().any(|file| file.local == path)
}

/// Replaces the paths of local copies in a text by their URIs, both in plain text and inside JSON.
pub(crate) fn with_uris(text: &str) -> String {
    let mut text = text.to_owned();
    for file in &remote_files().files {
        let (copy, uri) = (file.local.display().to_string(), file.location.to_string());
        let escaped = |text: &str| serde_json::Value::from(text).to_string();
        let in_json = |text: &str| escaped(text).trim_matches('"').to_owned();
        if text.contains(&copy) || text.contains(&in_json(&copy)) {
            // First as a whole JSON string, in which the backslashes of a Windows path are escaped.
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
/// Then downloads the inputs.
#[allow(clippy::disallowed_methods, reason = "a new temporary folder of this user")]
pub(crate) fn download() -> Result<()> {
    let files = files(|_| true);
    if files.is_empty() {
        return Ok(());
    }
    let storage = Storage::from_environment()?;
    // Checked before any download, because a wrong output would make the download useless.
    for (location, _, _) in files.iter().filter(|(_, _, role)| *role == Role::Output) {
        storage.check_writable(location)?;
    }
    for (location, local, role) in files {
        let most_bytes = match role {
            Role::Output | Role::LocalOutput => continue,
            Role::Asset => Limits::default().file_bytes,
            Role::Recording => MOST_RECORDING_BYTES,
        };
        let mut options = File::options();
        htex_base::files::private::only_user(&mut options);
        // `create_new` follows no link. The folder is new, so nothing is there.
        let file = options.write(true).create_new(true).open(&local).writing(&local)?;
        storage.download(&location, file, most_bytes)?;
    }
    Ok(())
}

/// Uploads the outputs of a command that has succeeded. Keeps the local copies if an upload fails.
pub(crate) fn upload() -> Result<()> {
    let outputs = files(|role| role == Role::Output);
    if outputs.is_empty() {
        return Ok(());
    }
    let storage = Storage::from_environment()?;
    for (location, local, _) in outputs {
        let written = storage.write_file(&location, &local);
        written.map_err(|error| kept(&local, error))?;
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
