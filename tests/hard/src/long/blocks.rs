//! Repeated blocks.

use std::collections::HashSet;

/// Samples in a block.
pub(super) const LENGTH: usize = 64;

/// Hashes of blocks with 64 samples. Two different blocks have the same hash with probability 2⁻⁶⁴.
#[derive(Debug, Default)]
pub struct Blocks(HashSet<u64>);

impl Blocks {
    /// Makes a set without blocks.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds the blocks of some samples, ignoring an incomplete one at the end. Returns how many of
    /// them had been added before.
    pub fn add(&mut self, samples: &[f32]) -> u64 {
        let (blocks, _) = samples.as_chunks::<LENGTH>();
        blocks.iter().filter(|block| !self.0.insert(hash(block))).count() as u64
    }

    /// Number of blocks.
    pub fn len(&self) -> usize {
        self.0.len()
    }

    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }
}

/// Hashes all bits, multiplied and folded sample by sample.
fn hash(block: &[f32; LENGTH]) -> u64 {
    block.iter().fold(0x9e37_79b9_7f4a_7c15, |hash, x| {
        let mixed = (hash ^ u64::from(x.to_bits())).wrapping_mul(0xff51_afd7_ed55_8ccd);
        mixed ^ (mixed >> 32)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_block_that_comes_back_is_found_and_a_neighbour_is_not() {
        let mut blocks = Blocks::new();
        let mut x: Vec<f32> = (0..6_400).map(|i| i as f32).collect();
        assert_eq!(blocks.add(&x), 0);
        assert_eq!(blocks.add(&x[640..1_300]), 10);
        x[0] = f32::from_bits(x[0].to_bits() + 1);
        assert_eq!(blocks.add(&x[..64]), 0);
        assert_eq!(blocks.len(), 101);
    }
}
