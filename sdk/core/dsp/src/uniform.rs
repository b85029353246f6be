//! Seeded uniform random numbers.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::circle::directions;

/// Number of directions per step.
const DIRECTIONS: usize = 4;

/// A seeded generator of uniform numbers; the same seed gives the same bits on every machine.
///
/// ```
/// use htex_dsp::uniform::Uniform;
/// let (mut a, mut b) = (Uniform::new(7), Uniform::new(7));
/// let x = a.next_unit();
/// assert!((0.0..1.0).contains(&x) && x == b.next_unit());
/// ```
#[derive(Debug, Clone)]
pub struct Uniform(Xoshiro256PlusPlus);

impl Uniform {
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// The next number in `[0, 1)`, with 53 random bits.
    pub fn next_unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }

    /// The next 64 random bits.
    pub(crate) fn next_bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Writes the cosines and sines of random angles that are uniform on the circle. The errors are
    /// below 3e-7. The shorter slice determines the number of angles.
    pub fn fill_directions(&mut self, cos: &mut [f32], sin: &mut [f32]) {
        for (cos, sin) in cos.chunks_mut(DIRECTIONS).zip(sin.chunks_mut(DIRECTIONS)) {
            let mut bits = [0; DIRECTIONS];
            for two in bits.as_chunks_mut::<2>().0 {
                let both = self.0.next_u64();
                *two = [both as u32, (both >> 32) as u32];
            }
            let (new_cos, new_sin) = directions(bits);
            cos.copy_from_slice(&new_cos[..cos.len()]);
            sin.copy_from_slice(&new_sin[..sin.len()]);
        }
    }
}
