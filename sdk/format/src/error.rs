//! What can go wrong when an asset is read or written.

use std::io;
use std::path::PathBuf;

use crate::{Finding, Severity};

/// How many findings the text of an error shows.
const SHOWN: usize = 3;

/// An asset could not be read.
#[derive(Debug, thiserror::Error)]
pub enum ReadError {
    /// The file could not be read at all.
    #[error("cannot read {}: {error}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        error: io::Error,
    },
    /// The file is not a valid asset.
    #[error("not a valid asset: {}", summary(.findings))]
    Invalid {
        /// Everything that was found, errors and others.
        findings: Vec<Finding>,
    },
}

/// An asset could not be written.
#[derive(Debug, thiserror::Error)]
pub enum WriteError {
    /// The file could not be written; what stood there before still does.
    #[error("cannot write {}: {error}; the file was left as it was", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        #[source]
        error: io::Error,
    },
    /// The asset breaks a rule of the format.
    #[error("the asset breaks the format's rules: {}", summary(.findings))]
    Invalid {
        /// Everything that was found, errors and others.
        findings: Vec<Finding>,
    },
    /// A parameter cannot be stored the way its field says.
    #[error(
        "parameter {field}[{index}] is {value}, and its store holds {low} to {high}; \
         bring the value into that range or choose another store"
    )]
    OutOfRange {
        /// Name of the field.
        field: String,
        /// Place in the field; 0 for a scalar.
        index: usize,
        /// The value.
        value: f64,
        /// Least value the store holds.
        low: f64,
        /// Greatest value the store holds.
        high: f64,
    },
    /// A flat array does not follow its fields.
    #[error(
        "the flat parameters do not follow the fields: {problem}; give each scalar one value \
         and each list its length and then its values"
    )]
    Layout {
        /// Which field, and how.
        problem: String,
    },
    /// The arrays beside the manifest do not match it.
    #[error("{what}: {got} given and the manifest has {expected}; make them agree")]
    Count {
        /// Which array.
        what: String,
        /// Entries the manifest asks for.
        expected: usize,
        /// Entries there are.
        got: usize,
    },
    /// The archive or the manifest could not be made.
    #[error("cannot make the archive: {problem}")]
    Archive {
        /// What the encoder said.
        problem: String,
    },
}

/// The first errors of a list, in words.
pub fn summary(findings: &[Finding]) -> String {
    let errors = || findings.iter().filter(|f| f.severity == Severity::Error);
    let mut text: Vec<String> = errors().take(SHOWN).map(ToString::to_string).collect();
    let rest = errors().count().saturating_sub(SHOWN);
    if rest > 0 {
        text.push(format!("and {rest} more"));
    }
    text.join("; ")
}
