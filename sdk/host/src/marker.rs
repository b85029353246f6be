//! The version marker of a model.

use htex_model::abi::{ABI_MAJOR, ABI_MARKER};

use crate::HostError;

/// Checks that a model has this ABI's major version.
pub(crate) fn check_marker(origin: &str, marker: u32) -> Result<(), HostError> {
    // The lowest byte is the minor version, which increases only for optional exports.
    if marker >> 8 == ABI_MARKER >> 8 {
        return Ok(());
    }
    Err(HostError::Broken {
        model: origin.to_owned(),
        call: "htex_model_abi_version",
        what: format!("its marker is {marker:#x}; this host loads models of ABI {ABI_MAJOR}.x"),
    })
}
