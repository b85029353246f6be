//! Seeded random numbers: uniform phases and Gaussian noise.

use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

use crate::lanes::{LANES, Lanes};
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

    /// Cosines and sines of angles that are uniform on the circle, exact to 3e-7; as many as there
    /// is room for in both.
    ///
    /// An angle in the right half plane, and both signs turned or not: two short series do, and
    /// nothing branches.
    pub fn fill_directions(&mut self, cos: &mut [f32], sin: &mut [f32]) {
        let (cos, last_cos) = cos.as_chunks_mut();
        let (sin, last_sin) = sin.as_chunks_mut();
        let mut own = self.0.clone();
        for (cos, sin) in cos.iter_mut().zip(sin) {
            directions(&mut own, cos, sin);
        }
        if !last_cos.is_empty() {
            let (mut cos, mut sin) = ([0.0; DIRECTIONS], [0.0; DIRECTIONS]);
            directions(&mut own, &mut cos, &mut sin);
            last_cos.copy_from_slice(&cos[..last_cos.len()]);
            let rest = last_sin.len().min(DIRECTIONS);
            last_sin.copy_from_slice(&sin[..rest]);
        }
        self.0 = own;
    }
}

/// Directions that are made at once.
const DIRECTIONS: usize = LANES;
const QUARTER: f32 = core::f32::consts::FRAC_PI_2 / (1u32 << 31) as f32;
const TERMS: usize = 7;
/// Taylor coefficients of the cosine, and of the sine over its angle, in the square of the angle.
/// Up to a quarter turn less than 1e-8 is left out.
const TAYLOR: [[f32; 2]; TERMS] = taylor();

const fn taylor() -> [[f32; 2]; TERMS] {
    let mut exact = [[1.0f64; 2]; TERMS];
    let mut terms = [[1.0; 2]; TERMS];
    let mut i = 1;
    while i < TERMS {
        let n = 2.0 * i as f64;
        exact[i][0] = -exact[i - 1][0] / (n * (n - 1.0));
        exact[i][1] = -exact[i - 1][1] / (n * (n + 1.0));
        terms[i] = [exact[i][0] as f32, exact[i][1] as f32];
        i += 1;
    }
    terms
}

#[inline(always)]
fn directions(
    random: &mut Xoshiro256PlusPlus,
    cos: &mut [f32; DIRECTIONS],
    sin: &mut [f32; DIRECTIONS],
) {
    let mut bits = [0u32; DIRECTIONS];
    for two in bits.as_chunks_mut::<2>().0 {
        let both = random.next_u64();
        *two = [both as u32, (both >> 32) as u32];
    }
    // The upper bits, signed, are the angle; the lowest one decides the half plane.
    let angle = Lanes(bits.map(|bits| bits as i32 as f32)) * QUARTER;
    let square = angle * angle;
    let (mut c, mut s) = (Lanes::default(), Lanes::default());
    for [next_c, next_s] in TAYLOR.iter().rev() {
        c = c * square + Lanes([*next_c; DIRECTIONS]);
        s = s * square + Lanes([*next_s; DIRECTIONS]);
    }
    s = s * angle;
    for i in 0..DIRECTIONS {
        cos[i] = f32::from_bits(c.0[i].to_bits() ^ (bits[i] << 31));
    }
    for i in 0..DIRECTIONS {
        sin[i] = f32::from_bits(s.0[i].to_bits() ^ (bits[i] << 31));
    }
}

/// White Gaussian noise of zero mean and unit variance (a ziggurat: one random number and one
/// multiplication a sample, nearly always).
#[derive(Debug, Clone)]
pub struct GaussianNoise {
    uniform: Uniform,
    rare: Uniform,
    spare: Option<f64>,
}

impl GaussianNoise {
    /// Starts the stream of `seed`.
    pub fn new(seed: u64) -> Self {
        let mut uniform = Uniform::new(seed);
        Self {
            rare: Uniform::new(uniform.next_bits()),
            uniform,
            spare: None,
        }
    }

    /// The next sample; [`Self::fill`] is several times faster.
    pub fn next_sample(&mut self) -> f64 {
        if let Some(spare) = self.spare.take() {
            return spare;
        }
        let mut pair = [[0.0; 2]];
        self.fill(&mut pair);
        let [[first, second]] = pair;
        self.spare = Some(second);
        first
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
        let (mut cos, mut sin) = (alloc::vec![0.0; 100_003], alloc::vec![0.0; 100_003]);
        uniform.fill_directions(&mut cos, &mut sin);
        for (cos, sin) in cos.into_iter().zip(sin) {
            let (cos, sin) = (f64::from(cos), f64::from(sin));
            assert!((cos * cos + sin * sin - 1.0).abs() < 6e-7);
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
