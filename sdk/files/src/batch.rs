//! Many files at once: each is whole or not there, as one that is written alone, and the disk is
//! waited for once for all of a group.
//!
//! A flush takes the disk some milliseconds: two for each file are minutes for 100,000. Files are
//! written beside their targets, then the file system is flushed (on Linux; elsewhere each file),
//! then all are renamed.

use std::collections::BTreeSet;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use tempfile::TempPath;

use crate::{Readers, Target, folder, sync_folder, unfinished};

/// Files of a group.
const GROUP: usize = 32_768;

/// Files that are being written. Dropping it before [`Self::finish`] removes those that are not in
/// their places yet.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let mut batch = htex_files::Batch::default();
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
    /// Writes a file, which is in its place after [`Self::finish`], or earlier.
    ///
    /// # Errors
    /// As [`crate::write_file`]; those of the files before it, whose group it ends.
    pub fn write(&mut self, path: &Path, bytes: &[u8]) -> io::Result<()> {
        self.write_to(Target::of(path, Readers::All)?, bytes)
    }

    /// As [`Self::write`], in the place of `path`, in which a link is replaced and not followed.
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
                self.folders.insert(folder(&path).to_owned());
                // Closed: a process has few open files.
                self.written.push((beside.into_temp_path(), path));
                written.inspect_err(|_| self.forget_last())?;
            }
        }
        if self.written.len() < GROUP { Ok(()) } else { self.keep() }
    }

    /// Puts the files in their places, and flushes that to disk.
    ///
    /// # Errors
    /// Those of the system; each file is then the old one, or whole.
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
            // Renamed while the set is locked: whoever ends the process has removed the file
            // before, or finds it complete.
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
