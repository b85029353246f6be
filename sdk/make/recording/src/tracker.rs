//! The file of a tracker: an instrument that records the finger's motion while another instrument
//! records the texture.

use std::path::PathBuf;
use std::sync::Arc;

use crate::columns::map::ColumnMap;

/// A file with the finger's position or speed over time, in any format that recordings may have.
///
/// The recording and the tracker file must take their times from the same clock. If a file states a
/// sample rate but no times, its first sample is at 0 s. The reader cuts the recording to the time
/// that the tracker covers.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub struct Tracker {
    pub path: PathBuf,
    /// The content of the file. If it is `None`, the reader opens the file at `path`.
    pub bytes: Option<Arc<[u8]>>,
    /// Roles of the file's columns: time, x, y, speed. A column that is not in the map gets its
    /// role from its name.
    pub map: Option<ColumnMap>,
}

impl Tracker {
    /// Creates a tracker from the path of its file. The names of the file's columns decide their
    /// roles.
    #[must_use]
    pub fn new(path: impl Into<PathBuf>) -> Self {
        Self { path: path.into(), bytes: None, map: None }
    }

    /// Provides the content of the file. The reader then does not open `path`, and uses `path` only
    /// as the file's name.
    #[must_use]
    pub fn with_bytes(mut self, bytes: impl Into<Arc<[u8]>>) -> Self {
        self.bytes = Some(bytes.into());
        self
    }

    /// Sets the roles of the file's columns.
    #[must_use]
    pub fn with_map(mut self, map: impl Into<Option<ColumnMap>>) -> Self {
        self.map = map.into();
        self
    }
}
