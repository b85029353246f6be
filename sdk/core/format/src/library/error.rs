//! Errors of reading and writing libraries.

use std::io;
use std::path::PathBuf;

use crate::ReadError;
use htex_base::finding::{Finding, plain, summary};

use crate::library::name::InvalidName;

/// Error of reading or writing a library.
///
/// ```
/// use htex_format::library::{Library, LibraryError};
/// let error = Library::open_source(&b"not a library"[..]).map(|_| ()).unwrap_err();
/// assert!(matches!(&error, LibraryError::Invalid { findings } if findings[0].code == "LIBRARY_UNRECOGNISED"));
/// ```
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum LibraryError {
    /// The file could not be opened.
    #[error("cannot open {}: {error}", .path.display())]
    Open {
        path: PathBuf,
        #[source]
        error: io::Error,
    },
    /// Bytes of the library could not be read.
    #[error("cannot read {length} bytes at byte {at} of the library: {error}")]
    Read {
        /// Offset in the file.
        at: u64,
        length: u64,
        #[source]
        error: io::Error,
    },
    /// The file breaks a rule of the format.
    #[error("not a valid library: {}", summary(.findings))]
    Invalid {
        /// The broken rule, with its code.
        findings: Vec<Finding>,
    },
    /// The library has no texture with this name.
    #[error("there is no texture {} in the library; {}", plain(.name), advice(.nearest))]
    Absent {
        name: String,
        /// The most similar names in the library; empty if no name is similar.
        nearest: Vec<String>,
    },
    /// The library is not signed as the program requires ([`crate::signing::Signers`]).
    #[error("{}", crate::signing::refusal(.0))]
    Signature(#[from] crate::signing::SignatureError),
    /// The library could not be written. If the file existed before, it is unchanged.
    #[error("cannot write {}: {error}; the file is unchanged", .path.display())]
    Write {
        path: PathBuf,
        #[source]
        error: io::Error,
    },
    /// A name is not allowed.
    #[error("{:?} is not a name: {problem}", plain(.name))]
    Name {
        name: String,
        /// The broken rule.
        #[source]
        problem: InvalidName,
    },
    /// Two textures have the same name.
    #[error("two textures have the name {}; rename one", plain(.name))]
    Duplicate { name: String },
    /// Two names differ only in upper and lower case, or in Unicode normalisation.
    #[error("{} and {} differ only in case or in Unicode normalisation, and are one file on some systems; rename one", plain(.name), plain(.other))]
    Alike {
        name: String,
        /// The name that was added before.
        other: String,
    },
    /// Some textures state no licence, and the writer's options do not allow such textures.
    #[error("{}{} no licence, and a library is passed on; state it, or pack it as unlicensed", plain(.name), states(.others))]
    Unlicensed {
        /// Name of the first texture without a licence.
        name: String,
        /// Number of further textures without a licence.
        others: usize,
    },
    /// A texture to be added is not a valid asset.
    #[error("{}: {error}", plain(.name))]
    Asset {
        name: String,
        #[source]
        error: Box<ReadError>,
    },
    /// A remote file could not be opened.
    #[cfg(feature = "storage")]
    #[error(transparent)]
    Storage(#[from] htex_base::storage::StorageError),
    /// A texture, or the library, exceeds a limit of the index.
    #[error("{}: {problem}", plain(.name))]
    Limit {
        /// Name of the texture, or of the library.
        name: String,
        /// The limit, and what to do.
        problem: String,
    },
}

/// If the error comes from the operating system, keeps the kind of that error.
impl From<LibraryError> for io::Error {
    fn from(error: LibraryError) -> Self {
        let kind = match &error {
            LibraryError::Open { error, .. } | LibraryError::Read { error, .. } => error.kind(),
            _ => io::ErrorKind::Other,
        };
        Self::new(kind, error)
    }
}

/// Returns what to do if a name is absent.
fn advice(nearest: &[String]) -> String {
    if nearest.is_empty() {
        return "list its entries to see their names".to_owned();
    }
    let nearest: Vec<_> = nearest.iter().map(|name| plain(name)).collect();
    format!("its most similar names are {}", nearest.join(", "))
}

/// Returns the words that continue the message: the number of other textures, and the verb in the
/// singular or plural.
fn states(others: &usize) -> String {
    match others {
        0 => " states".to_owned(),
        1 => " and another texture state".to_owned(),
        others => format!(" and {others} other textures state"),
    }
}
