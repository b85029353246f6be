//! The key that authenticates this user's compiled modules.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;

use super::private;

/// A secret key of this user.
pub(super) struct Key([u8; blake3::KEY_LEN]);

impl Key {
    /// Reads the key in a folder; creates a random one if there is none.
    pub(super) fn of(folder: &Path) -> io::Result<Self> {
        private::folder(folder)?;
        let path = folder.join("wasm.key");
        if !path.try_exists()? {
            make(folder, &path)?;
        }
        let mut key = [0; blake3::KEY_LEN];
        private::file(&path)?.read_exact(&mut key)?;
        Ok(Self(key))
    }

    /// Returns the keyed hash of a file's name and content.
    pub(super) fn tag(&self, name: &str, content: &[u8]) -> [u8; blake3::OUT_LEN] {
        let mut hasher = blake3::Hasher::new_keyed(&self.0);
        hasher.update(&(name.len() as u64).to_le_bytes());
        hasher.update(name.as_bytes());
        hasher.update(content);
        *hasher.finalize().as_bytes()
    }
}

/// Writes a new key to a temporary file and links it to its path, unless another process has created one.
fn make(folder: &Path, path: &Path) -> io::Result<()> {
    let mut key = [0; blake3::KEY_LEN];
    getrandom::fill(&mut key).map_err(io::Error::other)?;
    let beside = folder.join(format!("wasm.key.{}.part", std::process::id()));
    let mut options = File::options();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    let written = options
        .open(&beside)
        .and_then(|mut file| file.write_all(&key))
        .and_then(|()| std::fs::hard_link(&beside, path));
    let removed = std::fs::remove_file(&beside);
    match written {
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => Err(error),
        _ => removed,
    }
}
