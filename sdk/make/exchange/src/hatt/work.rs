//! Limits the total amount of computation for all filters of a file.

/// Largest work for a file. The unit is the comparison of one zero with another zero, in one round
/// of the search for zeros. A comparison takes some 7 ns, so the limit is about 1.5 s. A file of
/// the toolkit has some 40 filters and takes a hundredth of this time.
const MOST_WORK: usize = 200_000_000;
/// Work for each pair of coefficients when line spectral frequencies are computed. Finding one
/// frequency evaluates the angles of all roots some fifty times.
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

    /// Adds work. Returns `None` if the limit is exceeded.
    pub(super) fn add(&mut self, work: usize) -> Option<()> {
        self.0 = self.0.checked_sub(work)?;
        Some(())
    }

    /// Adds the work for computing the line spectral frequencies of a polynomial of this order.
    pub(super) fn add_lines(&mut self, order: usize) -> Option<()> {
        self.add(PER_PAIR * order * order)
    }
}
