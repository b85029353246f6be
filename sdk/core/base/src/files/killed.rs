//! Removes the unfinished files of killed processes. A killed process cannot remove its own files.
//!
//! The name of an unfinished file identifies its process: `.htex-MACHINE-PID-RANDOM.part`.
//! `MACHINE` is a hash that distinguishes this system's process numbers from other systems'
//! numbers. A folder may be shared with other machines and containers, whose processes this process
//! cannot see. So this process removes unfinished files of other machines only when the files are
//! old.

use std::collections::BTreeSet;
use std::fs::Metadata;
use std::path::{Path, PathBuf};
use std::sync::{LazyLock, Mutex, PoisonError};
use std::time::Duration;

/// Start and end of the name of an unfinished file.
pub(crate) const BEGINNING: &str = ".htex-";
pub(crate) const ENDING: &str = ".part";
/// Age from which an unfinished file counts as old. Even the longest commands write at least once
/// an hour, so a file that has not changed for this long belongs to no running process.
const OLD: Duration = Duration::from_secs(2 * 24 * 3600);

/// Folders that this process has already searched.
static DONE: Mutex<BTreeSet<PathBuf>> = Mutex::new(BTreeSet::new());

/// Start of the names of this process's unfinished files.
pub(crate) static OWN: LazyLock<String> =
    LazyLock::new(|| format!("{BEGINNING}{}-{}-", *MACHINE, std::process::id()));

static MACHINE: LazyLock<String> = LazyLock::new(|| {
    // A process number is valid only until the next start of the system, and only inside one
    // namespace. Each container has its own namespace.
    let boot = std::fs::read("/proc/sys/kernel/random/boot_id").unwrap_or_default();
    let space = std::fs::read_link("/proc/self/ns/pid").unwrap_or_default();
    let bytes = boot.iter().chain(space.as_os_str().as_encoded_bytes());
    // FNV-1a. A simple hash suffices, because nobody gains anything from a collision.
    let hash = bytes.fold(0xcbf2_9ce4_8422_2325_u64, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0100_0000_01b3)
    });
    format!("{hash:016x}")
});

/// Removes unfinished files in a folder if their process has ended or they are old. `own` describes
/// a file of this process in the same folder; only files with the same owner are removed. Only the
/// first call for each folder has an effect. A file that cannot be removed is not an error.
pub(crate) fn remove_from(folder: &Path, own: &Metadata) {
    let mut done = DONE.lock().unwrap_or_else(PoisonError::into_inner);
    // Listing a folder of 100,000 files for every file that is written would take far longer than
    // the writing.
    if !done.insert(folder.to_owned()) {
        return;
    }
    drop(done);
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    for entry in entries {
        let name = entry.file_name();
        let Some(name) = name.to_str().and_then(inner_name) else {
            continue;
        };
        // Metadata of the entry itself: a link is not followed.
        let Ok(is) = entry.metadata() else { continue };
        if is.is_file() && is_of_one_owner(&is, own) && (is_of_dead(name) || is_old(&is)) {
            let _ = std::fs::remove_file(entry.path());
        }
    }
}

/// Returns the part of an unfinished file's name between its start and its end.
fn inner_name(name: &str) -> Option<&str> {
    name.strip_prefix(BEGINNING)?.strip_suffix(ENDING)
}

/// Returns whether the process in the name belongs to this system and has ended.
fn is_of_dead(name: &str) -> bool {
    let mut parts = name.split('-');
    let (machine, process) = (parts.next(), parts.next());
    let process = process.and_then(|process| process.parse::<u32>().ok());
    let (true, Some(process)) = (machine == Some(&MACHINE[..]), process) else {
        return false;
    };
    // Without `/proc`, this process cannot see other processes, so no process counts as ended.
    let processes = Path::new("/proc");
    processes.join("self").exists() && !processes.join(process.to_string()).exists()
}

fn is_old(is: &Metadata) -> bool {
    let age = is.modified().ok().and_then(|time| time.elapsed().ok());
    age.is_some_and(|age| age > OLD)
}

#[cfg(unix)]
fn is_of_one_owner(a: &Metadata, b: &Metadata) -> bool {
    use std::os::unix::fs::MetadataExt;
    a.uid() == b.uid()
}

#[cfg(not(unix))]
fn is_of_one_owner(_: &Metadata, _: &Metadata) -> bool {
    true
}

#[cfg(all(test, target_os = "linux"))]
mod tests {
    use super::*;
    use std::fs;

    /// The next write to a folder removes what a killed process left there. Files in use, files of
    /// other systems and other kinds of files stay.
    #[test]
    fn unfinished_files_of_ended_processes_are_removed() -> Result<(), Box<dyn std::error::Error>> {
        let folder = tempfile::tempdir()?;
        let mut ended = std::process::Command::new("true").spawn()?;
        ended.wait()?;
        let of = |machine: &str, process: u32| format!(".htex-{machine}-{process}-aB3xYz.part");
        let (other, here) = ("0".repeat(16), &MACHINE[..]);
        let dead = of(here, ended.id());
        let old = of(&other, 1);
        let stay = [
            of(here, std::process::id()),
            of(here, 1),
            of(&other, ended.id()),
            format!(".htex-{here}-{}-notes.txt", ended.id()),
            "vinyl.part".to_owned(),
        ];
        for name in stay.iter().chain([&dead, &old]) {
            fs::write(folder.path().join(name), "half")?;
        }
        let long_ago = std::time::SystemTime::now() - 2 * OLD;
        fs::File::open(folder.path().join(&old))?.set_modified(long_ago)?;
        fs::create_dir(folder.path().join(of(here, ended.id() ^ 1 << 30)))?;
        let target = folder.path().join("target");
        fs::write(&target, "mine")?;
        let link = folder.path().join(format!(".htex-{here}-{}-x.part", ended.id()));
        std::os::unix::fs::symlink(&target, &link)?;

        crate::files::write_file(&folder.path().join("a.htex"), b"whole")?;
        assert!(!folder.path().join(&dead).exists() && !folder.path().join(&old).exists());
        for name in &stay {
            assert!(folder.path().join(name).exists(), "{name}");
        }
        assert_eq!(fs::read(&target)?, b"mine");
        assert!(link.symlink_metadata().is_ok());
        Ok(())
    }
}
