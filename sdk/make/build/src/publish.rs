//! Publishes the results of a build to a URI. A build writes its results to a local folder, and
//! this module copies them to the URI.
//!
//! Nothing is copied until all results are complete, so that users never see a half-built library.

use std::collections::{BTreeMap, BTreeSet};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};

use htex_base::files::AtFile;
use htex_base::storage::{Location, Storage, StorageError};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};
use walkdir::WalkDir;

use crate::BuildError;
use crate::error::at_place;
use crate::hashes::{Stamp, hash_local};
use crate::remote::remote_location;
use crate::state::StateFolder;

/// File that lists what was copied, in the folder of stored data.
const PUBLISHED: &str = "published.json";
/// Largest size of that file, bytes: a few million files.
const MOST_BYTES: u64 = 1 << 30;
/// Name of the file that tests the URI.
const TRIED: &str = ".htex-build-tries";
/// Files that are copied last, in this order, because they name other files that must already
/// exist.
const LAST: [&str; 2] = ["build-report.json", "index.html"];
/// Number of copies at the same time. Most of the time they wait for the network.
const AT_ONCE: usize = 8;

/// The places to which a build writes its results: a local folder and, if given, a URI.
///
/// ```
/// use htex_build::Destination;
///
/// let here = Destination::parse("dist".as_ref(), None)?;
/// assert_eq!(here.folder(), "dist");
/// # Ok::<(), htex_build::BuildError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Destination {
    folder: PathBuf,
    remote: Option<Location>,
}

/// The copied files, by their paths in the folder of the results.
#[derive(Debug, Default, Serialize, Deserialize)]
struct PublishedFiles {
    /// The URI of the folder.
    to: String,
    files: BTreeMap<String, CopiedFile>,
}

#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct CopiedFile {
    blake3: String,
    there: Stamp,
}

impl Destination {
    /// Parses an argument: a folder, or a folder's URI (`s3://`, `gs://`, `az://`). The build makes
    /// results for a URI in the folder `work`. This folder also contains stored results for the
    /// next build. If `work` is `None`, a folder in the user's cache is used.
    ///
    /// # Errors
    /// Returns an error if the URI is malformed or read-only. Also returns an error if `work` is
    /// `None` and the environment names no folder for caches.
    pub fn parse(argument: &OsStr, work: Option<&Path>) -> Result<Self, BuildError> {
        let Some(location) = remote_location(Path::new(argument))? else {
            let location = Location::parse(argument)?;
            let folder = location.local().unwrap_or(Path::new(argument)).to_owned();
            return Ok(Self { folder, remote: None });
        };
        Storage::from_environment()?.check_writable(&location)?;
        let folder = match work {
            Some(folder) => folder.to_owned(),
            None => default_folder(&location)?,
        };
        Ok(Self { folder, remote: Some(location) })
    }

    /// Returns the local folder in which the results are made.
    pub fn folder(&self) -> &Path {
        &self.folder
    }

    /// Returns the final location of the results: the URI or, if there is none, the folder.
    pub fn results(&self) -> Location {
        let folder = || Location::from(self.folder.clone());
        self.remote.clone().unwrap_or_else(folder)
    }

    /// Returns the URI to which the results are copied, if there is one.
    pub fn remote(&self) -> Option<&Location> {
        self.remote.as_ref()
    }

    /// Tests whether a file can be written at the URI and removed again. Call this function before
    /// fitting. A program that calls this function first can report an error at once, and not after
    /// hours of work. Without a URI, does nothing.
    ///
    /// # Errors
    /// Returns an error if the file cannot be written or removed.
    pub fn try_out(&self) -> Result<(), BuildError> {
        let Some(to) = &self.remote else {
            return Ok(());
        };
        let (storage, file) = (Storage::from_environment()?, to.inside(TRIED));
        storage.write(&file, b"htex build tries whether it can write here\n")?;
        Ok(storage.remove(&file)?)
    }

    /// Copies the results to the URI, if there is one. Only files that differ from the files at the
    /// URI are copied: textures first, report and catalogue last. Also removes files from the URI,
    /// if an earlier build copied them there and this build has not made them. Returns the number
    /// of copied files.
    ///
    /// # Errors
    /// Returns an error if a file cannot be read or written. The next call then copies the files
    /// that are not yet at the URI.
    pub fn publish(&self) -> Result<usize, BuildError> {
        match &self.remote {
            Some(to) => Publishing::new(&self.folder, to)?.run(),
            None => Ok(0),
        }
    }
}

/// Returns the folder in which results for a URI are made: `htex/builds/HASH` in the user's cache,
/// where HASH is the hash of the URI.
fn default_folder(location: &Location) -> Result<PathBuf, BuildError> {
    // The XDG base directory specification says to ignore relative paths.
    let variable = |name| {
        let path = PathBuf::from(std::env::var_os(name)?);
        path.is_absolute().then_some(path)
    };
    let home = || variable("HOME").map(|home| home.join(".cache"));
    let cache = variable("XDG_CACHE_HOME")
        .or_else(|| variable("LOCALAPPDATA"))
        .or_else(home)
        .ok_or_else(|| {
            let problem =
                "there is no folder for the work: HOME is not set; name one (`--work DIR`)";
            BuildError::at_place(location, problem)
        })?;
    let hash = blake3::hash(location.to_string().as_bytes()).to_hex();
    Ok(cache.join("htex").join("builds").join(&hash[..16]))
}

/// A running copy of results.
struct Publishing<'a> {
    folder: &'a Path,
    to: &'a Location,
    storage: Storage,
    kept: StateFolder,
    before: PublishedFiles,
}

impl<'a> Publishing<'a> {
    fn new(folder: &'a Path, to: &'a Location) -> Result<Self, BuildError> {
        let kept = StateFolder::new(folder)?;
        let before = kept
            .get(PUBLISHED, MOST_BYTES)
            .and_then(|bytes| serde_json::from_slice::<PublishedFiles>(&bytes).ok());
        Ok(Self {
            folder,
            to,
            storage: Storage::from_environment()?,
            // A list of copies to another URI says nothing about this URI.
            before: before.filter(|before| before.to == to.to_string()).unwrap_or_default(),
            kept,
        })
    }

    fn run(self) -> Result<usize, BuildError> {
        let there = self.there()?;
        let here = self.here()?;
        let is_there = |name: &str, blake3: &str| {
            let copied = self.before.files.get(name);
            // The version at the URI must also be the version that was copied, because somebody may
            // have replaced the file.
            copied.is_some_and(|copied| {
                copied.blake3 == blake3 && there.get(name) == Some(&copied.there)
            })
        };
        let wanted: Vec<&String> = here
            .iter()
            .filter(|(name, blake3)| !is_there(name, blake3))
            .map(|(name, _)| name)
            .collect();
        let (last, first): (Vec<_>, Vec<_>) =
            wanted.iter().copied().partition(|name| LAST.contains(&name.as_str()));
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(AT_ONCE)
            .build()
            .map_err(at_place("publish"))?;
        pool.install(|| first.par_iter().try_for_each(|name| self.copy(name)))?;
        last.iter().try_for_each(|name| self.copy(name))?;
        let copied = wanted.len();
        // The stale files are removed only after the new report, which no longer names them, is at
        // the URI.
        self.remove_stale(&here, &there)?;
        self.keep(here)?;
        Ok(copied)
    }

    /// Returns the files at the URI with their versions.
    fn there(&self) -> Result<BTreeMap<String, Stamp>, StorageError> {
        let prefix = format!("{}/", self.to.to_string().trim_end_matches('/'));
        let entries = self.storage.list(self.to, "**/*")?;
        let named = entries.into_iter().filter_map(|entry| {
            let uri = entry.location.to_string();
            let stamp = Stamp::remote(entry.bytes, entry.etag.as_deref(), entry.modified);
            Some((uri.strip_prefix(&prefix)?.to_owned(), stamp))
        });
        Ok(named.collect())
    }

    /// Returns the local results with their hashes.
    fn here(&self) -> Result<BTreeMap<String, String>, BuildError> {
        let kept =
            |entry: &walkdir::DirEntry| entry.depth() == 1 && entry.file_name() == ".htex-build";
        let mut files = Vec::new();
        for entry in WalkDir::new(self.folder).into_iter().filter_entry(|e| !kept(e)) {
            let entry = entry.reading(self.folder)?;
            if entry.file_type().is_file() {
                files.push(entry.into_path());
            }
        }
        let hashed = files.par_iter().map(|file| {
            let hashed = hash_local(file).reading(file)?;
            let inside = file.strip_prefix(self.folder).unwrap_or(file);
            Ok((crate::inputs::slashed(inside), hashed.blake3))
        });
        hashed.collect()
    }

    fn copy(&self, name: &str) -> Result<(), BuildError> {
        Ok(self.storage.write_file(&self.to.inside(name), &self.folder.join(name))?)
    }

    /// Removes files that an earlier build copied and this build has not made.
    fn remove_stale(
        &self,
        here: &BTreeMap<String, String>,
        there: &BTreeMap<String, Stamp>,
    ) -> Result<(), BuildError> {
        let before: BTreeSet<&String> = self.before.files.keys().collect();
        let stale = before.into_iter().filter(|name| !here.contains_key(*name));
        for name in stale.filter(|name| there.contains_key(*name)) {
            self.storage.remove(&self.to.inside(name))?;
        }
        Ok(())
    }

    /// Stores, for the next build, which files are now at the URI.
    fn keep(&self, here: BTreeMap<String, String>) -> Result<(), BuildError> {
        // The files are listed again, because each copy has a new version.
        let there = self.there()?;
        let files = here.into_iter().filter_map(|(name, blake3)| {
            let there = *there.get(&name)?;
            Some((name, CopiedFile { blake3, there }))
        });
        let published = PublishedFiles { to: self.to.to_string(), files: files.collect() };
        self.kept.put(PUBLISHED, &serde_json::to_vec(&published)?)
    }
}
