//! The folder of a build's results. A file is written beside its target and renamed; one that is there with the same bytes is left
//! alone, so that its time says when it changed.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use htex_files::{AtFile, FileError};
use walkdir::WalkDir;

use crate::BuildError;

/// Ending of a file that is being written.
const PART: &str = "part";
/// Folder of files that are being written by others.
const PARTS: &str = ".htex-build/parts";

/// The folder of a build's results.
#[derive(Debug)]
pub(crate) struct Dist {
    folder: PathBuf,
}

impl Dist {
    pub(crate) fn new(folder: &Path) -> Self {
        Self {
            folder: folder.to_owned(),
        }
    }

    pub(crate) fn texture(&self, name: &str) -> PathBuf {
        self.folder.join("textures").join(format!("{name}.htex"))
    }

    /// Returns the file of a texture's sound.
    pub(crate) fn sound(&self, name: &str) -> PathBuf {
        self.folder.join("sounds").join(format!("{name}.wav"))
    }

    pub(crate) fn file(&self, name: &str) -> PathBuf {
        self.folder.join(name)
    }

    /// Writes a file, and the folders above it, unless it holds these bytes.
    pub(crate) fn put(&self, file: &Path, bytes: &[u8]) -> Result<(), BuildError> {
        if fs::read(file).is_ok_and(|there| there == bytes) {
            return Ok(());
        }
        let write = || -> io::Result<()> {
            if let Some(folder) = file.parent() {
                fs::create_dir_all(folder)?;
            }
            let mut part = file.as_os_str().to_owned();
            part.push(".");
            part.push(PART);
            fs::write(&part, bytes)?;
            fs::rename(&part, file)
        };
        Ok(write().writing(file)?)
    }

    /// Removes a file of an earlier build, and the folders that it leaves empty.
    pub(crate) fn remove(&self, file: &Path) -> Result<(), BuildError> {
        match fs::remove_file(file) {
            Err(error) if error.kind() != io::ErrorKind::NotFound => {
                return Err(FileError::writing(file, error).into());
            }
            _ => {}
        }
        let inside = file
            .ancestors()
            .skip(1)
            .take_while(|folder| *folder != self.folder);
        for folder in inside {
            // A folder with files in it stays.
            if fs::remove_dir(folder).is_err() {
                break;
            }
        }
        Ok(())
    }

    /// Returns an empty folder for files that are being written.
    pub(crate) fn parts(&self) -> Result<PathBuf, BuildError> {
        let folder = self.folder.join(PARTS);
        let make = || -> io::Result<()> {
            if folder.exists() {
                fs::remove_dir_all(&folder)?;
            }
            fs::create_dir_all(&folder)
        };
        make().writing(&folder)?;
        Ok(folder)
    }

    /// Removes what a killed build was writing.
    pub(crate) fn remove_parts(&self) -> Result<(), BuildError> {
        let is_part = |file: &Path| file.extension().is_some_and(|ending| ending == PART);
        for folder in ["textures", "sounds", "browser"] {
            let files = WalkDir::new(self.folder.join(folder)).into_iter().flatten();
            for entry in files.filter(|entry| is_part(entry.path())) {
                self.remove(entry.path())?;
            }
        }
        for name in ["index.html", "build-report.json"] {
            self.remove(&self.folder.join(format!("{name}.{PART}")))?;
        }
        Ok(())
    }
}
