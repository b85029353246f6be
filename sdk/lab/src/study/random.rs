//! Random numbers of a study. Each purpose has its own generator. Therefore, the numbers for one
//! purpose do not depend on how many numbers other purposes use.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A seeded generator. The same seed and purpose give the same numbers on every machine.
#[derive(Debug, Clone)]
pub(crate) struct Dice(Xoshiro256PlusPlus);

impl Dice {
    /// Creates the generator for a purpose, such as `["order", "P07"]`.
    pub(crate) fn new(seed: u64, purpose: &[&str]) -> Self {
        let mut hash = blake3::Hasher::new();
        hash.update(&seed.to_le_bytes());
        for part in purpose {
            // The length separates the parts: `ab`, `c` must not give the same numbers as `a`,
            // `bc`.
            hash.update(&(part.len() as u64).to_le_bytes());
            hash.update(part.as_bytes());
        }
        Self(Xoshiro256PlusPlus::from_seed(*hash.finalize().as_bytes()))
    }

    /// Returns the next 64 bits.
    pub(crate) fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Returns a number below `count`, each with the same probability; 0 if `count` is 0.
    fn below(&mut self, count: u64) -> u64 {
        // Numbers above the largest multiple of `count` are drawn again. They would favour small
        // remainders.
        let most = u64::MAX - u64::MAX % count.max(1);
        loop {
            let bits = self.bits();
            if bits < most {
                return bits % count.max(1);
            }
        }
    }

    /// Shuffles a list so that every order has the same probability (Fisher and Yates).
    pub(crate) fn shuffle<T>(&mut self, list: &mut [T]) {
        for last in (1..list.len()).rev() {
            let other = self.below(last as u64 + 1) as usize;
            list.swap(last, other);
        }
    }

    /// Returns the numbers below `count` in random order.
    pub(crate) fn permutation(&mut self, count: usize) -> Vec<usize> {
        let mut all: Vec<usize> = (0..count).collect();
        self.shuffle(&mut all);
        all
    }

    /// Returns a number with mean 0 and standard deviation 1: the sum of twelve uniform numbers
    /// minus 6. It is nearly normal within ±3, and exactly the same on every machine.
    pub(crate) fn normal(&mut self) -> f64 {
        let unit = |bits: u64| (bits >> 11) as f64 / (1u64 << 53) as f64;
        (0..12).map(|_| unit(self.bits())).sum::<f64>() - 6.0
    }
}
