//! Reports of the checks of a device or a source.

use std::fmt::{self, Display};

use serde::{Serialize, Serializer};

/// All checks of one device or source.
pub type Report = htex_check_runner::Report<AdapterName>;

/// The device or source that was checked. In JSON its key is its kind.
#[derive(Debug, Clone, PartialEq)]
pub struct AdapterName {
    /// `device` or `source`.
    pub kind: &'static str,
    /// A file or an id.
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
