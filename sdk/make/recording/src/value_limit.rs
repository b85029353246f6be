//! Limit on how many numbers of a file a reader keeps in memory.

use crate::error::ReadProblem;

/// Default limit on how many numbers of a file a reader keeps in memory: enough for three columns
/// of 11 minutes at 20 kHz. Each number, with the data derived from it, takes 8 to 40 bytes of
/// memory. The lower the sample rate, the more bytes each number takes.
pub const MOST_VALUES: usize = 40_000_000;

/// Limit on the numbers kept from one file.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ValueLimit {
    pub(crate) most_values: usize,
}

impl ValueLimit {
    /// Refuses `values` numbers if they are more than the limit.
    #[inline]
    pub(crate) fn check(self, values: u64) -> Result<(), ReadProblem> {
        if values <= self.most_values as u64 {
            Ok(())
        } else {
            Err(ReadProblem::TooManyValues { limit: self.most_values })
        }
    }
}

impl Default for ValueLimit {
    fn default() -> Self {
        Self { most_values: MOST_VALUES }
    }
}
