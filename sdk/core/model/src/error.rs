//! Status codes of calls, and the error type, which contains a status code and a message.

use alloc::string::String;

/// Status code of a call. The numbers are part of the ABI and never change.
///
/// ```
/// use htex_model::Status;
/// assert_eq!(Status::from_code(Status::CannotFit as i64), Status::CannotFit);
/// assert_eq!(Status::from_code(-1000), Status::Failed);
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// The call succeeded.
    Ok = 0,
    /// A pointer, length, rate, band or weight is invalid.
    InvalidArgument = -1,
    /// The parameters do not match the descriptor's fields.
    InvalidParameters = -2,
    /// A fit option does not match the descriptor's options.
    InvalidOption = -3,
    /// The model cannot describe the spectrum.
    CannotFit = -4,
    /// No voice has the given handle, e.g. because the voice was freed.
    BadHandle = -5,
    /// The model cannot make more voices.
    TooManyVoices = -6,
    /// The model panicked; the effect of the call is undefined.
    Panicked = -7,
    /// Any other failure, described by the last-error text.
    Failed = -8,
}

impl Status {
    /// Converts a returned number to a status. Unknown negative numbers become `Failed`.
    pub fn from_code(code: i64) -> Self {
        match code {
            0.. => Self::Ok,
            -1 => Self::InvalidArgument,
            -2 => Self::InvalidParameters,
            -3 => Self::InvalidOption,
            -4 => Self::CannotFit,
            -5 => Self::BadHandle,
            -6 => Self::TooManyVoices,
            -7 => Self::Panicked,
            _ => Self::Failed,
        }
    }
}

/// An error of a model: a status, and a message that says what is wrong, where, and how to fix it.
///
/// ```
/// use htex_model::{Error, Status, text};
/// let error = Error::cannot_fit(text!["no peak above ", 0.5, " N"]);
/// assert_eq!((error.status, &error.message[..]), (Status::CannotFit, "no peak above 0.5 N"));
/// ```
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// The status returned through the ABI.
    pub status: Status,
    /// The last-error text.
    pub message: String,
}

impl Error {
    /// Makes an error with any status.
    pub fn new(status: Status, message: impl Into<String>) -> Self {
        Self { status, message: message.into() }
    }

    /// Makes an error with the status [`Status::CannotFit`]: the model cannot describe the
    /// spectrum.
    #[cold]
    pub fn cannot_fit(message: impl Into<String>) -> Self {
        Self::new(Status::CannotFit, message)
    }

    /// Makes an error with the status [`Status::InvalidArgument`]: an argument is invalid.
    #[cold]
    pub fn argument(message: impl Into<String>) -> Self {
        Self::new(Status::InvalidArgument, message)
    }

    /// Makes an error with the status [`Status::InvalidParameters`]: the parameters are invalid.
    #[cold]
    pub fn parameters(message: impl Into<String>) -> Self {
        Self::new(Status::InvalidParameters, message)
    }
}

impl core::fmt::Display for Error {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(&self.message)
    }
}

impl core::error::Error for Error {}
