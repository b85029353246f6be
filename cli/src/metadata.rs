//! Metadata given by flags.

use htex_author::settings::Metadata;

use crate::failure::Failure;
use crate::output::warn;

/// Reports the problems that the asset's validation would find in this metadata.
pub(crate) fn checked(metadata: &Metadata) -> Result<(), Failure> {
    let warnings: Vec<String> = metadata.check()?.iter().map(|w| format!("--{w}")).collect();
    warn(&warnings);
    Ok(())
}
