//! The work that the filters of a file take, counted over the whole file.

/// Most work of a file. Its unit is a zero that is compared with another one in a round of the
/// search for zeros; some 7 ns, so that all of it takes about 1.5 s. A file of the toolkit has some
/// 40 filters, which take a hundredth.
const MOST_WORK: usize = 200_000_000;
/// Work for each pair of coefficients of a polynomial whose lines are computed: each line is found
/// by some fifty evaluations of all roots' angles.
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

    /// Counts work; `None` if there is no more left.
    pub(super) fn add(&mut self, work: usize) -> Option<()> {
        self.0 = self.0.checked_sub(work)?;
        Some(())
    }

    /// Counts the lines of a polynomial of this order.
    pub(super) fn add_lines(&mut self, order: usize) -> Option<()> {
        self.add(PER_PAIR * order * order)
    }
}
