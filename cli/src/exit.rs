//! The exit status of the command.

/// An exit status. Unlike `std::process::ExitCode`, its number can be read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) struct Exit(u8);

impl Exit {
    /// Nothing failed and nothing was found.
    pub(crate) const SUCCESS: Self = Self(0);
    /// A failure, or findings.
    pub(crate) const FAILURE: Self = Self(1);
    /// Wrong usage.
    pub(crate) const USAGE: Self = Self(2);
    /// Partly made, with some left out.
    #[cfg(feature = "build")]
    pub(crate) const PART: Self = Self(3);

    /// Returns the status with which the process ends.
    pub(crate) fn code(self) -> u8 {
        self.0
    }
}
