//! Reads and writes files by URI, in blocking calls. A location is a local path, or a URI such as
//! `https://`, `s3://`, `gs://` or `az://`.
//!
//! - A file is written completely or not at all: with one request, or in parts that become a file
//!   only with the last request. A local file is first written under a temporary name next to its
//!   target, and then renamed.
//! - The module retries after temporary failures (503, 429, a stalled or cut connection) with
//!   growing pauses, within a total time ([`Settings`]). If a response is cut off, the module
//!   requests the rest of it, from the same version of the file.
//! - Credentials come only from environment variables, and no message contains a credential
//!   ([`StorageError`]).
//! - [`Remote`] reads byte ranges that all come from the same version of a file, and counts its
//!   requests and bytes.
//!
//! Local files need no feature. Everything else needs the feature `cloud`, which uses the crates
//! `object_store`, `reqwest` and `rustls`.
//!
//! ```
//! use htex_base::storage::{Location, Storage};
//!
//! let folder = tempfile::tempdir()?;
//! let storage = Storage::from_environment()?;
//! let location = Location::parse(folder.path().join("cloth.csv").as_os_str())?; // or "s3://bucket/cloth.csv"
//! storage.write(&location, b"1,2,3")?;
//! assert_eq!(storage.read(&location, 1_000)?, b"1,2,3");
//! assert_eq!(storage.read_range(&location, 2..5)?, b"2,3");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

#[cfg(feature = "cloud")]
mod cloud;
mod error;
mod listing;
mod local;
mod location;
#[cfg(not(feature = "cloud"))]
mod no_cloud;
mod remote;
mod settings;

#[cfg(not(feature = "cloud"))]
use no_cloud as cloud;

use std::fs::File;
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;
use std::time::SystemTime;

pub use error::{StorageError, StorageProblem};
pub use listing::Entry;
pub use location::Location;
pub use remote::{Remote, Usage};
pub use settings::{Settings, Variables};

use cloud::{Clients, Store};
use location::LocalOrRemote;

/// Size and version of a file.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Stat {
    pub bytes: u64,
    /// The file's entity tag, if the store has one. The entity tag changes when the content
    /// changes.
    pub etag: Option<String>,
    /// Time when the file's content last changed, if the store states it.
    pub modified: Option<SystemTime>,
}

/// Access to files by [`Location`]. A clone shares its connections.
#[derive(Debug, Clone, Default)]
pub struct Storage {
    settings: Settings,
    variables: Variables,
    clients: Arc<Clients>,
    named: NameSource,
}

/// The source of the names of the files to access.
#[derive(Debug, Clone, Default)]
enum NameSource {
    /// The user, who may name any server.
    #[default]
    ByPerson,
    /// A file, such as a recipe. A recipe may name public servers, and the server on which the
    /// recipe itself is stored.
    InFileAt(Option<Location>),
}

impl Storage {
    /// Creates a storage that uses these settings and environment variables.
    pub fn new(settings: Settings, variables: Variables) -> Self {
        Self { settings, variables, clients: Arc::default(), named: NameSource::ByPerson }
    }

    /// Returns the time limits and retries.
    pub fn settings(&self) -> &Settings {
        &self.settings
    }

    /// Restricts access to the locations that a file, such as a recipe, may name. `origin` is the
    /// location of this file if the file is remote. The only web servers allowed are public servers
    /// and the server of `origin`. The only object stores allowed are the stores that the user's
    /// environment variables name.
    #[must_use]
    pub fn for_names_in_a_file(mut self, origin: Option<&Location>) -> Self {
        self.named = NameSource::InFileAt(origin.cloned());
        self
    }

    /// Uses the environment variables of the process: `AWS_*`, `GOOGLE_*`, `AZURE_*`,
    /// `HTEX_STORAGE_TIMEOUT_S`.
    ///
    /// # Errors
    /// Returns the errors of [`Settings::from_variables`].
    pub fn from_environment() -> Result<Self, StorageError> {
        let variables = Variables::of_process();
        Ok(Self::new(Settings::from_variables(&variables)?, variables))
    }

    /// Reads a whole file of at most `most_bytes`.
    ///
    /// # Errors
    /// Returns an error if the file is missing, is larger than `most_bytes`, or cannot be read.
    pub fn read(&self, location: &Location, most_bytes: u64) -> Result<Vec<u8>, StorageError> {
        match location.place() {
            LocalOrRemote::Local(path) => local::read(path, most_bytes),
            LocalOrRemote::Remote(uri) => self.store(location, uri)?.read(most_bytes),
        }
    }

    /// Downloads a whole file of at most `most_bytes` into an open, empty local file. After an
    /// error, the local file may contain a part of the data.
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`].
    pub fn download(
        &self,
        location: &Location,
        into: File,
        most_bytes: u64,
    ) -> Result<(), StorageError> {
        match location.place() {
            LocalOrRemote::Local(path) => local::copy(path, into, most_bytes),
            LocalOrRemote::Remote(uri) => {
                self.store(location, uri)?.download(into, most_bytes).map(drop)
            }
        }
    }

    /// Returns the size and version of a file, or `None` if the file does not exist.
    ///
    /// # Errors
    /// Returns an error if the program cannot determine whether the file exists, or how large it
    /// is.
    pub fn stat(&self, location: &Location) -> Result<Option<Stat>, StorageError> {
        match location.place() {
            LocalOrRemote::Local(path) => local::stat(path),
            LocalOrRemote::Remote(uri) => self.store(location, uri)?.stat(),
        }
    }

    /// Returns whether a file exists.
    ///
    /// # Errors
    /// Returns the errors of [`Self::stat`].
    pub fn exists(&self, location: &Location) -> Result<bool, StorageError> {
        Ok(self.stat(location)?.is_some())
    }

    /// Returns the size of a file, bytes.
    ///
    /// # Errors
    /// Returns the errors of [`Self::stat`], and an error if the file does not exist.
    pub fn size(&self, location: &Location) -> Result<u64, StorageError> {
        let stat = self.stat(location)?;
        stat.map(|stat| stat.bytes).ok_or_else(|| StorageProblem::Missing.at_place(location))
    }

    /// Reads a range of bytes. To read several ranges of one file, use [`Self::open`].
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`], and an error if the range ends after the end of the
    /// file.
    pub fn read_range(
        &self,
        location: &Location,
        range: Range<u64>,
    ) -> Result<Vec<u8>, StorageError> {
        let wanted = range.end.saturating_sub(range.start);
        if wanted == 0 {
            return Ok(Vec::new());
        }
        let remote = self.open_at(location, range.clone())?;
        if wanted > remote.head().len() as u64 {
            return Err(remote.out_of_range(range));
        }
        Ok(remote.into_head())
    }

    /// Opens one version of a file for reading ranges. The call sends a single request, which
    /// returns the first `head_bytes` bytes and the size. Reading these bytes later needs no
    /// further request.
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`].
    pub fn open(&self, location: &Location, head_bytes: u32) -> Result<Remote, StorageError> {
        self.open_at(location, 0..u64::from(head_bytes.max(1)))
    }

    fn open_at(&self, location: &Location, head: Range<u64>) -> Result<Remote, StorageError> {
        match location.place() {
            LocalOrRemote::Local(path) => Remote::of_file(location, path, head),
            LocalOrRemote::Remote(uri) => {
                Remote::of_store(location, self.store(location, uri)?, head)
            }
        }
    }

    /// Lists the files below a folder whose relative names match a pattern (`*.csv`, `**/*.htex`),
    /// sorted by name. Returns at most 1,000,000 files.
    ///
    /// # Errors
    /// Returns the errors of [`Self::read`], an error if the pattern is malformed, and an error if
    /// the folder is on a web server.
    pub fn list(&self, folder: &Location, pattern: &str) -> Result<Vec<Entry>, StorageError> {
        let pattern = listing::pattern(folder, pattern)?;
        let mut found = match folder.place() {
            LocalOrRemote::Local(path) => listing::of_folder(path, &pattern)?,
            LocalOrRemote::Remote(uri) if uri.scheme.is_read_only() => {
                return Err(StorageProblem::NoList.at_place(folder));
            }
            LocalOrRemote::Remote(uri) => {
                // Stores would list nothing below a key that ends with two slashes, and callers
                // write folders with and without one.
                let uri = uri.without_last_slash();
                self.store(&folder.with_key(&uri.path), &uri)?.list(pattern)?
            }
        };
        // Local folders come in any order, and stores in the order of their bytes.
        found.sort_by_cached_key(|entry| entry.location.to_string());
        Ok(found)
    }

    /// Writes or replaces a file, completely or not at all.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written. An existing file is then unchanged.
    pub fn write(&self, location: &Location, bytes: &[u8]) -> Result<(), StorageError> {
        match location.place() {
            LocalOrRemote::Local(path) => local::write(path, bytes),
            LocalOrRemote::Remote(uri) => self.writable(location, uri)?.write(bytes.to_vec()),
        }
    }

    /// Uploads a local file, completely or not at all. A file above 16 MiB is sent in parts of 8
    /// MiB. After a failure, the parts are removed.
    ///
    /// # Errors
    /// Returns the errors of [`Self::write`], and an error if the local file cannot be read.
    pub fn write_file(&self, location: &Location, file: &Path) -> Result<(), StorageError> {
        match location.place() {
            LocalOrRemote::Local(path) => local::write_copy(path, file),
            LocalOrRemote::Remote(uri) => self.writable(location, uri)?.upload(file),
        }
    }

    /// Removes a file. A missing file is not an error.
    ///
    /// # Errors
    /// Returns an error if the file cannot be removed. A file on a web server can never be removed.
    pub fn remove(&self, location: &Location) -> Result<(), StorageError> {
        match location.place() {
            LocalOrRemote::Local(path) => local::remove(path),
            LocalOrRemote::Remote(uri) => self.writable(location, uri)?.remove(),
        }
    }

    /// Checks whether a file at this location could be written. Sends no request, so it checks only
    /// the scheme of the URI and the settings of the store.
    ///
    /// # Errors
    /// Returns an error if the file could not be written.
    pub fn check_writable(&self, location: &Location) -> Result<(), StorageError> {
        match location.place() {
            LocalOrRemote::Local(_) => Ok(()),
            LocalOrRemote::Remote(uri) => self.writable(location, uri).map(drop),
        }
    }

    fn writable(&self, location: &Location, uri: &location::Uri) -> Result<Store, StorageError> {
        if uri.scheme.is_read_only() {
            Err(StorageProblem::ReadOnly.at_place(location))
        } else {
            self.store(location, uri)
        }
    }

    fn store(&self, location: &Location, uri: &location::Uri) -> Result<Store, StorageError> {
        let is_of_person = match &self.named {
            NameSource::ByPerson => true,
            NameSource::InFileAt(origin) => {
                origin.as_ref().is_some_and(|at| at.is_same_server(uri))
            }
        };
        let parts = (&self.settings, &self.variables, &*self.clients);
        Store::open(location, uri, parts, is_of_person)
    }
}
