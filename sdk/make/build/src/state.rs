//! Data that a build stores for the next build, in the folder `.htex-build` inside the output
//! folder.
//!
//! A user may have received the output folder from somebody else. The `.htex-build` in this folder
//! could contain false fits, false hashes of files, or a false list of published files. Therefore
//! each file in `.htex-build` begins with a keyed hash of its name and content. Each user has a
//! separate key ([`htex_base::files::Key`]). A build ignores a file that has no valid hash, and
//! makes the file again. If there is no folder in which to store the user's key, this process uses
//! a temporary key.

use std::fs::File;
use std::path::{Path, PathBuf};
use std::sync::OnceLock;

use htex_base::files::{AtFile, FileError, Key, OwnFolder};

use crate::BuildError;

/// Name of the folder, in the folder of the results.
pub(crate) const STATE: &str = ".htex-build";
/// File name of the key, in the user's folder of settings.
const KEY: &str = "build.key";
/// Length of a tag, bytes.
const TAG: usize = 32;

/// The folder of stored data.
#[derive(Debug)]
pub(crate) struct StateFolder {
    own: OwnFolder,
    key: Key,
}

impl StateFolder {
    /// Returns the folder of stored data in the folder of the results.
    pub(crate) fn new(output: &Path) -> Result<Self, BuildError> {
        let folder = htex_base::native::folders::config();
        let key = folder.and_then(|folder| Key::load_or_create(&folder, KEY).ok());
        let key = match key {
            Some(key) => key,
            None => passing().writing(output)?,
        };
        Ok(Self { own: OwnFolder::new(output), key })
    }

    /// Creates the folder, and locks it for this build.
    pub(crate) fn claim(&self) -> Result<File, BuildError> {
        let folder = Path::new(STATE);
        let kept = self.own.path().join(STATE);
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

    /// Returns what this user stored under a name; `None` if there is nothing, or if it is damaged
    /// or comes from somebody else.
    pub(crate) fn get(&self, name: &str, most_bytes: u64) -> Option<Vec<u8>> {
        let most = most_bytes.saturating_add(TAG as u64);
        let mut bytes = self.own.read(&inside(name), most).ok()?;
        let tag: [u8; TAG] = bytes.first_chunk().copied()?;
        bytes.drain(..TAG);
        (self.key.tag(name, &bytes) == tag).then_some(bytes)
    }

    /// Stores bytes under a name.
    pub(crate) fn put(&self, name: &str, bytes: &[u8]) -> Result<(), BuildError> {
        let tagged = [&self.key.tag(name, bytes)[..], bytes].concat();
        let written = self.own.write(&inside(name), &tagged);
        Ok(written.writing(self.own.path().join(inside(name)))?)
    }

    /// Returns the folder of the results, in which no link is followed.
    pub(crate) fn own(&self) -> &OwnFolder {
        &self.own
    }
}

/// Returns the path of a stored file, in the folder of the results.
pub(crate) fn inside(name: &str) -> PathBuf {
    Path::new(STATE).join(name)
}

/// Returns a temporary key that all builds of this process share.
fn passing() -> std::io::Result<Key> {
    static PASSING: OnceLock<Option<Key>> = OnceLock::new();
    let passing = PASSING.get_or_init(|| Key::passing().ok());
    let none = || std::io::Error::other("the system gives no random numbers");
    passing.clone().ok_or_else(none)
}
