//! Finds the driver's library: the installed one, or the one named by the setting `driver`.
#![allow(unsafe_code)] // A loader: the user asked to run the driver's initialisers.

use htex_base::native::{Library, LoadError};
use htex_device::DeviceError;

use super::table::{Table, TableError};

/// Names of the installed library, which are tried in turn.
#[cfg(windows)]
const NAMES: &[&str] = &["nicaiu.dll"];
#[cfg(not(windows))]
const NAMES: &[&str] = &["libnidaqmx.so.1", "libnidaqmx.so"];

/// Loads the library that the system's loader finds under NI-DAQmx's own names.
pub(super) fn installed() -> Result<Table, DeviceError> {
    let mut reasons = Vec::new();
    for name in NAMES {
        match of_system(name) {
            Ok(table) => return Ok(table),
            Err(reason) => reasons.push(reason.to_string()),
        }
    }
    Err(DeviceError::Missing(not_installed(&reasons.join("; "))))
}

/// Loads the library that a setting names. The setting is a path or a bare name. A bare name means
/// a file in the current folder, else a library of the system.
pub(super) fn named(path: &str) -> Result<Table, DeviceError> {
    // SAFETY: the user named this library as a driver.
    let table = table(unsafe { Library::from_name(path) });
    table.map_err(|reason| DeviceError::Setting {
        name: "driver".to_owned(),
        what: format!("`{path}` cannot be loaded as the NI-DAQmx library: {reason}"),
    })
}

fn of_system(name: &str) -> Result<Table, TableError> {
    // SAFETY: NI-DAQmx's own name.
    table(unsafe { Library::from_system(name) })
}

fn table(library: Result<Library, LoadError>) -> Result<Table, TableError> {
    Table::of(library?)
}

fn not_installed(reasons: &str) -> String {
    let package = if cfg!(target_os = "linux") {
        "the package `ni-daqmx` from ni.com/linux"
    } else {
        "NI-DAQmx from ni.com/downloads"
    };
    format!(
        "NI-DAQmx is not installed: {reasons}. Install {package}, or name the library by the setting `driver`"
    )
}
