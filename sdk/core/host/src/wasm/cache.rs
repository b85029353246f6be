//! Compiled modules on disk.
//!
//! The name of a file in the cache contains the hashes of the module and of the engine. Each file
//! begins with a keyed hash of its name and its content. With this hash, the program recognises
//! files that are damaged, and files that another user wrote. [`WasmCache`] describes how the cache
//! is protected.
//!
//! The program runs the cached files as machine code. Therefore the program does not use a folder
//! that belongs to another user or to which other users may write. If a file has no keyed hash made
//! with this user's key ([`Key`]), the program compiles the module again.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use htex_base::files::{Key, private};
use wasmtime::{Engine, Module};

use crate::{WasmCache, folders};

/// Maximum number of files in the cache.
const MOST_FILES: usize = 64;
const HASH: usize = blake3::OUT_LEN;
const EXTENSION: &str = ".cwasm";
/// Name of the key file in the user's configuration folder.
const KEY: &str = "wasm.key";

/// A folder of compiled modules to which only this user can write, and the key of the files in it.
pub(super) struct Cache {
    folder: PathBuf,
    key: Key,
}

impl Cache {
    /// Opens the cache, and creates its folder and key if they do not exist. Returns `None` if the
    /// cache is off, if its folder belongs to another user, or if other users may write to the
    /// folder.
    pub(super) fn open(cache: &WasmCache) -> Option<Self> {
        let folder = match cache {
            WasmCache::User => folders::cache()?.join("wasm"),
            WasmCache::Dir(folder) => folder.clone(),
            WasmCache::Off => return None,
        };
        private::folder(&folder).ok()?;
        let key = Key::load_or_create(&folders::config()?, KEY).ok()?;
        Some(Self { folder, key })
    }

    /// Returns the compiled module if its file exists and is authentic.
    pub(super) fn find(&self, engine: &Engine, module: &[u8]) -> Option<Module> {
        let name = name(engine, module);
        let bytes = std::fs::read(self.folder.join(&name)).ok()?;
        let (tag, artifact) = bytes.split_at_checked(HASH)?;
        // The tag also depends on the name, so that a file cannot be renamed to replace another
        // module.
        if self.key.tag(&name, artifact) != *<&[u8; HASH]>::try_from(tag).ok()? {
            return None;
        }
        // SAFETY: the artifact is the output of `serialize` for this module, because its tag was
        // made with a key that only this user can read. The engine refuses artifacts of other
        // versions and settings.
        unsafe { Module::deserialize(engine, artifact) }.ok()
    }

    /// Stores a compiled module: writes a temporary file and renames it.
    pub(super) fn keep(&self, engine: &Engine, module: &[u8], artifact: &[u8]) -> io::Result<()> {
        self.keep_as(&name(engine, module), artifact)
    }

    #[allow(
        clippy::disallowed_methods,
        reason = "a folder of this user that no other user may write to"
    )]
    fn keep_as(&self, name: &str, artifact: &[u8]) -> io::Result<()> {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let count = COUNT.fetch_add(1, Ordering::Relaxed);
        let file = self.folder.join(name);
        // The name is unique, so that several processes or threads can compile the same module at
        // the same time.
        let beside = file.with_extension(format!("{}-{count}.part", std::process::id()));
        let content = [&self.key.tag(name, artifact)[..], artifact].concat();
        let written =
            std::fs::write(&beside, content).and_then(|()| std::fs::rename(&beside, file));
        if written.is_err() {
            let _ = std::fs::remove_file(&beside);
        }
        forget_oldest(&self.folder)?;
        written
    }
}

fn name(engine: &Engine, module: &[u8]) -> String {
    // The hash may differ between versions of Rust. In this case modules are compiled again.
    let mut hasher = DefaultHasher::new();
    engine.precompile_compatibility_hash().hash(&mut hasher);
    let hash = blake3::hash(module).to_hex();
    format!("{hash}-{:016x}{EXTENSION}", hasher.finish())
}

/// Returns whether a file name has the form of [`name`].
fn is_own(name: &str) -> bool {
    let hex = |text: &str, len| text.len() == len && text.bytes().all(|c| c.is_ascii_hexdigit());
    name.strip_suffix(EXTENSION)
        .and_then(|name| name.split_once('-'))
        .is_some_and(|(module, engine)| hex(module, 2 * HASH) && hex(engine, 16))
}

/// Removes the oldest files until the cache has no more than [`MOST_FILES`]. Does not remove files
/// that do not belong to the cache.
#[allow(
    clippy::disallowed_methods,
    reason = "a folder of this user that no other user may write to"
)]
fn forget_oldest(folder: &Path) -> io::Result<()> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let is_file = entry.file_type()?.is_file();
        if is_file && entry.file_name().to_str().is_some_and(is_own) {
            files.push((entry.metadata()?.modified()?, entry.path()));
        }
    }
    files.sort();
    // The oldest files are those that were written first. Reading does not change the time of a
    // file, so modules in use are compiled again now and then.
    for (_, path) in files.iter().rev().skip(MOST_FILES) {
        std::fs::remove_file(path)?;
    }
    Ok(())
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;

    const MODULE: &[u8] = b"\0asm\x01\0\0\0";

    struct CacheFolders {
        dir: tempfile::TempDir,
        engine: Engine,
    }

    impl CacheFolders {
        fn new() -> Self {
            let (dir, engine) = (tempfile::tempdir().unwrap(), Engine::default());
            Self { dir, engine }
        }

        fn folder(&self) -> PathBuf {
            self.dir.path().join("wasm")
        }

        fn cache(&self) -> Option<Cache> {
            let folder = self.folder();
            private::folder(&folder).ok()?;
            let key = Key::load_or_create(&self.dir.path().join("config"), KEY).ok()?;
            Some(Cache { folder, key })
        }

        /// Returns whether the module is already in the cache, and then stores it.
        fn found(&self) -> bool {
            let cache = self.cache().unwrap();
            let found = cache.find(&self.engine, MODULE).is_some();
            let module = Module::new(&self.engine, MODULE).unwrap();
            let artifact = module.serialize().unwrap();
            cache.keep(&self.engine, MODULE, &artifact).unwrap();
            found
        }

        fn only_file(&self) -> PathBuf {
            let files: Vec<_> = std::fs::read_dir(self.folder()).unwrap().collect();
            assert_eq!(files.len(), 1, "one file, and none left beside it");
            files[0].as_ref().unwrap().path()
        }
    }

    #[test]
    fn a_module_is_kept_and_what_the_key_has_not_made_is_not_used() {
        let mut place = CacheFolders::new();
        assert!(!place.found());
        assert!(place.found());
        let file = place.only_file();
        let whole = std::fs::read(&file).unwrap();
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 1;
        let artifact = &whole[HASH..];
        let unkeyed = [blake3::hash(artifact).as_bytes(), artifact].concat();
        // An intact file, but under another module's name.
        let cache = place.cache().unwrap();
        let other = cache.key.tag("another", artifact);
        let renamed = [&other[..], artifact].concat();
        for damaged in [&flipped[..], &whole[..40], b"", &unkeyed, &renamed] {
            std::fs::write(&file, damaged).unwrap();
            assert!(!place.found());
            assert!(place.found(), "made again");
        }
        // A file of another user, who has a different key.
        std::fs::remove_dir_all(place.dir.path().join("config")).unwrap();
        assert!(!place.found());
        // An engine with other settings uses another file.
        place.engine = Engine::new(wasmtime::Config::new().consume_fuel(true)).unwrap();
        assert!(!place.found());
    }

    #[test]
    fn the_folder_does_not_grow_for_ever_and_only_its_own_files_go() {
        let place = CacheFolders::new();
        place.found();
        let first = place.only_file();
        let theirs = ["notes.txt", "model.cwasm", "1.cwasm"].map(|name| place.folder().join(name));
        let long_ago = std::time::SystemTime::UNIX_EPOCH;
        for path in theirs.iter().chain([&first]) {
            let open = std::fs::File::options().write(true).create(true).truncate(false).open(path);
            open.unwrap().set_modified(long_ago).unwrap();
        }
        let cache = place.cache().unwrap();
        for i in 0..MOST_FILES + 3 {
            let name = format!("{i:064x}-{i:016x}{EXTENSION}");
            cache.keep_as(&name, b"x").unwrap();
        }
        let left = std::fs::read_dir(place.folder()).unwrap().count();
        assert_eq!(left, MOST_FILES + theirs.len());
        assert!(!first.exists());
        assert!(theirs.iter().all(|path| path.exists()));
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_or_a_key_that_others_may_change_or_own_is_not_used() {
        use std::os::unix::fs::PermissionsExt;
        let place = CacheFolders::new();
        place.found();
        let set = |path: &Path, mode| {
            std::fs::set_permissions(path, PermissionsExt::from_mode(mode)).unwrap();
        };
        let mode = std::fs::metadata(place.folder()).unwrap().permissions();
        assert_eq!(mode.mode() & 0o777, 0o700);
        set(&place.folder(), 0o777);
        assert!(place.cache().is_none());
        set(&place.folder(), 0o700);
        let key = place.dir.path().join("config/wasm.key");
        set(&key, 0o644);
        assert!(place.cache().is_none());
        set(&key, 0o600);
        assert!(place.cache().is_some());
        // Only root can give the folder to another user.
        if std::os::unix::fs::chown(place.folder(), Some(12345), None).is_ok() {
            assert!(place.cache().is_none());
        }
    }
}
