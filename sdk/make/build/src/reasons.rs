//! Explains why a texture has to be fitted. To find the reason, this module compares the current
//! inputs of the fit with the inputs in the last finished build.

use std::collections::BTreeMap;
use std::fmt;

use serde::{Deserialize, Serialize};

use crate::BuildError;
use crate::cache::Cache;
use crate::job::Job;
use crate::state::StateFolder;

/// File that lists what the fits of the last build depended on, in the folder of stored data.
const FILE: &str = "fits.json";
/// Largest size of that file, bytes: a few million textures.
const MOST_BYTES: u64 = 1 << 30;

/// The reason why a texture has to be fitted.
#[derive(Debug, Clone, PartialEq, Eq)]
#[non_exhaustive]
pub enum Why {
    /// In this folder, no build of this user has fitted the texture yet.
    New,
    /// Inputs of the fit have changed. The list contains the names of the changed inputs. The
    /// possible names, in this order, are `recordings`, `reading`, `options`, `plugins` and
    /// `program`.
    Changed(Vec<&'static str>),
    /// The stored result is damaged, or belongs to another user.
    Unusable,
    /// The stored result has been removed.
    Gone,
}

impl fmt::Display for Why {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::New => f.write_str("new"),
            Self::Changed(what) => write!(f, "changed: {}", what.join(", ")),
            Self::Unusable => f.write_str("what was made is damaged, or was not made by this user"),
            Self::Gone => f.write_str("what was made is gone"),
        }
    }
}

/// What the fits of a build depend on, by texture: a hash for each part.
#[derive(Debug, Default, Serialize, Deserialize)]
pub(crate) struct Reasons(BTreeMap<String, Vec<String>>);

impl Reasons {
    pub(crate) fn new<'a>(jobs: impl Iterator<Item = &'a Job>) -> Self {
        let hashes = |job: &Job| job.parts().map(|(_, hash)| hash).to_vec();
        Self(jobs.map(|job| (job.texture.clone(), hashes(job))).collect())
    }

    /// Reads the dependencies of the last finished build.
    pub(crate) fn open(kept: &StateFolder) -> Self {
        let bytes = kept.get(FILE, MOST_BYTES);
        let read = bytes.and_then(|bytes| serde_json::from_slice(&bytes).ok());
        read.unwrap_or_default()
    }

    pub(crate) fn keep(&self, kept: &StateFolder) -> Result<(), BuildError> {
        kept.put(FILE, &serde_json::to_vec(self)?)
    }

    /// Returns why a job with this key has to be done.
    pub(crate) fn why(&self, job: &Job, key: &str, cache: &Cache) -> Why {
        if cache.has_file(key) {
            return Why::Unusable;
        }
        let Some(before) = self.0.get(&job.texture) else {
            return Why::New;
        };
        let parts = job.parts();
        let changed = parts.iter().zip(before).filter(|((_, now), before)| now != *before);
        let names: Vec<&'static str> = changed.map(|((name, _), _)| *name).collect();
        if names.is_empty() { Why::Gone } else { Why::Changed(names) }
    }
}
