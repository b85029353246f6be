//! Turns a failed request into an error that says what to do.
//!
//! Messages contain only a status and a code. They never quote responses or the library's own
//! errors, because these contain signatures and keys.

use std::io;
use std::time::Instant;

use super::Store;
use super::log::Last;
use crate::storage::location::{LocalOrRemote, Scheme};
use crate::storage::{StorageError, StorageProblem};

/// The reason why an operation failed.
pub(super) enum Fail {
    /// A request failed before the response's body began.
    Request(Box<object_store::Error>),
    /// A response body was cut off and could not be resumed.
    Body,
    /// The total time is over.
    Slow,
    /// The task ended without a result.
    Ended,
    /// Error with the local file that is read or written.
    Local(io::Error),
    Own(StorageError),
}

impl From<io::Error> for Fail {
    fn from(error: io::Error) -> Self {
        Self::Local(error)
    }
}

impl From<object_store::Error> for Fail {
    fn from(error: object_store::Error) -> Self {
        Self::Request(Box::new(error))
    }
}

impl Store {
    /// Returns the error for a failure. It does not quote texts of the library and of the server,
    /// because these may contain signatures and keys.
    pub(super) fn explain(&self, fail: Fail, begun: Instant) -> StorageError {
        use object_store::Error;
        let seconds = begun.elapsed().as_secs_f64();
        let last = self.log.last();
        let problem = match fail {
            Fail::Own(error) => return error,
            Fail::Local(error) => {
                let copy = format_args!("the local copy of {}", self.location);
                return StorageProblem::Io { error }.at_place(copy);
            }
            Fail::Slow => StorageProblem::TooSlow {
                limit_s: self.settings.total.as_secs_f64(),
                what: format!("{} bytes came in, {}", self.log.bytes(), words(&last)),
            },
            Fail::Ended => self.unavailable("the transfer ended unexpectedly".to_owned(), seconds),
            Fail::Request(error) if matches!(*error, Error::NotFound { .. }) => {
                StorageProblem::Missing
            }
            Fail::Request(error) if matches!(*error, Error::NotSupported { .. }) => {
                StorageProblem::NoRanges
            }
            // If a body was cut off and a later request succeeded, this response belongs to another
            // version of the file.
            Fail::Body if matches!(last, Last::Status { status: 200..=299, .. }) => {
                StorageProblem::Changed
            }
            Fail::Request(_) | Fail::Body => self.by_last(last, seconds),
        };
        problem.at_place(&self.location)
    }

    fn by_last(&self, last: Last, seconds: f64) -> StorageProblem {
        let what = words(&last);
        let (status, code) = match last {
            Last::Status { status, code } => (status, code),
            Last::RedirectRefusal(_) => return StorageProblem::Refused { what },
            Last::Nothing | Last::Cut(_) => return self.unavailable(what, seconds),
        };
        match status {
            404 => StorageProblem::Missing,
            412 => StorageProblem::Changed,
            401 | 403 => self.denied(what, code.as_deref()),
            400 if code.as_deref().is_some_and(is_of_credentials) => {
                self.denied(what, code.as_deref())
            }
            300..=399 => StorageProblem::Refused {
                what: format!(
                    "{what}: it is elsewhere; set AWS_REGION to the region of the bucket"
                ),
            },
            416 => StorageProblem::Refused {
                what: format!("{what}: the range begins after the end of the file"),
            },
            // The server was too slow, got too many requests, or failed. The library has already
            // retried the request.
            408 | 429 | 500.. => self.unavailable(what, seconds),
            200..=299 => StorageProblem::Refused {
                what: format!(
                    "{what}, without the size of the file or with a header that is not valid"
                ),
            },
            _ => StorageProblem::Refused { what },
        }
    }

    fn unavailable(&self, what: String, seconds: f64) -> StorageProblem {
        StorageProblem::Unavailable { what, requests: self.log.requests(), seconds }
    }

    fn denied(&self, what: String, code: Option<&str>) -> StorageProblem {
        let scheme = match self.location.place() {
            LocalOrRemote::Remote(uri) => uri.scheme,
            LocalOrRemote::Local(_) => Scheme::Https,
        };
        StorageProblem::Denied { what, advice: self.advice(scheme, code) }
    }

    fn advice(&self, scheme: Scheme, code: Option<&str>) -> String {
        let given = match scheme {
            Scheme::S3 => "AWS_ACCESS_KEY_ID and AWS_SECRET_ACCESS_KEY",
            Scheme::Gs => "GOOGLE_APPLICATION_CREDENTIALS",
            Scheme::Az => "AZURE_STORAGE_ACCOUNT_KEY or AZURE_STORAGE_SAS_KEY",
            Scheme::Http | Scheme::Https => {
                return "htex sends no credentials to web servers; a signed link works until it expires".to_owned();
            }
        };
        let sentence = match code {
            Some("ExpiredToken" | "TokenRefreshRequired") => {
                "the credentials have expired; get new ones, AWS_SESSION_TOKEN among them"
            }
            Some("InvalidAccessKeyId") => "no such key exists there; check AWS_ACCESS_KEY_ID",
            Some("SignatureDoesNotMatch") => {
                "the secret does not belong to the key; check AWS_SECRET_ACCESS_KEY"
            }
            Some("RequestTimeTooSkewed") => "the clock of this machine is wrong; set it",
            Some("AuthorizationHeaderMalformed") => "set AWS_REGION to the region of the bucket",
            _ if !self.is_signed => return format!("no credentials are set; set {given}"),
            _ => return format!("these credentials may not do this, or are wrong; check {given}"),
        };
        sentence.to_owned()
    }
}

/// Returns whether an S3 code is about credentials. S3 sends these codes with the status 400.
fn is_of_credentials(code: &str) -> bool {
    matches!(
        code,
        "ExpiredToken" | "InvalidToken" | "TokenRefreshRequired" | "AuthorizationHeaderMalformed"
    )
}

fn words(last: &Last) -> String {
    match last {
        Last::Nothing => "no response".to_owned(),
        Last::Status { status, code: None } => format!("status {status}"),
        Last::Status { status, code: Some(code) } => format!("status {status}, {code}"),
        Last::Cut(cause) => cause.clone(),
        Last::RedirectRefusal(reason) => (*reason).to_owned(),
    }
}
