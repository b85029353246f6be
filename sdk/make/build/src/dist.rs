//! The folder of a build's results. A file is written under a temporary name and then renamed. A
//! file is not written again if it already has the same bytes. Its modification time therefore
//! remains the time when its contents last changed. Links in the folder are not followed
//! ([`OwnFolder`]).

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use htex_base::files::{AtFile, OwnFolder};

use crate::BuildError;
use crate::state::inside;

/// Name of the folder for files that are being written, in the folder of stored data.
const PARTS: &str = "parts";

/// The folder of a build's results. Files in it are named by their relative paths.
#[derive(Debug)]
pub(crate) struct Dist {
    own: OwnFolder,
    /// Number of files that were written.
    written: AtomicU64,
}

impl Dist {
    pub(crate) fn new(folder: &Path) -> Self {
        Self { own: OwnFolder::new(folder), written: AtomicU64::new(0) }
    }

    /// Returns the path of a texture's file.
    pub(crate) fn texture(name: &str) -> PathBuf {
        Path::new("textures").join(format!("{name}.htex"))
    }

    /// Returns the path of a texture's sound.
    pub(crate) fn sound(name: &str) -> PathBuf {
        Path::new("sounds").join(format!("{name}.wav"))
    }

    /// Returns the path of a file, for code that writes the file without [`Self::put`]. None of the
    /// folders above the file is a link.
    pub(crate) fn path_of(&self, file: &Path) -> Result<PathBuf, BuildError> {
        let at = self.own.entry_path(file);
        Ok(at.writing(self.own.path().join(file))?)
    }

    /// Reads a file of at most `most_bytes`; `None` if it cannot be read.
    pub(crate) fn get(&self, file: &Path, most_bytes: u64) -> Option<Vec<u8>> {
        self.own.read(file, most_bytes).ok()
    }

    /// Writes a file and creates the folders above it, unless the file already has these bytes.
    pub(crate) fn put(&self, file: &Path, bytes: &[u8]) -> Result<(), BuildError> {
        // A longer file is not read to its end, because it differs anyway.
        let there = self.own.read(file, bytes.len() as u64);
        if there.is_ok_and(|there| there == bytes) {
            return Ok(());
        }
        let number = self.written.fetch_add(1, Ordering::Relaxed);
        let part = inside(PARTS).join(format!("{}-{number}", std::process::id()));
        let written = self.own.write_by(&part, file, bytes);
        Ok(written.writing(self.own.path().join(file))?)
    }

    /// Moves a file that was written in the folder of parts to its place.
    pub(crate) fn rename(&self, part: &Path, file: &Path) -> Result<(), BuildError> {
        let renamed = self.own.rename(part, file);
        Ok(renamed.writing(self.own.path().join(file))?)
    }

    /// Removes a file of an earlier build, and the folders that become empty.
    pub(crate) fn remove(&self, file: &Path) -> Result<(), BuildError> {
        let removed = self.own.remove(file);
        Ok(removed.writing(self.own.path().join(file))?)
    }

    /// Removes what a killed build left in the folder of parts, and returns the folder.
    pub(crate) fn empty_parts(&self) -> Result<PathBuf, BuildError> {
        let parts = inside(PARTS);
        let emptied = self.own.remove_folder(&parts);
        let made = emptied.and_then(|()| self.own.make_folder(&parts));
        made.writing(self.own.path().join(&parts))?;
        Ok(parts)
    }
}
