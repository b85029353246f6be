//! Limit on the work that the filters of a file take, counted over the whole file.

/// Largest work for a file. The unit is one comparison of a zero with another zero in a round of
/// the search for zeros. This takes some 7 ns, so the limit is about 1.5 s. A file of the toolkit
/// has some 40 filters and takes a hundredth of that.
const MOST_WORK: usize = 200_000_000;
/// Work for each pair of coefficients of a polynomial whose line spectral frequencies are computed.
/// Each of them is found by evaluating the angles of all roots some fifty times.
const PER_PAIR: usize = 100;

/// The work that is left for the filters of a file.
#[derive(Debug, Clone)]
pub(super) struct Work(usize);

impl Default for Work {
    fn default() -> Self {
        Self(MOST_WORK)
    }
}

impl Work {
    #[cfg(test)]
    pub(super) fn none() -> Self {
        Self(0)
    }

    /// Counts work; `None` if the limit is exceeded.
    pub(super) fn add(&mut self, work: usize) -> Option<()> {
        self.0 = self.0.checked_sub(work)?;
        Some(())
    }

    /// Counts the computation of line spectral frequencies for a polynomial of this order.
    pub(super) fn add_lines(&mut self, order: usize) -> Option<()> {
        self.add(PER_PAIR * order * order)
    }
}
