//! Random numbers in 32-bit arithmetic.

/// Factor that gives the sum of four centred 16-bit numbers unit variance. The variance of the sum
/// is `4 (2^32 - 1) / 12`.
const UNIT: f32 = 2.642_894_3e-5;

/// The random generator xoshiro128++ (Blackman and Vigna 2021), seeded by SplitMix32.
#[derive(Debug, Clone)]
pub(crate) struct Random {
    state: [u32; 4],
}

impl Random {
    pub(crate) const ZERO: Self = Self { state: [0; 4] };

    pub(crate) fn new(seed: u32) -> Self {
        let mut counter = seed;
        let mut next = || {
            counter = counter.wrapping_add(0x9E37_79B9);
            let mut z = counter;
            z = (z ^ (z >> 16)).wrapping_mul(0x85EB_CA6B);
            z = (z ^ (z >> 13)).wrapping_mul(0xC2B2_AE35);
            z ^ (z >> 16)
        };
        // SplitMix32 is a bijection, so successive outputs differ and are not all zero.
        Self { state: [next(), next(), next(), next()] }
    }

    pub(crate) fn bits(&mut self) -> u32 {
        let [a, b, c, d] = &mut self.state;
        let result = a.wrapping_add(*d).rotate_left(7).wrapping_add(*a);
        let shifted = *b << 9;
        *c ^= *a;
        *d ^= *b;
        *b ^= *c;
        *a ^= *d;
        *c ^= shifted;
        *d = d.rotate_left(11);
        result
    }

    /// Returns white noise of unit variance and zero mean: a sum of four uniform numbers.
    pub(crate) fn noise(&mut self) -> f32 {
        let (x, y) = (self.bits(), self.bits());
        let sum = (x & 0xFFFF) + (x >> 16) + (y & 0xFFFF) + (y >> 16);
        // The mean of the sum is a whole number, so it is subtracted without an error. No sample
        // exceeds 3.47.
        (sum as i32 - 2 * 0xFFFF) as f32 * UNIT
    }
}
