//! The folder of what was made, by key. Entries are authenticated ([`Kept`]), so that one of
//! somebody else, or one that a crash left incomplete, is made again; they are not flushed to disk
//! one by one.
//!
//! An entry that no texture uses any more stays for [`UNUSED`]: a setting that is tried and taken
//! back fits nothing again.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use htex_files::AtFile;

use crate::BuildError;
use crate::kept::{Kept, inside};
use crate::made::{Made, Outcome};

/// The folder, in that of what is kept.
const MADE: &str = "made";
/// Most bytes of an entry: an asset of 16 MiB, its sound, and what is known of it.
const MOST_BYTES: u64 = 64 << 20;
/// How long an entry stays that no build has used.
const UNUSED: Duration = Duration::from_secs(30 * 24 * 3600);
/// An entry's time is renewed when it is used and older than this.
const RENEWED: Duration = Duration::from_secs(24 * 3600);

/// The folder of what was made.
#[derive(Debug)]
pub(crate) struct Cache {
    kept: Arc<Kept>,
}

impl Cache {
    /// Opens the folder, and creates it if there is none.
    pub(crate) fn open(kept: Arc<Kept>) -> Result<Self, BuildError> {
        let made = kept.own().make_folder(&inside(MADE));
        made.writing(kept.own().path().join(inside(MADE)))?;
        Ok(Self { kept })
    }

    /// Returns what was made for a key; `None` if nothing was, or if it is damaged or somebody
    /// else's.
    pub(crate) fn get(&self, key: &str) -> Option<Made> {
        let bytes = self.kept.get(&name(key), MOST_BYTES)?;
        Made::from_bytes(key, &bytes).ok()
    }

    /// Whether something was made for a key. One that is there and cannot be used is not.
    pub(crate) fn has_file(&self, key: &str) -> bool {
        let path = self.kept.own().at(&inside(&name(key)));
        path.is_ok_and(|path| path.symlink_metadata().is_ok())
    }

    /// Keeps what was made for a key. A refusal is not kept: what caused it may be gone the next
    /// time.
    pub(crate) fn put(&self, key: &str, made: &Made) -> Result<(), BuildError> {
        if matches!(made.record.outcome, Outcome::Refused(_)) {
            return Ok(());
        }
        self.kept.put(&name(key), &made.to_bytes(key)?)
    }

    /// Keeps the entries of these keys, and removes others: those that were not used for
    /// [`UNUSED`], or all if `prune`. Files that are no entries stay.
    pub(crate) fn keep(&self, keys: &BTreeSet<&str>, prune: bool) -> Result<(), BuildError> {
        let (own, folder) = (self.kept.own(), inside(MADE));
        let shown = own.path().join(&folder);
        let now = SystemTime::now();
        for file in own.files(&folder).writing(&shown)? {
            let Some(key) = key_of(&file) else { continue };
            let path = own.path().join(&folder).join(&file);
            let modified = path.metadata().and_then(|is| is.modified());
            let age =
                modified.map_or(Duration::MAX, |then| now.duration_since(then).unwrap_or_default());
            let is_part = file.len() > key.len();
            if keys.contains(key) && !is_part {
                if age > RENEWED {
                    renew(&path, now);
                }
            } else if is_part || prune || age > UNUSED {
                own.remove(&folder.join(&file)).writing(&shown)?;
            }
        }
        Ok(())
    }
}

fn name(key: &str) -> String {
    format!("{MADE}/{key}")
}

/// The key of an entry's file, or of its part that a killed build left.
fn key_of(file: &str) -> Option<&str> {
    let key = file.strip_suffix(".part").unwrap_or(file);
    let is_key = key.len() == 64 && key.bytes().all(|c| c.is_ascii_hexdigit());
    is_key.then_some(key)
}

/// Renews the time of an entry; without it, the entry goes earlier.
#[allow(clippy::disallowed_methods, reason = "changes only a time")]
fn renew(path: &Path, now: SystemTime) {
    let file = std::fs::File::options().write(true).open(path);
    let _ = file.and_then(|file| file.set_modified(now));
}
