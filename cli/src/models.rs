//! The name of this program, and errors of settings as errors of its flags.

use htex_author::settings::SettingsError;

use crate::failure::Failure;

/// Name and version of this program, for an asset's provenance.
pub(crate) fn tool() -> String {
    concat!("htex ", env!("CARGO_PKG_VERSION")).to_owned()
}

impl From<SettingsError> for Failure {
    /// A setting is a flag of this program; a file that cannot be read is not.
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
