//! Random generators side by side in vector registers.

use crate::uniform::Uniform;

/// Number of generators, and of numbers per step.
pub(crate) const LANES: usize = 8;

/// Eight xoshiro128++ generators (Blackman and Vigna 2021). A seed determines their states. Each
/// has a period of 2¹²⁸ - 1.
#[derive(Debug, Clone)]
pub(crate) struct RandomLanes<const N: usize = LANES>([[u32; N]; 4]);

impl RandomLanes {
    pub(crate) fn new(seed: u64) -> Self {
        let mut uniform = Uniform::new(seed);
        Self([(); 4].map(|()| [(); LANES].map(|()| uniform.next_bits() as u32)))
    }
}

impl RandomLanes<{ 2 * LANES }> {
    /// Combines two sets of generators side by side.
    #[inline(always)]
    pub(crate) fn beside(first: &RandomLanes, second: &RandomLanes) -> Self {
        let mut both = Self([[0; 2 * LANES]; 4]);
        for (k, both) in both.0.iter_mut().enumerate() {
            both[..LANES].copy_from_slice(&first.0[k]);
            both[LANES..].copy_from_slice(&second.0[k]);
        }
        both
    }

    /// Writes the states back to the two sets.
    #[inline(always)]
    pub(crate) fn part(&self, first: &mut RandomLanes, second: &mut RandomLanes) {
        for (k, both) in self.0.iter().enumerate() {
            first.0[k].copy_from_slice(&both[..LANES]);
            second.0[k].copy_from_slice(&both[LANES..]);
        }
    }
}

impl<const N: usize> RandomLanes<N> {
    /// Returns the next 32 bits of each generator.
    #[inline(always)]
    pub(crate) fn next_bits(&mut self) -> [u32; N] {
        let [a, b, c, d] = &mut self.0;
        let mut bits = [0; N];
        for i in 0..N {
            bits[i] = a[i].wrapping_add(d[i]).rotate_left(7).wrapping_add(a[i]);
            let shifted = b[i] << 9;
            c[i] ^= a[i];
            d[i] ^= b[i];
            b[i] ^= c[i];
            a[i] ^= d[i];
            c[i] ^= shifted;
            d[i] = d[i].rotate_left(11);
        }
        bits
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand_core::{Rng, SeedableRng};
    use rand_xoshiro::Xoshiro128PlusPlus;

    #[test]
    fn each_lane_matches_the_reference_generator() {
        let mut lanes = RandomLanes::new(3);
        let seed = |i: usize| {
            let mut bytes = [0; 16];
            for (to, state) in bytes.chunks_mut(4).zip(lanes.0) {
                to.copy_from_slice(&state[i].to_le_bytes());
            }
            bytes
        };
        let mut others: [_; LANES] =
            core::array::from_fn(|i| Xoshiro128PlusPlus::from_seed(seed(i)));
        for _ in 0..1_000 {
            let expected = others.each_mut().map(|other| other.next_u32());
            assert_eq!(lanes.next_bits(), expected);
        }
    }
}
