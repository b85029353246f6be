//! Compiled modules on disk.
//!
//! A file is named by the module's hash and the engine's, and begins with the hash of what follows:
//! damage is found before the engine sees it. The hash is no signature. See
//! [`WasmCache`] on who is trusted.

use std::hash::{DefaultHasher, Hash, Hasher};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU32, Ordering};

use wasmtime::{Engine, Module};

use crate::{WasmCache, folders};

/// Most files that are kept.
const MOST_FILES: usize = 64;
const HASH: usize = blake3::OUT_LEN;

/// The compiled module, and whether it was found in the cache.
pub(super) fn compiled(
    engine: &Engine,
    bytes: &[u8],
    cache: &WasmCache,
) -> Result<(Module, bool), String> {
    let file = folder(cache).map(|folder| folder.join(name(engine, bytes)));
    if let Some(module) = file.as_deref().and_then(|file| kept(engine, file)) {
        return Ok((module, true));
    }
    let module = Module::new(engine, bytes).map_err(|e| format!("no valid module: {e:#}"))?;
    if let (Some(file), Ok(artifact)) = (file, module.serialize()) {
        // Without a cache everything works, only slower.
        let _ = keep(&file, &artifact);
    }
    Ok((module, false))
}

fn name(engine: &Engine, bytes: &[u8]) -> String {
    let mut hasher = DefaultHasher::new();
    engine.precompile_compatibility_hash().hash(&mut hasher);
    format!(
        "{}-{:016x}.cwasm",
        blake3::hash(bytes).to_hex(),
        hasher.finish()
    )
}

/// A kept module, if its file is there and sound.
fn kept(engine: &Engine, file: &Path) -> Option<Module> {
    let bytes = std::fs::read(file).ok()?;
    let (hash, artifact) = bytes.split_at_checked(HASH)?;
    if blake3::hash(artifact).as_bytes() != hash {
        return None;
    }
    // SAFETY: the artifact is what `serialize` gave: `folder` answers only a folder that nobody
    // else may write to, and its hash says that it is whole. The engine itself refuses artifacts
    // of other versions and settings.
    unsafe { Module::deserialize(engine, artifact) }.ok()
}

/// Writes a file beside and renames it into place.
fn keep(file: &Path, artifact: &[u8]) -> io::Result<()> {
    static COUNT: AtomicU32 = AtomicU32::new(0);
    let count = COUNT.fetch_add(1, Ordering::Relaxed);
    let beside = file.with_extension(format!("{}-{count}.part", std::process::id()));
    let content = [blake3::hash(artifact).as_bytes(), artifact].concat();
    let written = std::fs::write(&beside, content).and_then(|()| std::fs::rename(&beside, file));
    if written.is_err() {
        let _ = std::fs::remove_file(&beside);
    }
    file.parent().map_or(Ok(()), forget_oldest)?;
    written
}

/// Removes the files written longest ago, so that the folder does not grow for ever.
fn forget_oldest(folder: &Path) -> io::Result<()> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        files.push((entry.metadata()?.modified()?, entry.path()));
    }
    files.sort();
    for (_, path) in files.iter().rev().skip(MOST_FILES) {
        std::fs::remove_file(path)?;
    }
    Ok(())
}

/// The folder, made if need be; `None` if there is none that this user alone may write to.
fn folder(cache: &WasmCache) -> Option<PathBuf> {
    let folder = match cache {
        WasmCache::User => folders::cache()?.join("wasm"),
        WasmCache::Dir(folder) => folder.clone(),
        WasmCache::Off => return None,
    };
    make_private(&folder).ok()?.then_some(folder)
}

#[cfg(unix)]
fn make_private(folder: &Path) -> io::Result<bool> {
    use std::os::unix::fs::{DirBuilderExt, PermissionsExt};
    std::fs::DirBuilder::new()
        .recursive(true)
        .mode(0o700)
        .create(folder)?;
    let permissions = std::fs::metadata(folder)?.permissions();
    if permissions.mode() & 0o022 != 0 {
        return Ok(false);
    }
    // Only the owner may do this, so it also tells whose folder it is.
    std::fs::set_permissions(folder, PermissionsExt::from_mode(0o700))?;
    Ok(true)
}

#[cfg(not(unix))]
fn make_private(folder: &Path) -> io::Result<bool> {
    // The user's own folders are the user's alone by inheritance.
    std::fs::create_dir_all(folder).map(|()| true)
}

#[cfg(test)]
mod tests {
    use super::*;

    const MODULE: &[u8] = b"\0asm\x01\0\0\0";

    /// Whether compiling found the module in the cache.
    fn found(engine: &Engine, folder: &Path) -> bool {
        let cache = WasmCache::Dir(folder.to_owned());
        compiled(engine, MODULE, &cache).unwrap().1
    }

    fn only_file(folder: &Path) -> PathBuf {
        let files: Vec<_> = std::fs::read_dir(folder).unwrap().collect();
        assert_eq!(files.len(), 1, "one file, and none left beside it");
        files[0].as_ref().unwrap().path()
    }

    #[test]
    fn a_module_is_compiled_once_and_damage_is_harmless() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("wasm");
        let engine = Engine::default();
        assert!(!found(&engine, &folder));
        assert!(found(&engine, &folder));
        let file = only_file(&folder);
        let whole = std::fs::read(&file).unwrap();
        let mut flipped = whole.clone();
        flipped[whole.len() / 2] ^= 1;
        let foreign = b"not ours";
        let foreign = [blake3::hash(foreign).as_bytes(), &foreign[..]].concat();
        for damaged in [&flipped[..], &whole[..40], b"", &foreign] {
            std::fs::write(&file, damaged).unwrap();
            assert!(!found(&engine, &folder));
            assert!(found(&engine, &folder), "made again");
        }
        // An engine of other settings has a file of its own.
        let other = Engine::new(wasmtime::Config::new().consume_fuel(true)).unwrap();
        assert!(!found(&other, &folder));
    }

    #[test]
    fn the_folder_does_not_grow_for_ever() {
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("wasm");
        found(&Engine::default(), &folder);
        let first = only_file(&folder);
        let long_ago = std::time::SystemTime::UNIX_EPOCH;
        let file = std::fs::File::options().write(true).open(&first).unwrap();
        file.set_modified(long_ago).unwrap();
        for i in 0..MOST_FILES + 3 {
            keep(&folder.join(format!("{i}.cwasm")), b"x").unwrap();
        }
        assert_eq!(std::fs::read_dir(&folder).unwrap().count(), MOST_FILES);
        assert!(!first.exists());
    }

    #[cfg(unix)]
    #[test]
    fn a_folder_that_others_may_write_to_is_not_used() {
        use std::os::unix::fs::PermissionsExt;
        let dir = tempfile::tempdir().unwrap();
        let folder = dir.path().join("wasm");
        let engine = Engine::default();
        found(&engine, &folder);
        let mode = |mode| std::fs::set_permissions(&folder, PermissionsExt::from_mode(mode));
        assert_eq!(
            std::fs::metadata(&folder).unwrap().permissions().mode() & 0o777,
            0o700
        );
        mode(0o777).unwrap();
        assert!(!found(&engine, &folder));
    }
}
