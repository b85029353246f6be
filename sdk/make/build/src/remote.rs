//! Remote files of a recipe. Remote files have URIs of a web server or an object store as their
//! paths. This module lists and hashes remote files, and copies them for the job that reads them.
//!
//! Listing the files also gives their versions, which show whether a file has changed. As with
//! local files, the key of a job depends on the hash of a file's contents. The machine that runs
//! the job reads a local copy of the file.

use std::collections::BTreeMap;
use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use htex_base::files::{AtFile, OwnFolder};
use htex_base::storage::{Location, Storage, StorageError, StorageProblem};
use tempfile::TempDir;

use crate::BuildError;
use crate::hashes::{FileHash, Stamp, hash_local};
use crate::state::inside;

/// Largest size of a file that is copied, bytes.
const MOST_BYTES: u64 = 16 << 30;
/// Largest size of a recipe or a table, bytes.
const MOST_TEXT_BYTES: u64 = 64 << 20;

/// Name of the folder for copies of remote files, in the folder of stored data.
const COPIES: &str = "elsewhere";

/// Remote files and their copies, by content.
#[derive(Debug)]
pub(crate) struct RemoteFiles {
    /// Location of the recipe. The recipe may name files on the same server.
    origin: Option<Location>,
    storage: OnceLock<Storage>,
    /// Stamps of the files that were listed.
    listed: Mutex<BTreeMap<PathBuf, Stamp>>,
    copies: Copies,
}

/// Where copies are stored.
#[derive(Debug)]
enum Copies {
    /// The folder of the results.
    Folder(OwnFolder),
    Temporary(OnceLock<TempDir>),
}

/// Returns the location of a path that is a remote URI; `None` for a local path.
pub(crate) fn remote_location(path: &Path) -> Result<Option<Location>, StorageError> {
    let location = Location::parse(path.as_os_str())?;
    Ok(location.local().is_none().then_some(location))
}

/// Returns whether a path is a remote URI.
pub(crate) fn is_remote(path: &Path) -> bool {
    !matches!(remote_location(path), Ok(None))
}

/// Resolves a path in a recipe that lies in `folder`. A URI stays unchanged. Any other path is
/// relative to the folder, which may be a URI.
pub(crate) fn joined(folder: &Path, path: &Path) -> PathBuf {
    match (is_remote(path), is_remote(folder), folder.to_str()) {
        (true, ..) => path.to_owned(),
        (false, true, Some(folder)) if path.is_relative() => {
            below(folder, &path.to_string_lossy()).into()
        }
        // `file://` is also a local path.
        _ => match Location::parse(path.as_os_str()) {
            Ok(location) => folder.join(location.local().unwrap_or(path)),
            Err(_) => folder.join(path),
        },
    }
}

/// Returns the URI of a path in a remote folder. In the path, `..` leads to the folder above, but
/// not above the bucket or host.
fn below(folder: &str, path: &str) -> String {
    let mut folder = folder.trim_end_matches('/').to_owned();
    let mut path = path;
    loop {
        path = match (path.strip_prefix("./"), path.strip_prefix("../")) {
            (Some(rest), _) => rest,
            (_, Some(rest)) => {
                let start = folder.find("://").map_or(0, |at| at + 3);
                let end = folder[start..].rfind('/').map(|at| start + at);
                folder.truncate(end.unwrap_or(folder.len()));
                rest
            }
            _ => break,
        };
    }
    match path {
        "" | "." => folder,
        path => format!("{folder}/{path}"),
    }
}

/// Returns the folder that contains a path or a URI, without the URI's query.
pub(crate) fn folder_of(path: &Path) -> PathBuf {
    if let (Ok(Some(_)), Some(text)) = (remote_location(path), path.to_str()) {
        let text = text.split('?').next().unwrap_or(text);
        return text.rsplit_once('/').map_or(text, |(folder, _)| folder).into();
    }
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder.to_owned(),
        _ => PathBuf::from("."),
    }
}

impl RemoteFiles {
    /// Stores copies in the folder of the results until [`Self::forget`] removes them. `origin` is
    /// the location of the recipe.
    pub(crate) fn with_copies(output: OwnFolder, origin: Option<Location>) -> Self {
        Self::new(Copies::Folder(output), origin)
    }

    /// Stores copies until this value is dropped.
    pub(crate) fn temporary(origin: Option<Location>) -> Self {
        Self::new(Copies::Temporary(OnceLock::new()), origin)
    }

    fn new(copies: Copies, origin: Option<Location>) -> Self {
        Self { origin, storage: OnceLock::new(), listed: Mutex::default(), copies }
    }

    /// Lists the files of a remote folder that match a glob: their URIs, and their paths in the
    /// folder.
    pub(crate) fn list(
        &self,
        folder: &Location,
        pattern: &str,
    ) -> Result<Vec<(PathBuf, PathBuf)>, StorageError> {
        let entries = self.storage()?.list(folder, pattern)?;
        let prefix = format!("{}/", folder.to_string().trim_end_matches('/'));
        let mut listed = self.listed();
        let found = entries.into_iter().map(|entry| {
            let uri = entry.location.to_string();
            let inside = uri.strip_prefix(&prefix).unwrap_or(&uri).to_owned();
            let stamp = Stamp::remote(entry.bytes, entry.etag.as_deref(), entry.modified);
            listed.insert(PathBuf::from(&uri), stamp);
            (uri.into(), inside.into())
        });
        Ok(found.collect())
    }

    /// Returns the stamp of a file, from a listing if it was listed, else by a request.
    pub(crate) fn stamp(&self, path: &Path, location: &Location) -> Result<Stamp, StorageError> {
        if let Some(stamp) = self.listed().get(path) {
            return Ok(*stamp);
        }
        let stat = self
            .storage()?
            .stat(location)?
            .ok_or_else(|| StorageProblem::Missing.at_place(location))?;
        let stamp = Stamp::remote(stat.bytes, stat.etag.as_deref(), stat.modified);
        self.listed().insert(path.to_owned(), stamp);
        Ok(stamp)
    }

    /// Copies and hashes a file.
    pub(crate) fn hash(&self, path: &Path, location: &Location) -> Result<FileHash, BuildError> {
        let stamp = self.stamp(path, location)?;
        let (blake3, _) = self.fetch(location)?;
        Ok(FileHash { blake3, stamp })
    }

    /// Returns a copy of the contents with this hash, under the file's own name. An existing copy
    /// is used if it has the hash.
    pub(crate) fn copy(&self, location: &Location, blake3: &str) -> Result<PathBuf, BuildError> {
        let name = file_name(location)?;
        let copies = self.copies()?;
        if let Ok(there) = copies.own.entry_path(&copies.inside.join(blake3).join(&name))
            && there.symlink_metadata().is_ok_and(|is| is.is_file())
            && hash_local(&there).is_ok_and(|hashed| hashed.blake3 == blake3)
        {
            return Ok(there);
        }
        let (found, copy) = self.fetch(location)?;
        if found != blake3 {
            let problem = "it changed while it was used; start again when it is complete";
            return Err(BuildError::at_place(location, problem));
        }
        Ok(copy)
    }

    /// Reads a text file.
    pub(crate) fn text(&self, location: &Location) -> Result<String, BuildError> {
        let bytes = self.storage()?.read(location, MOST_TEXT_BYTES)?;
        String::from_utf8(bytes).map_err(|_| BuildError::at_place(location, "it is not UTF-8 text"))
    }

    /// Removes all copies.
    pub(crate) fn forget(&self) -> Result<(), BuildError> {
        match &self.copies {
            Copies::Folder(own) => {
                let removed = own.remove_folder(&inside(COPIES));
                Ok(removed.writing(own.path().join(inside(COPIES)))?)
            }
            Copies::Temporary(_) => Ok(()),
        }
    }

    /// Downloads a file. Returns its hash and its copy. Other users cannot read the copy, because
    /// the store may be private.
    fn fetch(&self, location: &Location) -> Result<(String, PathBuf), BuildError> {
        let (copies, name) = (self.copies()?, file_name(location)?);
        let folder = copies.own.path().join(&copies.inside);
        // The file is written in the folder of the copies, so that at the end it only needs a new
        // name.
        let part =
            tempfile::Builder::new().suffix(".part").tempfile_in(&folder).writing(&folder)?;
        let file = part.reopen().writing(&folder)?;
        self.storage()?.download(location, file, MOST_BYTES)?;
        let mut hasher = blake3::Hasher::new();
        let written = File::open(part.path()).writing(&folder)?;
        hasher.update_reader(written).writing(&folder)?;
        let blake3 = hasher.finalize().to_hex().to_string();
        // The folder is named by the hash, which is known only once the file is complete.
        let inside = copies.inside.join(&blake3);
        let own = copies.own.make_folder(&inside).writing(&folder)?;
        let copy = own.join(name);
        part.persist(&copy).writing(&copy)?;
        Ok((blake3, copy))
    }

    /// Returns the storage for files that a recipe names. They are read under the rules for
    /// untrusted files: addresses of this machine and its network are forbidden, except the address
    /// of the recipe's own server.
    fn storage(&self) -> Result<&Storage, StorageError> {
        if let Some(storage) = self.storage.get() {
            return Ok(storage);
        }
        let storage = Storage::from_environment()?.for_names_in_a_file(self.origin.as_ref());
        Ok(self.storage.get_or_init(|| storage))
    }

    fn copies(&self) -> Result<CopiesIn, BuildError> {
        match &self.copies {
            Copies::Folder(own) => {
                let copies = inside(COPIES);
                let made = own.make_folder(&copies).writing(own.path().join(&copies))?;
                htex_base::files::private::close(&made).writing(&made)?;
                Ok(CopiesIn { own: own.clone(), inside: copies })
            }
            Copies::Temporary(held) => {
                if held.get().is_none() {
                    let folder = tempfile::Builder::new()
                        .prefix("htex-build-")
                        .tempdir()
                        .writing(std::env::temp_dir())?;
                    held.get_or_init(|| folder);
                }
                let folder = held.get().map(TempDir::path).unwrap_or(Path::new(""));
                Ok(CopiesIn { own: OwnFolder::new(folder), inside: PathBuf::new() })
            }
        }
    }

    fn listed(&self) -> MutexGuard<'_, BTreeMap<PathBuf, Stamp>> {
        self.listed.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The folder of copies: a folder in which no link is followed, and the path inside it.
struct CopiesIn {
    own: OwnFolder,
    inside: PathBuf,
}

/// Returns the name of the file. Its copy has the same name, because readers and provenance depend
/// on it.
fn file_name(location: &Location) -> Result<String, BuildError> {
    location.file_name().ok_or_else(|| {
        BuildError::at_place(location, "it has no file name at its end; name a file")
    })
}
