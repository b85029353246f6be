//! The folder of a build's results. A file is written to a new one and renamed; one that is there
//! with the same bytes is left alone, so that its time says when it changed. Links in the folder
//! are not followed ([`OwnFolder`]).

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};

use htex_files::{AtFile, OwnFolder};

use crate::BuildError;
use crate::kept::inside;

/// The folder of files that are being written, in that of what is kept.
const PARTS: &str = "parts";

/// The folder of a build's results. Its files are named by their paths in it.
#[derive(Debug)]
pub(crate) struct Dist {
    own: OwnFolder,
    /// Files that were written.
    written: AtomicU64,
}

impl Dist {
    pub(crate) fn new(folder: &Path) -> Self {
        Self { own: OwnFolder::new(folder), written: AtomicU64::new(0) }
    }

    /// Returns the file of a texture.
    pub(crate) fn texture(name: &str) -> PathBuf {
        Path::new("textures").join(format!("{name}.htex"))
    }

    /// Returns the file of a texture's sound.
    pub(crate) fn sound(name: &str) -> PathBuf {
        Path::new("sounds").join(format!("{name}.wav"))
    }

    /// Returns the path of a file for what is not written by [`Self::put`]; nothing above it is a
    /// link.
    pub(crate) fn at(&self, file: &Path) -> Result<PathBuf, BuildError> {
        let at = self.own.at(file);
        Ok(at.writing(self.own.path().join(file))?)
    }

    /// Reads a file of at most `most_bytes`; `None` if it cannot be read.
    pub(crate) fn get(&self, file: &Path, most_bytes: u64) -> Option<Vec<u8>> {
        self.own.read(file, most_bytes).ok()
    }

    /// Writes a file, and the folders above it, unless it holds these bytes.
    pub(crate) fn put(&self, file: &Path, bytes: &[u8]) -> Result<(), BuildError> {
        let there = self.own.read(file, bytes.len() as u64);
        if there.is_ok_and(|there| there == bytes) {
            return Ok(());
        }
        let number = self.written.fetch_add(1, Ordering::Relaxed);
        let part = inside(PARTS).join(format!("{}-{number}", std::process::id()));
        let written = self.own.write_by(&part, file, bytes);
        Ok(written.writing(self.own.path().join(file))?)
    }

    /// Puts a file that was written in the folder of parts in its place.
    pub(crate) fn rename(&self, part: &Path, file: &Path) -> Result<(), BuildError> {
        let renamed = self.own.rename(part, file);
        Ok(renamed.writing(self.own.path().join(file))?)
    }

    /// Removes a file of an earlier build, and the folders that it leaves empty.
    pub(crate) fn remove(&self, file: &Path) -> Result<(), BuildError> {
        let removed = self.own.remove(file);
        Ok(removed.writing(self.own.path().join(file))?)
    }

    /// Empties the folder of parts of what a killed build left, and returns it.
    pub(crate) fn empty_parts(&self) -> Result<PathBuf, BuildError> {
        let parts = inside(PARTS);
        let emptied = self.own.remove_folder(&parts);
        let made = emptied.and_then(|()| self.own.make_folder(&parts));
        made.writing(self.own.path().join(&parts))?;
        Ok(parts)
    }
}
