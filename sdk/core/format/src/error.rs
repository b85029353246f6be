//! Errors of reading and writing assets, and of their metadata.

use std::io;
use std::path::PathBuf;

use htex_base::finding::{Finding, Rule, summary};

use crate::rules as rule;

/// Error of reading an asset.
///
/// ```
/// use htex_format::{Asset, ReadError};
/// let error = Asset::from_bytes(b"not an asset").unwrap_err();
/// assert!(matches!(&error, ReadError::Invalid { findings } if !findings.is_empty()));
/// ```
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum ReadError {
    /// The file could not be read.
    #[error("cannot read {}: {error}", .path.display())]
    Io {
        path: PathBuf,
        #[source]
        error: io::Error,
    },
    /// The file is not a valid asset.
    #[error("not a valid asset: {}", summary(.findings))]
    Invalid {
        /// All findings, including warnings and information.
        findings: Vec<Finding>,
    },
    /// The file is not signed as the program requires ([`crate::signing::Signers`]).
    #[error("{}", crate::signing::refusal(.0))]
    Signature(#[from] crate::signing::SignatureError),
}

/// Error of writing an asset.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum WriteError {
    /// The file could not be written. If the file existed before, it is unchanged.
    #[error("cannot write {}: {error}; the file is unchanged", .path.display())]
    Io {
        path: PathBuf,
        #[source]
        error: io::Error,
    },
    /// The asset breaks a rule of the format.
    #[error("the asset breaks the format's rules: {}", summary(.findings))]
    Invalid {
        /// All findings, including warnings and information.
        findings: Vec<Finding>,
    },
    /// A parameter is outside the range of values that its field can store.
    #[error(
        "parameter {field}[{index}] is {value} and its store holds {low} to {high}; \
         bring the value into that range or choose another store"
    )]
    OutOfRange {
        field: String,
        /// Index in the field; 0 for a scalar.
        index: usize,
        value: f64,
        /// Smallest value that the field can store.
        low: f64,
        /// Largest value that the field can store.
        high: f64,
    },
    /// A flat array of parameters does not match the fields.
    #[error(
        "the flat parameters do not match the fields: {problem}; give each scalar one value \
         and each list its length and then its values"
    )]
    Layout {
        /// The field and what is wrong with it.
        problem: String,
    },
    /// The length of an array differs from the length that the manifest states.
    #[error("{what}: {got} given and the manifest has {expected}; make them agree")]
    Count {
        what: String,
        /// Number of elements that the manifest states.
        expected: usize,
        got: usize,
    },
    /// The archive or the manifest could not be encoded.
    #[error("cannot encode the archive: {problem}")]
    Archive {
        /// The encoder's message.
        problem: String,
    },
}

/// Error for a text in the manifest, such as a licence, that does not have the required form.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum MetadataError {
    /// The id of a licence is not in the SPDX list of this version of htex. It may be in a newer
    /// list.
    #[error(
        "{id:?} is not in the SPDX list; correct it, or write LicenseRef-NAME for a licence of your own"
    )]
    UnlistedLicense { id: String },
    /// The text is not an SPDX expression.
    #[error("{license:?} is not an SPDX expression ({reason}); write one like CC-BY-4.0")]
    License { license: String, reason: String },
    /// The text is not a DOI.
    #[error(
        "{doi:?} is not a DOI; write one like 10.5281/zenodo.1234567, without https://doi.org/"
    )]
    Doi { doi: String },
    /// The name of an extension does not have the form `com.vendor.NAME/REVISION`.
    #[error("{name:?} is not of the form com.vendor.NAME/REVISION")]
    ExtensionName { name: String },
}

impl MetadataError {
    /// Returns the broken rule. The rules for an unlisted licence and for the name of an extension
    /// have the severity warning. The other rules are errors.
    #[must_use]
    pub fn rule(&self) -> &'static Rule {
        match self {
            Self::UnlistedLicense { .. } => rule::LICENSE_UNKNOWN,
            Self::License { .. } => rule::LICENSE_INVALID,
            Self::Doi { .. } => rule::DOI_INVALID,
            Self::ExtensionName { .. } => rule::EXTENSION_NAME_INVALID,
        }
    }
}
