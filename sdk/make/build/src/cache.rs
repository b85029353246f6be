//! The cache of job results. The cache finds the result of a job by the job's key. Entries are
//! authenticated ([`StateFolder`]). The cache does not use an entry that another user wrote, or
//! that a crash left incomplete. The job of such an entry runs again. Entries are not flushed to
//! disk one by one.
//!
//! An entry that no texture uses any more stays for the time [`UNUSED`]. A user can therefore try a
//! setting and undo the change without a new fit.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::Arc;
use std::time::{Duration, SystemTime};

use htex_base::files::AtFile;

use crate::BuildError;
use crate::job_result::JobResult;
use crate::state::{StateFolder, inside};

/// Name of the cache's folder, in the folder of stored data.
const MADE: &str = "made";
/// Largest size of an entry, bytes: an asset of 16 MiB, its sound, and its record.
const MOST_BYTES: u64 = 64 << 20;
/// How long an entry stays in the cache if no build uses it.
const UNUSED: Duration = Duration::from_secs(30 * 24 * 3600);
/// When an entry is used and its time is older than this, the time is renewed.
const RENEWED: Duration = Duration::from_secs(24 * 3600);

/// The cache of job results.
#[derive(Debug)]
pub(crate) struct Cache {
    kept: Arc<StateFolder>,
}

impl Cache {
    /// Opens the cache, and creates its folder if it is missing.
    pub(crate) fn open(kept: Arc<StateFolder>) -> Result<Self, BuildError> {
        let made = kept.own().make_folder(&inside(MADE));
        made.writing(kept.own().path().join(inside(MADE)))?;
        Ok(Self { kept })
    }

    /// Returns the result for a key; `None` if the result is missing or damaged, or comes from
    /// somebody else.
    pub(crate) fn get(&self, key: &str) -> Option<JobResult> {
        let bytes = self.kept.get(&name(key), MOST_BYTES)?;
        JobResult::from_bytes(key, &bytes).ok()
    }

    /// Returns whether there is a file for a key, even if it cannot be used.
    pub(crate) fn has_file(&self, key: &str) -> bool {
        let path = self.kept.own().entry_path(&inside(&name(key)));
        path.is_ok_and(|path| path.symlink_metadata().is_ok())
    }

    /// Stores the result for a key.
    pub(crate) fn put(&self, key: &str, made: &JobResult) -> Result<(), BuildError> {
        self.kept.put(&name(key), &made.to_bytes(key)?)
    }

    /// Retains the entries with these keys. Removes other entries if they were not used for
    /// [`UNUSED`], or all of them if `prune`. Files that are not entries stay.
    pub(crate) fn keep(&self, keys: &BTreeSet<&str>, prune: bool) -> Result<(), BuildError> {
        let (own, folder) = (self.kept.own(), inside(MADE));
        let shown = own.path().join(&folder);
        let now = SystemTime::now();
        for file in own.files(&folder).writing(&shown)? {
            let Some(key) = key_of(&file) else { continue };
            let path = own.path().join(&folder).join(&file);
            let modified = path.metadata().and_then(|is| is.modified());
            let age =
                // A time in the future counts as now.
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

/// Returns the key of an entry's file, or of the partial file that a killed build left.
fn key_of(file: &str) -> Option<&str> {
    let key = file.strip_suffix(".part").unwrap_or(file);
    let is_key = key.len() == 64 && key.bytes().all(|c| c.is_ascii_hexdigit());
    is_key.then_some(key)
}

/// Renews the time of an entry. If that fails, the entry is only removed earlier.
#[allow(clippy::disallowed_methods, reason = "changes only a time")]
fn renew(path: &Path, now: SystemTime) {
    let file = std::fs::File::options().write(true).open(path);
    let _ = file.and_then(|file| file.set_modified(now));
}
