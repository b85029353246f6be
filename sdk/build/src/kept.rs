//! What a build keeps for the next one: `.htex-build` in the folder of the results.
//!
//! The folder of the results may come from somebody else, with a `.htex-build` that says what a
//! recording's fit is, which files are known, or what was published. Each file in it begins with a
//! keyed hash of its name and content, by a key of this user ([`htex_files::Key`]): what this user
//! has not made is not used, and made again. A user without a folder for a key has one that ends
//! with the build.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use htex_files::{AtFile, FileError, Key, OwnFolder};

use crate::BuildError;

/// The folder, in that of the results.
pub(crate) const KEPT: &str = ".htex-build";
/// Name of the key's file, in the user's folder of settings.
const KEY: &str = "build.key";
/// Bytes of a tag.
const TAG: usize = 32;

/// The folder of what is kept.
#[derive(Debug)]
pub(crate) struct Kept {
    own: OwnFolder,
    key: Key,
}

impl Kept {
    /// The folder in that of the results.
    pub(crate) fn new(output: &Path) -> Result<Self, BuildError> {
        let folder = htex_native::folders::config();
        let key = folder.and_then(|folder| Key::of(&folder, KEY).ok());
        let key = match key {
            Some(key) => key,
            None => passing().writing(output)?,
        };
        Ok(Self { own: OwnFolder::new(output), key })
    }

    /// Makes the folder, and locks it for this build.
    pub(crate) fn claim(&self) -> Result<File, BuildError> {
        let folder = Path::new(KEPT);
        let kept = self.own.path().join(KEPT);
        self.own.make_folder(folder).writing(&kept)?;
        let lock = self.own.open_lock(&folder.join("lock"));
        let file = kept.join("lock");
        let lock = lock.writing(&file)?;
        match lock.try_lock() {
            Ok(()) => Ok(lock),
            Err(std::fs::TryLockError::WouldBlock) => {
                Err(BuildError::Locked { folder: self.own.path().to_owned() })
            }
            Err(std::fs::TryLockError::Error(error)) => {
                Err(FileError::writing(&file, error).into())
            }
        }
    }

    /// Returns what this user kept under a name; `None` if there is nothing, or if it is somebody
    /// else's or damaged.
    pub(crate) fn get(&self, name: &str, most_bytes: u64) -> Option<Vec<u8>> {
        let most = most_bytes.saturating_add(TAG as u64);
        let mut bytes = self.own.read(&inside(name), most).ok()?;
        let tag: [u8; TAG] = bytes.first_chunk().copied()?;
        bytes.drain(..TAG);
        (self.key.tag(name, &bytes) == tag).then_some(bytes)
    }

    /// Keeps bytes under a name.
    pub(crate) fn put(&self, name: &str, bytes: &[u8]) -> Result<(), BuildError> {
        let tagged = [&self.key.tag(name, bytes)[..], bytes].concat();
        let written = self.own.write(&inside(name), &tagged);
        Ok(written.writing(self.own.path().join(inside(name)))?)
    }

    /// The folder of the results, in which nothing is followed.
    pub(crate) fn own(&self) -> &OwnFolder {
        &self.own
    }
}

/// The path of a file that is kept, in the folder of the results.
pub(crate) fn inside(name: &str) -> PathBuf {
    Path::new(KEPT).join(name)
}

/// One key for all builds of this process.
fn passing() -> std::io::Result<Key> {
    static PASSING: OnceLock<Option<Key>> = OnceLock::new();
    let passing = PASSING.get_or_init(|| Key::passing().ok());
    let none = || std::io::Error::other("the system gives no random numbers");
    passing.clone().ok_or_else(none)
}
