//! Complex FFTs of any length.

use alloc::boxed::Box;
use alloc::vec::Vec;

use num_complex::Complex;

use super::unit;
use crate::butterflies::{Butterfly, Five, Four, Seven, Three, Two};
use crate::wide::{Work, wide};

/// Complex numbers. Real and imaginary parts are in separate arrays, as vector instructions need
/// them.
#[derive(Debug, Clone)]
pub(super) struct Points {
    re: Vec<f64>,
    im: Vec<f64>,
}

impl Points {
    pub(super) fn zeros(len: usize) -> Self {
        Self { re: alloc::vec![0.0; len], im: alloc::vec![0.0; len] }
    }

    /// Replaces the points by these; remaining points become zero.
    pub(super) fn fill(&mut self, points: impl Iterator<Item = [f64; 2]>) {
        let points = points.chain(core::iter::repeat([0.0; 2]));
        let parts = self.re.iter_mut().zip(&mut self.im);
        parts.zip(points).for_each(|((re, im), z)| [*re, *im] = z);
    }

    pub(super) fn point(&self, k: usize) -> Complex<f64> {
        Complex::new(self.re[k], self.im[k])
    }

    fn swap_parts(&mut self) {
        core::mem::swap(&mut self.re, &mut self.im);
    }
}

/// Complex FFT of one length.
#[derive(Debug, Clone)]
pub(super) enum ComplexFft {
    /// For a length whose prime factors are 2, 3, 5 and 7.
    Stages { stages: Vec<Stage>, to: Points },
    /// For any other length.
    Chirp(Box<Chirp>),
}

impl ComplexFft {
    pub(super) fn new(len: usize) -> Self {
        let Some(radices) = radices(len) else {
            return Self::Chirp(Box::new(Chirp::new(len)));
        };
        let (mut length, mut stride) = (len, 1);
        let stages = radices.into_iter().map(|radix| {
            let stage = Stage::new(radix, length, stride);
            (length, stride) = (length / radix, stride * radix);
            stage
        });
        Self::Stages { stages: stages.collect(), to: Points::zeros(len) }
    }

    /// Replaces `x_n` by `Σ x_n exp(-2πi k n / len)`.
    pub(super) fn forward(&mut self, points: &mut Points) {
        // Exchanging the real and imaginary parts turns sums with positive exponents into sums with
        // negative exponents.
        points.swap_parts();
        self.inverse(points);
        points.swap_parts();
    }

    /// Replaces `X_k` by `Σ X_k exp(2πi k n / len)`.
    pub(super) fn inverse(&mut self, points: &mut Points) {
        match self {
            Self::Stages { stages, to } => wide(Transform { stages, points, to }),
            Self::Chirp(chirp) => chirp.run(points),
        }
    }
}

/// A transform by stages.
struct Transform<'a> {
    stages: &'a [Stage],
    points: &'a mut Points,
    to: &'a mut Points,
}

impl Work for Transform<'_> {
    #[inline(always)]
    fn run(self) {
        for stage in self.stages {
            match stage.radix {
                2 => stage.run::<2, Two>(self.points, self.to),
                3 => stage.run::<3, Three>(self.points, self.to),
                4 => stage.run::<4, Four>(self.points, self.to),
                5 => stage.run::<5, Five>(self.points, self.to),
                _ => stage.run::<7, Seven>(self.points, self.to),
            }
            core::mem::swap(self.points, self.to);
        }
    }
}

/// One pass of the transform, by one radix. Butterfly `i` reads the points `i + count j` for each
/// `j` below the radix. With `i = stride p + q`, it writes the points `radix stride p + stride k +
/// q` for each `k` below the radix.
#[derive(Debug, Clone)]
pub(super) struct Stage {
    radix: usize,
    stride: usize,
    /// Number of butterflies in the stage.
    count: usize,
    /// `exp(2πi p k / length)` for each `p` and each `k`.
    twiddles: Vec<Complex<f64>>,
}

impl Stage {
    fn new(radix: usize, length: usize, stride: usize) -> Self {
        let twiddle = |i: usize| unit(i / radix * (i % radix), length);
        Self {
            radix,
            stride,
            count: length / radix * stride,
            twiddles: (0..length).map(twiddle).collect(),
        }
    }

    #[inline(always)]
    fn run<const R: usize, B: Butterfly<R>>(&self, from: &Points, to: &mut Points) {
        let twiddles = self.twiddles.as_chunks::<R>().0;
        let (re, im) = (rows::<R>(&from.re, self.count), rows::<R>(&from.im, self.count));
        let out_re = to.re.chunks_exact_mut(R * self.stride);
        let out = out_re.zip(to.im.chunks_exact_mut(R * self.stride));
        for ((p, twiddle), (out_re, out_im)) in twiddles.iter().enumerate().zip(out) {
            let (re, im) = (parts(re, p, self.stride), parts(im, p, self.stride));
            let (out_re, out_im) =
                (rows_mut::<R>(out_re, self.stride), rows_mut::<R>(out_im, self.stride));
            for q in 0..self.stride {
                let (re, im) = B::turn(re.map(|row| row[q]), im.map(|row| row[q]));
                for k in 0..R {
                    let turn = twiddle[k];
                    out_re[k][q] = re[k] * turn.re - im[k] * turn.im;
                    out_im[k][q] = im[k] * turn.re + re[k] * turn.im;
                }
            }
        }
    }
}

/// Returns `R` rows of `len` numbers each.
#[inline(always)]
fn rows<const R: usize>(from: &[f64], len: usize) -> [&[f64]; R] {
    core::array::from_fn(|j| &from[j * len..][..len])
}

/// Returns part `p` of each row. A part has `len` numbers.
#[inline(always)]
fn parts<const R: usize>(rows: [&[f64]; R], p: usize, len: usize) -> [&[f64]; R] {
    core::array::from_fn(|j| &rows[j][p * len..][..len])
}

/// Returns `R` rows of `len` numbers each.
#[inline(always)]
fn rows_mut<const R: usize>(to: &mut [f64], len: usize) -> [&mut [f64]; R] {
    let mut rows = to.chunks_exact_mut(len);
    core::array::from_fn(|_| &mut rows.next().unwrap_or_default()[..len])
}

/// Bluestein's algorithm. Because `k n = (k² + n² - (k - n)²) / 2`, a transform is a convolution
/// with the chirp `exp(-πi n² / len)`. The convolution is computed by transforms of a longer
/// length.
#[derive(Debug, Clone)]
pub(super) struct Chirp {
    /// `exp(πi n² / len)`.
    chirp: Vec<Complex<f64>>,
    /// The transform of the conjugate chirp over the longer length, divided by that length.
    kernel: Points,
    longer: ComplexFft,
    work: Points,
}

impl Chirp {
    fn new(len: usize) -> Self {
        // The chirp has the period `2 len` in `n²`. Reducing `n²` in whole numbers keeps the angle
        // within one turn, where its sine is precise.
        let (square, turn) = (|n: usize| n * n % (2 * len), 2 * len);
        let chirp: Vec<_> = (0..len).map(|n| unit(square(n), turn)).collect();
        // A convolution of this length does not wrap around. Its only prime factors are 2, 3 and 5,
        // so `longer` is never a chirp itself.
        let long = crate::inverse_fft::smooth_length(2 * len - 1);
        let mut longer = ComplexFft::new(long);
        let mut kernel = Points::zeros(long);
        for (n, x) in chirp.iter().enumerate() {
            // The chirp is the same for `-n`. The values are set and not added, because for `n = 0`
            // both places are the same.
            for at in [n, (long - n) % long] {
                kernel.re[at] = x.re / long as f64;
                kernel.im[at] = -x.im / long as f64;
            }
        }
        longer.forward(&mut kernel);
        Self { work: Points::zeros(long), chirp, kernel, longer }
    }

    fn run(&mut self, points: &mut Points) {
        let turned = self.chirp.iter().enumerate().map(|(n, turn)| {
            let z = points.point(n) * turn;
            [z.re, z.im]
        });
        self.work.fill(turned);
        self.longer.forward(&mut self.work);
        for k in 0..self.work.re.len() {
            let z = self.work.point(k) * self.kernel.point(k);
            [self.work.re[k], self.work.im[k]] = [z.re, z.im];
        }
        self.longer.inverse(&mut self.work);
        let turned = self.chirp.iter().enumerate().map(|(k, turn)| {
            let z = self.work.point(k) * turn;
            [z.re, z.im]
        });
        points.fill(turned);
    }
}

/// Returns the radices whose product is `n`. The list is empty if `n` is 0. Returns `None` if `n`
/// has a prime factor above 7. Large radices come first, so that strides become long early.
fn radices(mut n: usize) -> Option<Vec<usize>> {
    let mut radices = Vec::new();
    for radix in [4, 7, 5, 3, 2] {
        while n > 0 && n.is_multiple_of(radix) {
            radices.push(radix);
            n /= radix;
        }
    }
    (n <= 1).then_some(radices)
}
