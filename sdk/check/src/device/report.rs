//! Reports of checking a device or a source.

use std::fmt::{self, Display};

use serde::{Serialize, Serializer};

/// The results of all checks of one device or source.
pub type Report = crate::harness::Report<AdapterName>;

/// The device or source that was checked. In JSON, the key is its kind.
#[derive(Debug, Clone, PartialEq)]
pub struct AdapterName {
    /// `device` or `source`.
    pub kind: &'static str,
    /// The library's file, or an id.
    pub name: String,
}

impl Serialize for AdapterName {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map([(self.kind, &self.name)])
    }
}

impl Display for AdapterName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.name)
    }
}
