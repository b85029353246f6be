//! Running sums of a signal, which give the mean of any part with only two look-ups.

/// Running sums of a signal. The entry at index i is the sum of all samples before sample i. The
/// last entry is the sum of all samples.
pub struct Sums(Vec<f64>);

impl Sums {
    /// Adds up `values`.
    #[must_use]
    pub fn new(values: impl Iterator<Item = f64>) -> Self {
        let mut sum = 0.0;
        let mut sums = Vec::with_capacity(values.size_hint().0 + 1);
        sums.push(sum);
        sums.extend(values.map(|value| {
            sum += value;
            sum
        }));
        Self(sums)
    }

    /// Returns the number of samples in the signal.
    #[must_use]
    pub fn samples(&self) -> usize {
        self.0.len() - 1
    }

    /// Returns the mean of the samples from `from` up to but not including `to`; 0 if there are
    /// none.
    #[must_use]
    pub fn mean(&self, from: usize, to: usize) -> f64 {
        (self.0[to] - self.0[from]) / (to - from).max(1) as f64
    }

    /// Returns the mean over the `2·half + 1` samples around a sample. Near the ends of the signal,
    /// the mean is over fewer samples.
    #[must_use]
    pub fn mean_around(&self, at: usize, half: usize) -> f64 {
        self.mean(at.saturating_sub(half), (at + half + 1).min(self.samples()))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn means_shrink_at_the_ends() {
        let sums = Sums::new([1.0, 2.0, 6.0, 7.0].into_iter());
        let means = |half| [0, 1, 2, 3].map(|at| sums.mean_around(at, half));
        assert_eq!(means(0), [1.0, 2.0, 6.0, 7.0]);
        assert_eq!(means(1), [1.5, 3.0, 5.0, 6.5]);
        assert_eq!(means(9), [4.0; 4]);
        assert_eq!(Sums::new(std::iter::empty()).mean(0, 0), 0.0);
    }
}
