//! Seeded random numbers: uniform phases and Gaussian noise.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::ziggurat;

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

    /// The next 64 random bits.
    pub fn next_bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// Hands 64 random bits to each item.
    #[inline(always)]
    pub(crate) fn each_bits<T>(&mut self, items: &mut [T], mut set: impl FnMut(&mut T, u64)) {
        // A generator of its own, which nothing else can see, stays in registers.
        let mut own = self.0.clone();
        items.iter_mut().for_each(|item| set(item, own.next_u64()));
        self.0 = own;
    }

    /// Cosine and sine of an angle that is uniform on the circle, exact to 1e-12.
    ///
    /// An angle in the right half plane, and both signs turned or not: two short series do, and
    /// nothing branches.
    #[inline]
    pub fn next_direction(&mut self) -> (f64, f64) {
        let bits = self.next_bits();
        // The upper 53 bits, signed; the lowest one decides the half plane.
        let angle =
            ((bits as i64) >> 11) as f64 * (core::f64::consts::FRAC_PI_2 / (1u64 << 52) as f64);
        let turn = |x: f64| f64::from_bits(x.to_bits() ^ (bits << 63));
        let [cos, sin_over_angle] = series(angle * angle);
        (turn(cos), turn(angle * sin_over_angle))
    }
}

const TERMS: usize = 9;
/// Taylor coefficients of the cosine, and of the sine over its angle, in the square of the angle.
/// Up to a quarter turn less than 1e-12 is left out.
const TAYLOR: [[f64; 2]; TERMS] = taylor();

const fn taylor() -> [[f64; 2]; TERMS] {
    let mut terms = [[1.0; 2]; TERMS];
    let mut i = 1;
    while i < TERMS {
        let n = 2.0 * i as f64;
        terms[i][0] = -terms[i - 1][0] / (n * (n - 1.0));
        terms[i][1] = -terms[i - 1][1] / (n * (n + 1.0));
        i += 1;
    }
    terms
}

/// Both series at once, as a vector of two.
#[inline]
fn series(z: f64) -> [f64; 2] {
    let step = |[c, s]: [f64; 2], [next_c, next_s]: &[f64; 2]| [c * z + next_c, s * z + next_s];
    TAYLOR.iter().rev().fold([0.0; 2], step)
}

/// White Gaussian noise of zero mean and unit variance (a ziggurat: one random number and one
/// multiplication a sample, nearly always).
#[derive(Debug, Clone)]
pub struct GaussianNoise {
    uniform: Uniform,
    rare: Uniform,
}

impl GaussianNoise {
    /// Starts the stream of `seed`.
    pub fn new(seed: u64) -> Self {
        let mut uniform = Uniform::new(seed);
        Self {
            rare: Uniform::new(uniform.next_bits()),
            uniform,
        }
    }

    /// Fills a block with the next samples, two at a time.
    pub fn fill(&mut self, out: &mut [[f64; 2]]) {
        ziggurat::fill(&mut self.uniform, &mut self.rare, out);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn directions_lie_on_the_circle_all_around() {
        let mut uniform = Uniform::new(1);
        let mut sums = [0.0; 4];
        for _ in 0..100_000 {
            let (cos, sin) = uniform.next_direction();
            assert!((cos * cos + sin * sin - 1.0).abs() < 1e-11);
            let moments = [cos, sin, cos * cos - sin * sin, 2.0 * cos * sin];
            sums.iter_mut().zip(moments).for_each(|(sum, x)| *sum += x);
        }
        // Standard error 224 each.
        assert!(sums.iter().all(|sum| sum.abs() < 1_100.0), "{sums:?}");
    }

    #[test]
    fn gaussian_moments_are_those_of_the_normal_law() {
        let mut noise = GaussianNoise::new(7);
        let n = 1_000_000;
        let (mut m1, mut m2, mut m4) = (0.0, 0.0, 0.0);
        // Beyond 1, 2, 3 and the ziggurat's last layer.
        let mut beyond = [0.0; 4];
        let edges = [1.0, 2.0, 3.0, 3.654_152_885_361_009];
        let mut block = [[0.0; 2]; 500];
        for i in 0..n {
            if i % 1_000 == 0 {
                noise.fill(&mut block);
            }
            let x = block.as_flattened()[i % 1_000];
            m1 += x;
            m2 += x * x;
            m4 += x * x * x * x;
            for (count, edge) in beyond.iter_mut().zip(edges) {
                *count += f64::from(u8::from(x.abs() > edge));
            }
        }
        let n = n as f64;
        // Standard errors: 0.001, 0.0014, 0.0098; five of each.
        assert!((m1 / n).abs() < 0.005);
        assert!((m2 / n - 1.0).abs() < 0.007);
        assert!((m4 / n - 3.0).abs() < 0.05);
        for (count, p) in beyond
            .iter()
            .zip([0.317_311, 0.045_500, 0.002_700, 0.000_258])
        {
            assert!(
                (count / n - p).abs() < 5.0 * libm::sqrt(p / n),
                "{p}: {count}"
            );
        }
    }
}
