//! What can go wrong with a file elsewhere.

use std::io;

/// The error of reading or writing a file. No message holds a credential, a query of a URL, or the text of a server's response.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StorageError {
    /// The URI is malformed.
    #[error("{uri}: {problem}")]
    Uri {
        /// The URI, without secrets.
        uri: String,
        problem: String,
    },
    /// This build reads local files only.
    #[error(
        "{uri}: this build reads files of this machine only; build it with the feature `cloud`"
    )]
    NoCloud { uri: String },
    /// A local file, or a local copy.
    #[error("{path}: {error}")]
    Io { path: String, error: io::Error },
    /// There is no such file.
    #[error("{uri}: there is no such file; check the bucket and the key")]
    Missing { uri: String },
    /// The server has refused the credentials, or asks for some.
    #[error("{uri}: the server refuses access ({what}); {advice}")]
    Denied {
        uri: String,
        /// The status, and the server's code.
        what: String,
        /// What to do, by the names of variables.
        advice: String,
    },
    /// The environment's settings do not suffice.
    #[error("{uri}: {problem}")]
    Settings {
        uri: String,
        /// What is missing, by the names of variables.
        problem: String,
    },
    /// The file was replaced while it was read.
    #[error("{uri}: the file was replaced while it was read; read it again")]
    Changed { uri: String },
    /// The file has more bytes than may be read.
    #[error("{uri}: it has more than {most_bytes} bytes")]
    TooLarge { uri: String, most_bytes: u64 },
    /// A range beyond the end of the file.
    #[error("{uri}: bytes {offset} to {end} were asked for, and it has {len}")]
    Range {
        uri: String,
        offset: u64,
        /// One after the last byte.
        end: u64,
        /// The size of the file.
        len: u64,
    },
    /// The server sends no parts of files.
    #[error("{uri}: the server sends whole files only; download it and name the copy")]
    NoRanges { uri: String },
    /// Files by HTTP are only read.
    #[error("{uri}: files by HTTP are only read; write to s3://, gs://, az:// or a local file")]
    ReadOnly { uri: String },
    /// The store has no list of its files.
    #[error("{uri}: a web server has no list of files; name each file")]
    NoList { uri: String },
    /// The server failed, or cannot be reached, in spite of retries.
    #[error("{uri}: {what}, after {requests} requests in {seconds:.1} s; try again later")]
    Unavailable {
        uri: String,
        what: String,
        /// Requests that were sent.
        requests: u64,
        /// Time since the first.
        seconds: f64,
    },
    /// The whole operation took too long.
    #[error(
        "{uri}: not done within {limit_s} s ({what}); set HTEX_STORAGE_TIMEOUT_S to wait longer"
    )]
    TooSlow {
        uri: String,
        limit_s: f64,
        /// How far it came, or the last failure.
        what: String,
    },
    /// Any other refusal, of the server or of what it leads to.
    #[error("{uri}: refused: {what}")]
    Refused {
        uri: String,
        /// The status, and the server's code.
        what: String,
    },
}

impl StorageError {
    pub(crate) fn io(path: impl std::fmt::Display, error: io::Error) -> Self {
        Self::Io {
            path: path.to_string(),
            error,
        }
    }
}
