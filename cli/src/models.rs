//! The name of this program, and conversion of settings errors to errors about its flags.

use htex_author::AuthorError;

use crate::failure::Failure;

/// Returns the name and version of this program, for an asset's provenance.
pub(crate) fn tool() -> String {
    concat!("htex ", env!("CARGO_PKG_VERSION")).to_owned()
}

impl From<AuthorError> for Failure {
    /// A setting becomes a flag of this program. A file that cannot be read is not a matter of
    /// flags.
    fn from(error: AuthorError) -> Self {
        match error {
            AuthorError::Model(error) => Self::Model(error),
            AuthorError::Read(error) => Self::Recording(error),
            AuthorError::Map { keyword, text, error } => {
                let flag = keyword.replace('_', "-");
                Self::Usage(format!("--{flag} {text}: {error}"))
            }
            AuthorError::Trackers { .. } => Self::Usage(format!("--tracker: {error}")),
            AuthorError::GridText { .. }
            | AuthorError::ModelNotFitted { .. }
            | AuthorError::OptionForm { .. }
            | AuthorError::Metadata { .. } => Self::Usage(format!("--{error}")),
            error => Self::Author(error),
        }
    }
}
