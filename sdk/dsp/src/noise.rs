//! Seeded random numbers: uniform phases and Gaussian noise.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// A seeded stream of uniform numbers; the same seed gives the same bits on every machine.
#[derive(Debug, Clone)]
pub struct Uniform(Xoshiro256PlusPlus);

impl Uniform {
    /// Starts the stream of `seed`.
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// The next number in `[0, 1)`, with 53 random bits.
    pub fn next_unit(&mut self) -> f64 {
        (self.0.next_u64() >> 11) as f64 * (1.0 / (1u64 << 53) as f64)
    }
}

/// White Gaussian noise of zero mean and unit variance (Marsaglia's polar method, which needs only
/// a logarithm and a square root, both from `libm`).
#[derive(Debug, Clone)]
pub struct GaussianNoise {
    uniform: Uniform,
    spare: Option<f64>,
}

impl GaussianNoise {
    /// Starts the stream of `seed`.
    pub fn new(seed: u64) -> Self {
        Self {
            uniform: Uniform::new(seed),
            spare: None,
        }
    }

    /// The next sample.
    pub fn next_sample(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        loop {
            let x = 2.0 * self.uniform.next_unit() - 1.0;
            let y = 2.0 * self.uniform.next_unit() - 1.0;
            let s = x * x + y * y;
            if s > 0.0 && s < 1.0 {
                let scale = libm::sqrt(-2.0 * libm::log(s) / s);
                self.spare = Some(y * scale);
                return x * scale;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn gaussian_moments_are_those_of_the_normal_law() {
        let mut noise = GaussianNoise::new(7);
        let n = 1_000_000;
        let (mut m1, mut m2, mut m4) = (0.0, 0.0, 0.0);
        for _ in 0..n {
            let x = noise.next_sample();
            m1 += x;
            m2 += x * x;
            m4 += x * x * x * x;
        }
        let n = f64::from(n);
        // Standard errors: 0.001, 0.0014, 0.0098; five of each.
        assert!((m1 / n).abs() < 0.005);
        assert!((m2 / n - 1.0).abs() < 0.007);
        assert!((m4 / n - 3.0).abs() < 0.05);
    }
}
