//! The folder of what was made, by key. Entries carry a hash, so that one that a crash left incomplete is made again; they are
//! not flushed to disk one by one.

use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use htex_files::AtFile;

use crate::BuildError;
use crate::made::{Made, Outcome};

/// Ending of a file that is being written.
const PART: &str = ".part";

/// The folder of what was made.
#[derive(Debug)]
pub(crate) struct Cache {
    folder: PathBuf,
}

impl Cache {
    /// Opens the folder, creates it if there is none, and removes what a killed build left.
    pub(crate) fn open(folder: &Path) -> Result<Self, BuildError> {
        fs::create_dir_all(folder).writing(folder)?;
        let cache = Self {
            folder: folder.to_owned(),
        };
        cache.remove(|name| name.ends_with(PART))?;
        Ok(cache)
    }

    /// Returns what was made for a key; `None` if nothing was, or if it is damaged.
    pub(crate) fn get(&self, key: &str) -> Option<Made> {
        let bytes = fs::read(self.folder.join(key)).ok()?;
        Made::from_bytes(key, &bytes).ok()
    }

    /// Keeps what was made for a key. A refusal is not kept: what caused it may be gone the next time.
    pub(crate) fn put(&self, key: &str, made: &Made) -> Result<(), BuildError> {
        if matches!(made.record.outcome, Outcome::Refused(_)) {
            return Ok(());
        }
        let (part, file) = (
            self.folder.join(format!("{key}{PART}")),
            self.folder.join(key),
        );
        let bytes = made.to_bytes(key)?;
        let write = |_| fs::write(&part, bytes).and_then(|()| fs::rename(&part, &file));
        Ok(Ok(()).and_then(write).writing(&file)?)
    }

    /// Removes everything but the entries of these keys.
    pub(crate) fn keep(&self, keys: &BTreeSet<&str>) -> Result<(), BuildError> {
        self.remove(|name| !keys.contains(name))
    }

    fn remove(&self, unwanted: impl Fn(&str) -> bool) -> Result<(), BuildError> {
        let remove = || -> io::Result<()> {
            for entry in fs::read_dir(&self.folder)? {
                let entry = entry?;
                if unwanted(&entry.file_name().to_string_lossy()) {
                    fs::remove_file(entry.path())?;
                }
            }
            Ok(())
        };
        Ok(remove().writing(&self.folder)?)
    }
}
