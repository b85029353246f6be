//! Vectors that contain one number for each of four voices. In a recursive filter each sample
//! depends on the sample before it. Therefore, successive samples cannot be computed at the same
//! time. Instead, the lanes of a vector register contain samples of different voices.

use core::ops::{Add, Mul, Sub};

use crate::biquad;
use crate::wide::{Work, wide};

/// Number of voices side by side.
pub const VOICES: usize = 4;

/// One number for each of four voices.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Quad(pub [f64; VOICES]);

/// Number type of a filter: the number of one voice, or the numbers of four voices. Both types do
/// the same operations in the same order.
pub(crate) trait Real:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self>
{
    const ZERO: Self;
    fn without_denormals(self) -> Self;
}

impl Real for f64 {
    const ZERO: Self = 0.0;

    #[inline(always)]
    fn without_denormals(self) -> Self {
        biquad::without_denormals(self)
    }
}

impl Quad {
    /// Interleaves four rows in single precision, one for each voice, and multiplies each row by
    /// the voice's gain. The shortest slice determines the length.
    pub fn gather(rows: [&[f32]; VOICES], gains: Self, to: &mut [Self]) {
        wide(Gather(rows, gains, to));
    }

    /// Writes each voice's numbers to its row, in single precision. The shortest slice determines
    /// the length.
    pub fn scatter(from: &[Self], rows: [&mut [f32]; VOICES]) {
        wide(Scatter(from, rows));
    }
}

/// Interleaves the first `N` of the `M` numbers of each of four voices.
#[inline(always)]
pub(crate) fn beside<const N: usize, const M: usize>(
    [a, b, c, d]: [&[f64; M]; VOICES],
) -> [Quad; N] {
    let mut quads = [Quad::ZERO; N];
    for i in 0..N {
        quads[i] = Quad([a[i], b[i], c[i], d[i]]);
    }
    quads
}

/// Returns the numbers of one voice.
#[inline(always)]
pub(crate) fn part<const N: usize>(quads: &[Quad; N], voice: usize) -> [f64; N] {
    let mut own = [0.0; N];
    for i in 0..N {
        own[i] = quads[i].0[voice];
    }
    own
}

struct Gather<'a>([&'a [f32]; VOICES], Quad, &'a mut [Quad]);

impl Work for Gather<'_> {
    #[inline(always)]
    fn run(self) {
        let Self([a, b, c, d], Quad(gains), to) = self;
        for ((((to, a), b), c), d) in to.iter_mut().zip(a).zip(b).zip(c).zip(d) {
            let row = [*a, *b, *c, *d];
            for i in 0..VOICES {
                to.0[i] = gains[i] * f64::from(row[i]);
            }
        }
    }
}

struct Scatter<'a>(&'a [Quad], [&'a mut [f32]; VOICES]);

impl Work for Scatter<'_> {
    #[inline(always)]
    fn run(self) {
        let Self(from, [a, b, c, d]) = self;
        for ((((from, a), b), c), d) in from.iter().zip(a).zip(b).zip(c).zip(d) {
            [*a, *b, *c, *d] = from.0.map(|x| x as f32);
        }
    }
}

impl Real for Quad {
    const ZERO: Self = Self([0.0; VOICES]);

    #[inline(always)]
    fn without_denormals(self) -> Self {
        Self(self.0.map(biquad::without_denormals))
    }
}

impl Add for Quad {
    type Output = Self;

    #[inline(always)]
    fn add(mut self, other: Self) -> Self {
        for i in 0..VOICES {
            self.0[i] += other.0[i];
        }
        self
    }
}

impl Sub for Quad {
    type Output = Self;

    #[inline(always)]
    fn sub(mut self, other: Self) -> Self {
        for i in 0..VOICES {
            self.0[i] -= other.0[i];
        }
        self
    }
}

impl Mul for Quad {
    type Output = Self;

    #[inline(always)]
    fn mul(mut self, other: Self) -> Self {
        for i in 0..VOICES {
            self.0[i] *= other.0[i];
        }
        self
    }
}
