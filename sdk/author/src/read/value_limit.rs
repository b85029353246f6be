//! How many numbers of a file are kept in memory.

use super::ReadError;

/// Most numbers that are kept of a file, where nothing else is said: 11 minutes of three columns at 20 kHz. With what is
/// made of them they take 8 to 40 bytes each, most at low rates.
pub const MOST_VALUES: usize = 40_000_000;

/// Room for the numbers of one file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Room {
    pub(crate) most_values: usize,
}

impl Room {
    /// Refuses more numbers than there is room for.
    #[inline]
    pub(crate) fn check(self, file: &str, values: u64) -> Result<(), ReadError> {
        match values <= self.most_values as u64 {
            true => Ok(()),
            false => Err(ReadError::TooManyValues {
                file: file.to_owned(),
                limit: self.most_values,
            }),
        }
    }
}

impl Default for Room {
    fn default() -> Self {
        Self {
            most_values: MOST_VALUES,
        }
    }
}
