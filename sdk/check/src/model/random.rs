//! Random numbers for random parameters and for the fuzzer. The numbers are the same on every
//! machine.

/// A 64-bit generator (splitmix64).
#[derive(Debug, Clone)]
pub(crate) struct Random(u64);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(seed)
    }

    pub(crate) fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }

    /// Returns a number from 0 to 1, excluding 1.
    pub(crate) fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 53) as f64
    }

    /// Returns a number in a range, which includes both ends. In a wide range of positive numbers,
    /// the logarithm is uniformly distributed.
    pub(crate) fn within(&mut self, min: f64, max: f64) -> f64 {
        let part = self.unit();
        let is_wide = min > 0.0 && max / min > 100.0;
        let x = if is_wide {
            min * (part * (max / min).ln()).exp()
        } else {
            // `max - min` would be shorter, but may be infinite.
            min * (1.0 - part) + max * part
        };
        // Rounding may lead slightly beyond the ends.
        x.clamp(min, max)
    }

    /// Returns a whole number below `count`, which must be above 0.
    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.unit() * count as f64) as usize
    }

    /// Returns one of `choices`, which must not be empty.
    pub(crate) fn choose<'a, T>(&mut self, choices: &'a [T]) -> &'a T {
        &choices[self.below(choices.len())]
    }
}
