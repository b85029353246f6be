//! The file of a tracker, which records the finger's motion beside a recording.

use std::path::PathBuf;
use std::sync::Arc;

use crate::columns::map::ColumnMap;

/// A file with the finger's position or speed over time, in any format that recordings may have.
///
/// Both files must take their times from the same clock. A recording without times begins at 0 s,
/// and so does a tracker file that states a sample rate but no times. The reader cuts the recording
/// to the time that the tracker covers.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Tracker {
    pub path: PathBuf,
    /// The bytes of the file. If absent, the file is read from the path.
    pub bytes: Option<Arc<[u8]>>,
    /// Roles of its columns: time, x, y, speed. Columns that are not in the map are assigned by
    /// their names.
    pub map: Option<ColumnMap>,
}

impl Tracker {
    /// Creates a tracker from the path of its file. The names of the file's columns decide their
    /// roles.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), bytes: None, map: None }
    }

    /// Provides the bytes of the file; the path is then only its name.
    #[must_use]
    pub fn with_bytes(mut self, bytes: impl Into<Arc<[u8]>>) -> Self {
        self.bytes = Some(bytes.into());
        self
    }

    /// Sets the roles of its columns.
    #[must_use]
    pub fn with_map(mut self, map: impl Into<Option<ColumnMap>>) -> Self {
        self.map = map.into();
        self
    }
}
