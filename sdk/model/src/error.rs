//! Status codes and the error that carries one.

use alloc::string::String;

/// What a call returns. Frozen numbers: they are part of the ABI.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[repr(i32)]
pub enum Status {
    /// The call did what it says.
    Ok = 0,
    /// A pointer, length, rate, band or weight is not usable.
    InvalidArgument = -1,
    /// Parameters do not fit the descriptor's fields.
    InvalidParameters = -2,
    /// A fit option does not fit the descriptor's options.
    InvalidOption = -3,
    /// The spectrum holds nothing this model can be fitted to.
    CannotFit = -4,
    /// No such voice, or a voice that was freed.
    BadHandle = -5,
    /// No more voices can be made.
    TooManyVoices = -6,
    /// The model panicked; the call had no effect that can be relied on.
    Panicked = -7,
    /// Any other failure, told by the last-error text.
    Failed = -8,
}

impl Status {
    /// The status of a number that crossed the ABI; unknown negative numbers are `Failed`.
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

/// A status with a message: what was wrong, where, and what to do.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Error {
    /// The code that crosses the ABI.
    pub status: Status,
    /// The message behind it.
    pub message: String,
}

impl Error {
    /// An error of any status.
    pub fn new(status: Status, message: impl Into<String>) -> Self {
        Self {
            status,
            message: message.into(),
        }
    }

    /// The spectrum holds nothing this model can be fitted to.
    #[cold]
    pub fn cannot_fit(message: impl Into<String>) -> Self {
        Self::new(Status::CannotFit, message)
    }

    /// An argument is not usable.
    #[cold]
    pub fn argument(message: impl Into<String>) -> Self {
        Self::new(Status::InvalidArgument, message)
    }

    /// Parameters are not usable.
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
