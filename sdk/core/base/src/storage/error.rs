//! Errors of remote and local files.

use std::fmt::Display;
use std::io;

/// Error of reading or writing a file. No message contains a credential, the query of a URL, or the
/// text of a server's response.
#[derive(Debug, thiserror::Error)]
#[error("{place}: {problem}")]
pub struct StorageError {
    /// Where the problem is: the URI without secrets, a path, or the name of a variable whose value
    /// is wrong.
    pub place: String,
    pub problem: StorageProblem,
}

/// The problem with a file.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum StorageProblem {
    /// The URI is malformed.
    #[error("{problem}")]
    Uri { problem: String },
    /// This build can only read local files.
    #[error("this build reads files of this machine only; build it with the feature `cloud`")]
    NoCloud,
    /// Reading or writing a local file, or a local copy of a remote file, failed.
    #[error("{error}")]
    Io { error: io::Error },
    /// There is no such file.
    #[error("there is no such file; check the bucket and the key")]
    Missing,
    /// The server refused the credentials, or requires credentials.
    #[error("the server refuses access ({what}); {advice}")]
    Denied {
        /// The status and the server's code.
        what: String,
        /// What to do. It contains the names of environment variables.
        advice: String,
    },
    /// The settings in environment variables are not sufficient.
    #[error("{problem}")]
    Settings {
        /// What is missing. It contains the names of environment variables.
        problem: String,
    },
    /// The file was replaced while it was read.
    #[error("the file was replaced while it was read; read it again")]
    Changed,
    /// The file is larger than the limit.
    #[error("it has more than {most_bytes} bytes")]
    TooLarge { most_bytes: u64 },
    /// The range ends beyond the end of the file.
    #[error("bytes {offset} to {end} were asked for, and it has {len}")]
    Range {
        offset: u64,
        /// End of the range: the offset of the last byte plus 1.
        end: u64,
        /// The size of the file.
        len: u64,
    },
    /// The server cannot send parts of files. From such a server, htex reads only files of up to 1
    /// MiB, and reads them as a whole.
    #[error(
        "the server sends whole files only, and it has more than 1 MiB; download it and name the copy"
    )]
    NoRanges,
    /// The file is on a web server, so it cannot be written.
    #[error("files by HTTP are only read; write to s3://, gs://, az:// or a local file")]
    ReadOnly,
    /// The store cannot list its files.
    #[error("a web server has no list of files; name each file")]
    NoList,
    /// The server failed or cannot be reached, even after retries.
    #[error("{what}, after {requests} requests in {seconds:.1} s; try again later")]
    Unavailable {
        /// The last failure.
        what: String,
        /// Number of requests that were sent.
        requests: u64,
        /// Time since the first request, seconds.
        seconds: f64,
    },
    /// The whole operation took too long.
    #[error("not done within {limit_s} s ({what}); set HTEX_STORAGE_TIMEOUT_S to wait longer")]
    TooSlow {
        limit_s: f64,
        /// The progress of the operation, or the last failure.
        what: String,
    },
    /// The request was refused for another reason, by the server or by a server to which it
    /// redirects.
    #[error("refused: {what}")]
    Refused {
        /// The status and the server's code.
        what: String,
    },
}

impl StorageProblem {
    /// Creates the error for this problem at a URI or a path.
    pub fn at_place(self, place: impl Display) -> StorageError {
        StorageError { place: place.to_string(), problem: self }
    }
}

impl StorageError {
    /// Adds the URI or the path to an error of the system.
    pub(crate) fn io_at(place: impl Display) -> impl FnOnce(io::Error) -> Self {
        move |error| StorageProblem::Io { error }.at_place(place)
    }
}
