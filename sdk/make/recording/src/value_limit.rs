//! Limit on the numbers from a file that are kept in memory.

use crate::error::ReadProblem;

/// Default limit on the numbers that are kept from a file: enough for 11 minutes of three columns
/// at 20 kHz. Together with derived data, each number takes 8 to 40 bytes of memory, most at low
/// sample rates.
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
