//! Reports of the checks of a device.

use std::fmt::{self, Display};

use serde::Serialize;

pub type Report = htex_check_runner::Report<DeviceName>;

/// The device that was checked.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DeviceName {
    /// A file or an id.
    pub device: String,
}

impl Display for DeviceName {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.device)
    }
}
