//! Seeded Gaussian noise.
//!
//! The generator uses the Box–Muller transform for eight pairs of numbers at a time. The generator
//! contains its own series for the logarithm, sine and cosine. The series have no branches, so
//! compilers vectorise them, and the results are bit-identical on every machine. On processors with
//! registers of 512 bits, two streams share a register.

use crate::root::sqrt_f32;

use crate::circle::directions;
use crate::random_lanes::{LANES, RandomLanes};
use crate::wide::{Work, very_wide, wide};

/// Number of noise samples that are generated together. Rendering is fastest in whole groups.
pub const GROUP: usize = 2 * LANES;

/// A stream of white Gaussian noise with zero mean and unit variance (Box–Muller transform, single
/// precision). No absolute value exceeds 6.6.
///
/// ```
/// use htex_dsp::noise::GaussianNoise;
/// let mut block = [0.0; 1000];
/// GaussianNoise::new(1).fill(&mut block);
/// let power = block.iter().map(|x| x * x).sum::<f32>() / 1000.0;
/// assert!((power - 1.0).abs() < 0.2);
/// ```
#[derive(Debug, Clone)]
pub struct GaussianNoise {
    random: RandomLanes,
    /// The last group of samples. Some of them may not have been returned yet.
    ready: [f32; GROUP],
    taken: usize,
}

impl GaussianNoise {
    pub fn new(seed: u64) -> Self {
        Self { random: RandomLanes::new(seed), ready: [0.0; GROUP], taken: GROUP }
    }

    /// Returns the next sample; [`Self::fill`] is several times faster.
    pub fn next_sample(&mut self) -> f32 {
        let mut one = [0.0];
        self.fill(&mut one);
        one[0]
    }

    /// Fills one block for each of two streams. The samples are the same as with [`Self::fill`],
    /// but this function may be faster. Does not allocate.
    pub fn fill_both([a, b]: [&mut Self; 2], [x, y]: [&mut [f32]; 2]) {
        // First fills up to the nearer end of the two current groups.
        let head = (GROUP - a.taken.max(b.taken)).min(x.len()).min(y.len());
        let ((x_head, x), (y_head, y)) = (x.split_at_mut(head), y.split_at_mut(head));
        a.fill(x_head);
        b.fill(y_head);
        let done = fill_two([a, b], [x, y]);
        a.fill(&mut x[done..]);
        b.fill(&mut y[done..]);
    }

    /// Fills a block with the next samples; fastest in multiples of [`GROUP`]. Does not allocate.
    pub fn fill(&mut self, out: &mut [f32]) {
        let kept = out.len().min(GROUP - self.taken);
        let (first, rest) = out.split_at_mut(kept);
        first.copy_from_slice(&self.ready[self.taken..self.taken + kept]);
        self.taken += kept;
        let (groups, last) = rest.as_chunks_mut();
        wide(Normals(&mut self.random, groups));
        // The rest of the group is kept for the next call, so that samples do not depend on the
        // block sizes.
        if !last.is_empty() {
            wide(Normals(&mut self.random, core::slice::from_mut(&mut self.ready)));
            last.copy_from_slice(&self.ready[..last.len()]);
            self.taken = last.len();
        }
    }
}

/// Fills whole groups of two streams, if both streams are at the start of a group and the registers
/// are wide enough for both. Returns the number of samples that it wrote to each block.
fn fill_two([a, b]: [&mut GaussianNoise; 2], [x, y]: [&mut [f32]; 2]) -> usize {
    // A stream that is within a group has samples that must come first.
    if a.taken < GROUP || b.taken < GROUP {
        return 0;
    }
    let groups = x.len().min(y.len()) / GROUP;
    let (x, y) = (x.as_chunks_mut().0, y.as_chunks_mut().0);
    let random = [&mut a.random, &mut b.random];
    match very_wide(TwoNormals(random, &mut x[..groups], &mut y[..groups])) {
        Ok(()) => groups * GROUP,
        Err(_) => 0,
    }
}

/// Groups of normally distributed numbers.
struct Normals<'a>(&'a mut RandomLanes, &'a mut [[f32; GROUP]]);

impl Work for Normals<'_> {
    #[inline(always)]
    fn run(self) {
        // A local copy of the generator can stay in registers.
        let mut random = self.0.clone();
        for group in self.1 {
            // The radius is drawn first, and the direction second. With the other order, the same
            // seed would give another sound.
            let radius = radii(random.next_bits());
            let (cos, sin) = directions(random.next_bits());
            for i in 0..LANES {
                group[i] = radius[i] * cos[i];
                group[LANES + i] = radius[i] * sin[i];
            }
        }
        *self.0 = random;
    }
}

/// Number of groups that are computed before their two streams are separated. If each group were
/// separated at once, compilers would use only half of each register.
const PARTED: usize = 8;

/// Groups of normally distributed numbers of two streams.
struct TwoNormals<'a>([&'a mut RandomLanes; 2], &'a mut [[f32; GROUP]], &'a mut [[f32; GROUP]]);

impl Work for TwoNormals<'_> {
    #[inline(always)]
    fn run(self) {
        let Self([first, second], x, y) = self;
        let mut random = RandomLanes::beside(first, second);
        let mut buffer = [[[0.0; 2 * LANES]; 2]; PARTED];
        for (x, y) in x.chunks_mut(PARTED).zip(y.chunks_mut(PARTED)) {
            for [first, second] in &mut buffer[..x.len()] {
                let radius = radii(random.next_bits());
                let (cos, sin) = directions(random.next_bits());
                for i in 0..2 * LANES {
                    first[i] = radius[i] * cos[i];
                    second[i] = radius[i] * sin[i];
                }
            }
            for ((x, y), [first, second]) in x.iter_mut().zip(y).zip(&buffer) {
                x[..LANES].copy_from_slice(&first[..LANES]);
                x[LANES..].copy_from_slice(&second[..LANES]);
                y[..LANES].copy_from_slice(&first[LANES..]);
                y[LANES..].copy_from_slice(&second[LANES..]);
            }
        }
        random.part(first, second);
    }
}

/// Radii of random points in the plane whose two coordinates are normally distributed.
#[inline(always)]
fn radii<const N: usize>(bits: [u32; N]) -> [f32; N] {
    let mut radii = [0.0; N];
    for i in 0..N {
        // The number is in (0, 1], in steps of 2⁻³¹. Its bits are converted as a signed integer, so
        // only 31 of them are used.
        let uniform = ((bits[i] >> 1) as i32 as f32 + 1.0) * (1.0 / (1u32 << 31) as f32);
        radii[i] = -2.0 * ln(uniform);
    }
    for square in &mut radii {
        *square = sqrt_f32(*square);
    }
    radii
}

/// Natural logarithm of a number up to 1. The error is below 2e-7 relative plus 2e-7 absolute.
///
/// The number is split into `m 2ᵉ`, with `m` from √½ to √2. The series for `m` (Moshier, Cephes) is
/// summed in pairs that do not depend on each other.
#[inline(always)]
fn ln(x: f32) -> f32 {
    const SQRT_HALF: u32 = core::f32::consts::FRAC_1_SQRT_2.to_bits();
    const MANTISSA: u32 = (1 << 23) - 1;
    let above = x.to_bits().wrapping_sub(SQRT_HALF);
    let exponent = (above as i32 >> 23) as f32;
    let m = f32::from_bits((above & MANTISSA).wrapping_add(SQRT_HALF)) - 1.0;
    let m2 = m * m;
    let m4 = m2 * m2;
    let cubic =
        (3.333_333_3e-1 + m * -2.499_999_4e-1) + m2 * (2.000_071_5e-1 + m * -1.666_805_8e-1);
    let seventh = (1.424_932_3e-1 + m * -1.242_014_1e-1)
        + m2 * (1.167_699_9e-1 + m * -1.151_461e-1)
        + m4 * 7.037_684e-2;
    (cubic + m4 * seventh) * (m * m2) + (m - 0.5 * m2) + exponent * core::f32::consts::LN_2
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::uniform::Uniform;

    #[test]
    fn logarithms_are_exact_in_all_octaves() {
        let mut uniform = Uniform::new(1);
        for i in 0..310_000 {
            let octave = libm::exp2(-f64::from(i % 31));
            let x = (octave * (1.0 - 0.5 * uniform.next_unit())) as f32;
            let exact = libm::log(x.into());
            let off = (f64::from(ln(x)) - exact).abs();
            assert!(off <= 2e-7 * (1.0 - exact), "{x}: {off}");
        }
        assert_eq!(ln(1.0), 0.0);
    }

    /// Two streams that are filled together equal two streams that are filled separately, at any
    /// position within their groups.
    #[test]
    fn two_streams_filled_together_are_bit_identical() {
        let mut alone = [GaussianNoise::new(1), GaussianNoise::new(2)];
        let mut both = alone.clone();
        for (first, second) in
            [(64, 64), (9, 2), (80, 80), (100, 33), (0, 7), (64, 64), (5, 16), (7, 8), (96, 96)]
        {
            let buffer = || [alloc::vec![0.0; first], alloc::vec![0.0; second]];
            let (mut expected, mut found) = (buffer(), buffer());
            for (noise, out) in alone.iter_mut().zip(&mut expected) {
                noise.fill(out);
            }
            let [x, y] = &mut found;
            GaussianNoise::fill_both(both.each_mut(), [x, y]);
            assert_eq!(found, expected);
        }
    }

    #[test]
    fn directions_are_uniform_on_the_circle() {
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
        // Each sum has a standard error of 224.
        assert!(sums.iter().all(|sum| sum.abs() < 1_100.0), "{sums:?}");
    }

    #[test]
    fn gaussian_moments_match_the_normal_distribution() {
        let mut noise = GaussianNoise::new(7);
        let n = 1_000_000;
        let (mut m1, mut m2, mut m4) = (0.0, 0.0, 0.0);
        let mut beyond = [0.0; 4];
        let edges = [1.0, 2.0, 3.0, 4.0];
        let mut block = [0.0; 1_000];
        for i in 0..n {
            if i % 1_000 == 0 {
                noise.fill(&mut block);
            }
            let x = f64::from(block[i % 1_000]);
            m1 += x;
            m2 += x * x;
            m4 += x * x * x * x;
            for (count, edge) in beyond.iter_mut().zip(edges) {
                *count += f64::from(u8::from(x.abs() > edge));
            }
        }
        let n = n as f64;
        // The standard errors are 0.001, 0.0014 and 0.0098. Each tolerance is five standard errors.
        assert!((m1 / n).abs() < 0.005);
        assert!((m2 / n - 1.0).abs() < 0.007);
        assert!((m4 / n - 3.0).abs() < 0.05);
        for (count, p) in beyond.iter().zip([0.317_311, 0.045_500, 0.002_700, 0.000_063_3]) {
            assert!((count / n - p).abs() < 5.0 * libm::sqrt(p / n), "{p}: {count}");
        }
    }
}
