//! Writes many files at once. Each file is written completely or not at all. To save time, the
//! files are flushed to disk in large groups instead of one by one.
//!
//! A flush takes the disk some milliseconds. With two flushes per file, 100,000 files would take
//! minutes. Instead, the program first writes all files of a group under temporary names in the
//! folders of their targets. Then, on Linux, it flushes the whole file system once; on other
//! systems it flushes each file. At the end it renames all files to their targets.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::files::{Readers, Target, folder, sync_folder, unfinished};

/// Number of files in a group.
const GROUP: usize = 32_768;

/// A batch of files that are being written. If a batch is dropped before [`Self::finish`], it
/// removes the files that were not yet renamed to their targets.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let mut batch = htex_base::files::Batch::default();
/// for name in ["a", "b"] {
///     batch.write(&folder.path().join(name), name.as_bytes())?;
/// }
/// batch.finish()?;
/// assert_eq!(std::fs::read(folder.path().join("b"))?, b"b");
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Debug, Default)]
pub struct Batch {
    written: Vec<(TempPath, PathBuf)>,
    folders: BTreeSet<PathBuf>,
}

impl Batch {
    /// Writes a file. The file appears at `path` when [`Self::finish`] returns, or earlier.
    ///
    /// # Errors
    /// Returns the errors of [`crate::files::write_file`]. If this file completes a group, the call
    /// also returns errors of earlier files in the group.
    pub fn write(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.write_to(Target::new(path)?, bytes)
    }

    /// Writes a file as [`Self::write`] does, but replaces a link at `path` instead of following
    /// it.
    pub(crate) fn write_in_place_of(
        &mut self,
        path: PathBuf,
        readable_by: Readers,
        bytes: &[u8],
    ) -> io::Result<()> {
        self.write_to(Target::in_place_of(path, readable_by)?, bytes)
    }

    fn write_to(&mut self, target: Target, bytes: &[u8]) -> io::Result<()> {
        match target {
            Target::Direct(mut file) => file.write_all(bytes)?,
            Target::Beside(mut beside, path) => {
                let written = beside.write_all(bytes);
                // The folder is recorded even if the write failed, because other files of this
                // folder may be in the group.
                self.folders.insert(folder(&path).to_owned());
                // The file is closed, because a process may only have a few open files.
                self.written.push((beside.into_temp_path(), path));
                written.inspect_err(|_| self.forget_last())?;
            }
        }
        if self.written.len() < GROUP { Ok(()) } else { self.keep() }
    }

    /// Flushes the files to disk, renames them to their targets, and flushes the folders.
    ///
    /// # Errors
    /// Errors of the system. After an error, each target is either the old file or the complete new
    /// file.
    pub fn finish(mut self) -> io::Result<()> {
        self.keep()
    }

    fn forget_last(&mut self) {
        if let Some((beside, _)) = self.written.pop() {
            unfinished(|all| all.remove(&*beside));
        }
    }

    fn keep(&mut self) -> io::Result<()> {
        flush(&self.written, &self.folders)?;
        for (mut beside, path) in self.written.drain(..) {
            // The file is renamed while the set is locked. So a signal handler that ends the
            // process either removed the file before, or finds it complete.
            unfinished(|all| {
                std::fs::rename(&beside, &path)?;
                all.remove(&*beside);
                Ok::<(), io::Error>(())
            })?;
            beside.disable_cleanup(true);
        }
        std::mem::take(&mut self.folders).iter().try_for_each(|folder| sync_folder(folder))
    }
}

impl Drop for Batch {
    fn drop(&mut self) {
        unfinished(|all| {
            for (beside, _) in &self.written {
                all.remove(&**beside);
            }
        });
    }
}

/// Flushes the contents of files to disk.
#[cfg(target_os = "linux")]
fn flush(_: &[(TempPath, PathBuf)], folders: &BTreeSet<PathBuf>) -> io::Result<()> {
    use std::os::linux::fs::MetadataExt;
    let mut systems = BTreeSet::new();
    for folder in folders {
        let folder = std::fs::File::open(folder)?;
        // `syncfs` flushes a whole file system, so one call is enough for all folders on it.
        if systems.insert(folder.metadata()?.st_dev()) {
            rustix::fs::syncfs(&folder)?;
        }
    }
    Ok(())
}

#[cfg(not(target_os = "linux"))]
fn flush(written: &[(TempPath, PathBuf)], _: &BTreeSet<PathBuf>) -> io::Result<()> {
    written
        .iter()
        .try_for_each(|(beside, _)| std::fs::File::options().write(true).open(beside)?.sync_all())
}
