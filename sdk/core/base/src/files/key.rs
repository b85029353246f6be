//! Keys that authenticate the stored data of this user's programs: compiled modules and fits.

use std::fs::File;
use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::atomic::{AtomicU32, Ordering};

use crate::files::private;

/// A secret key of this user.
///
/// Other users may be able to write to the folder of the stored data. Therefore each stored file
/// begins with a keyed hash of its name and content. Programs use only files whose hash was made
/// with this user's key.
///
/// ```
/// let folder = tempfile::tempdir()?;
/// let key = htex_base::files::Key::load_or_create(folder.path(), "wasm.key")?;
/// let tag = key.tag("module", b"content");
/// assert_eq!(htex_base::files::Key::load_or_create(folder.path(), "wasm.key")?.tag("module", b"content"), tag);
/// assert_ne!(key.tag("other", b"content"), tag);
/// # Ok::<(), std::io::Error>(())
/// ```
#[derive(Clone)]
pub struct Key([u8; blake3::KEY_LEN]);

impl Key {
    /// Reads the key with this name in a folder. Creates a random key if the folder has no key of
    /// this name.
    ///
    /// # Errors
    /// Returns an error if the folder or the file belongs to another user, or if others can write
    /// to the folder or access the file. Also returns errors of the system.
    pub fn load_or_create(folder: &Path, name: &str) -> io::Result<Self> {
        private::folder(folder)?;
        let path = folder.join(name);
        if !path.try_exists()? {
            make(folder, &path)?;
        }
        let mut key = [0; blake3::KEY_LEN];
        private::file(&path)?.read_exact(&mut key)?;
        Ok(Self(key))
    }

    /// Creates a temporary key for a user without a folder for keys. The key is not stored: it
    /// exists only in this value.
    ///
    /// # Errors
    /// Returns an error if the system provides no random numbers.
    pub fn passing() -> io::Result<Self> {
        Ok(Self(random_key()?))
    }

    /// Returns the keyed hash of a file's name and content.
    pub fn tag(&self, name: &str, content: &[u8]) -> [u8; blake3::OUT_LEN] {
        let mut hasher = blake3::Hasher::new_keyed(&self.0);
        // The length comes first, so that no other pair of name and content gives the same bytes.
        hasher.update(&(name.len() as u64).to_le_bytes());
        hasher.update(name.as_bytes());
        hasher.update(content);
        *hasher.finalize().as_bytes()
    }
}

/// Writes a new key to a temporary file and links it to its path, unless another process has
/// already created one.
fn make(folder: &Path, path: &Path) -> io::Result<()> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let key = random_key()?;
    let mut beside = path.as_os_str().to_owned();
    // The name is unique, so that processes and threads that create the same key do not collide.
    beside.push(format!(".{}-{count}.part", std::process::id()));
    let beside = folder.join(beside);
    let mut options = File::options();
    options.write(true).create_new(true);
    #[cfg(unix)]
    std::os::unix::fs::OpenOptionsExt::mode(&mut options, 0o600);
    // A hard link fails if the path exists. A rename would replace the key of another process, and
    // the tags of that process would then be refused.
    let written = options
        .open(&beside)
        .and_then(|mut file| file.write_all(&key))
        .and_then(|()| std::fs::hard_link(&beside, path));
    let removed = std::fs::remove_file(&beside);
    match written {
        // Another process was faster. Its key is read next.
        Err(error) if error.kind() != io::ErrorKind::AlreadyExists => Err(error),
        _ => removed,
    }
}

/// Returns 32 random bytes for a key.
///
/// # Errors
/// Returns an error if the system provides no random numbers.
pub fn random_key() -> io::Result<[u8; blake3::KEY_LEN]> {
    let mut key = [0; blake3::KEY_LEN];
    getrandom::fill(&mut key).map_err(io::Error::other)?;
    Ok(key)
}

impl std::fmt::Debug for Key {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Key(…)")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Eight threads create one key at the same moment. This can happen when an app runs for the
    /// first time and loads its textures in several threads.
    #[test]
    fn threads_that_create_a_key_get_the_same_one() {
        for _ in 0..200 {
            let folder = tempfile::tempdir().unwrap();
            let start = std::sync::Barrier::new(8);
            let load = || {
                start.wait();
                Key::load_or_create(folder.path(), "wasm.key").unwrap().tag("module", b"content")
            };
            let tags: Vec<_> = std::thread::scope(|scope| {
                let threads: Vec<_> = (0..8).map(|_| scope.spawn(load)).collect();
                threads.into_iter().map(|thread| thread.join().unwrap()).collect()
            });
            assert!(tags.iter().all(|tag| *tag == tags[0]));
            assert_eq!(
                std::fs::read_dir(folder.path()).unwrap().count(),
                1,
                "a temporary file is left"
            );
        }
    }
}
