//! What can go wrong with a file elsewhere.

use std::fmt::Display;
use std::io;

/// The error of reading or writing a file. No message holds a credential, a query of a URL, or the
/// text of a server's response.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct StorageError {
    /// The URI without secrets, a path, or the variable that is set wrongly.
    pub place: String,
    pub problem: StorageProblem,
}

/// What is wrong with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StorageProblem {
    /// The URI is malformed.
    #[error("{problem}")]
    Uri { problem: String },
    /// This build reads local files only.
    #[error("this build reads files of this machine only; build it with the feature `cloud`")]
    NoCloud,
    /// A local file, or a local copy.
    #[error("{error}")]
    Io { error: io::Error },
    /// There is no such file.
    #[error("there is no such file; check the bucket and the key")]
    Missing,
    /// The server has refused the credentials, or asks for some.
    #[error("the server refuses access ({what}); {advice}")]
    Denied {
        /// The status, and the server's code.
        what: String,
        /// What to do, by the names of variables.
        advice: String,
    },
    /// The environment's settings do not suffice.
    #[error("{problem}")]
    Settings {
        /// What is missing, by the names of variables.
        problem: String,
    },
    /// The file was replaced while it was read.
    #[error("the file was replaced while it was read; read it again")]
    Changed,
    /// The file has more bytes than may be read.
    #[error("it has more than {most_bytes} bytes")]
    TooLarge { most_bytes: u64 },
    /// A range beyond the end of the file.
    #[error("bytes {offset} to {end} were asked for, and it has {len}")]
    Range {
        offset: u64,
        /// One after the last byte.
        end: u64,
        /// The size of the file.
        len: u64,
    },
    /// The server sends no parts of files.
    #[error("the server sends whole files only; download it and name the copy")]
    NoRanges,
    /// Files by HTTP are only read.
    #[error("files by HTTP are only read; write to s3://, gs://, az:// or a local file")]
    ReadOnly,
    /// The store has no list of its files.
    #[error("a web server has no list of files; name each file")]
    NoList,
    /// The server failed, or cannot be reached, in spite of retries.
    #[error("{what}, after {requests} requests in {seconds:.1} s; try again later")]
    Unavailable {
        /// The last failure.
        what: String,
        /// Requests that were sent.
        requests: u64,
        /// Time since the first.
        seconds: f64,
    },
    /// The whole operation took too long.
    #[error("not done within {limit_s} s ({what}); set HTEX_STORAGE_TIMEOUT_S to wait longer")]
    TooSlow {
        limit_s: f64,
        /// How far it came, or the last failure.
        what: String,
    },
    /// Any other refusal, of the server or of what it leads to.
    #[error("refused: {what}")]
    Refused {
        /// The status, and the server's code.
        what: String,
    },
}

impl StorageProblem {
    /// The error of this problem at a URI or a path.
    pub fn at(self, place: impl Display) -> StorageError {
        StorageError { place: place.to_string(), problem: self }
    }
}

/// Adds the URI or the path to an error of the system.
pub(crate) trait AtPlace<T> {
    fn at(self, place: impl Display) -> Result<T, StorageError>;
}

impl<T> AtPlace<T> for io::Result<T> {
    fn at(self, place: impl Display) -> Result<T, StorageError> {
        self.map_err(|error| StorageProblem::Io { error }.at(place))
    }
}
