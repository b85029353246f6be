//! The name of this program, and conversion of settings errors to errors about its flags.

use htex_author::settings::SettingsError;

use crate::failure::Failure;

/// Returns the name and version of this program, for an asset's provenance.
pub(crate) fn tool() -> String {
    concat!("htex ", env!("CARGO_PKG_VERSION")).to_owned()
}

impl From<SettingsError> for Failure {
    /// A setting becomes a flag of this program. A file that cannot be read is not a matter of
    /// flags.
    fn from(error: SettingsError) -> Self {
        match error {
            SettingsError::Model(error) => Self::Model(error),
            SettingsError::Response(error) => Self::Recording(*error),
            SettingsError::Grid(error) => Self::Usage(format!("--{error}")),
            SettingsError::Map { keyword, text, error } => {
                let flag = keyword.replace('_', "-");
                Self::Usage(format!("--{flag} {text}: {error}"))
            }
            SettingsError::Trackers { .. } => Self::Usage(format!("--tracker: {error}")),
            usage => Self::Usage(format!("--{usage}")),
        }
    }
}
