//! Inverse FFT of a half spectrum to a real signal, bit-identical on every machine.
//!
//! Library FFTs choose instructions, and thereby rounding, by the processor. This one (Stockham, radices 2 to
//! 5) is plain arithmetic on arrays, which compilers vectorise in native libraries and WASM modules alike.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use crate::lanes::{Lanes, Number};
use crate::wide::{Work, wide};

/// Whether code for wider registers than WASM has, which takes bytes of its own, is worth them.
const WIDE: bool = !cfg!(target_family = "wasm");

/// Inverse real FFT of one even length, with its precomputed tables.
///
/// ```
/// use htex_dsp::inverse_fft::InverseRealFft;
/// let fft = InverseRealFft::new(4);
/// let mut out = [0.0; 8];
/// fft.run(&mut fft.workspace(), 1, [&[1.0], &[0.0]], &[0.5], &mut out);
/// assert!((out[0] - 1.0).abs() < 1e-6 && (out[4] + 1.0).abs() < 1e-6);
/// ```
#[derive(Debug, Clone)]
pub struct InverseRealFft {
    half: usize,
    stages: Vec<Stage>,
    /// `exp(2πi k / len)`, one for each `k` below `half`.
    fold: Twiddles,
}

/// Working memory for transforms of one length.
#[derive(Debug, Clone)]
pub struct Workspace {
    from: Complexes,
    to: Complexes,
}

/// One radix: `length` points, `stride` of them at a time.
#[derive(Debug, Clone)]
struct Stage {
    radix: usize,
    length: usize,
    stride: usize,
    /// `exp(2πi p k / length)` for each `p`, and `k` in 0 to `radix - 1`.
    twiddles: Twiddles,
    /// The same in the order of a first stage, which goes along `p`: all `p` of each `k`, cosines and sines apart.
    along: Complexes,
}

/// Real and imaginary parts apart, as vector instructions want them.
#[derive(Debug, Clone, Default)]
struct Complexes {
    re: Vec<f32>,
    im: Vec<f32>,
}

type Twiddles = Vec<(f32, f32)>;

/// The smallest number from `least` on without a prime factor above 5.
///
/// ```
/// assert_eq!(htex_dsp::inverse_fft::smooth_length(519), 540);
/// ```
pub fn smooth_length(least: usize) -> usize {
    let is_smooth = |n: &usize| factors(*n).is_some();
    (least.max(1)..).find(is_smooth).unwrap_or(least)
}

impl InverseRealFft {
    /// A transform to `2 * half` samples. If `half` is not a [`smooth_length`], the next one is used.
    pub fn new(half: usize) -> Self {
        let half = smooth_length(half);
        let (mut length, mut stride) = (half, 1);
        let stages = factors(half).unwrap_or_default().into_iter().map(|radix| {
            let stage = Stage::new(radix, length, stride);
            (length, stride) = (length / radix, stride * radix);
            stage
        });
        Self {
            stages: stages.collect(),
            fold: (0..half).map(|k| unit(k, 2 * half)).collect(),
            half,
        }
    }

    /// Allocates the memory for [`Self::run`].
    pub fn workspace(&self) -> Workspace {
        Workspace {
            from: Complexes::zeros(self.half),
            to: Complexes::zeros(self.half),
        }
    }

    /// Writes `Σ 2 Re(X_k exp(2πi k n / len))` over `n`. The bins from `first` on, in 1 to `half - 1`, are
    /// directions (cosines and sines) times amplitudes; other bins are zero and surplus values are ignored.
    /// Does not allocate.
    pub fn run(
        &self,
        workspace: &mut Workspace,
        first: usize,
        directions: [&[f32]; 2],
        amplitude: &[f32],
        out: &mut [f32],
    ) {
        wide(Transform {
            fft: self,
            workspace,
            first,
            directions,
            amplitude,
            out,
        });
    }

    /// Computes from the real signal's spectrum that of the complex signal whose parts are its even and odd
    /// samples.
    #[inline(always)]
    fn fold(&self, to: &mut Complexes, first: usize, [cos, sin]: [&[f32]; 2], amplitude: &[f32]) {
        to.re.fill(0.0);
        to.im.fill(0.0);
        let bins = cos.iter().zip(sin).zip(amplitude);
        for (k, ((cos, sin), a)) in (first.max(1)..self.half).zip(bins) {
            let (re, im) = (cos * a, sin * a);
            // X_k adds X + i w X at k, and conj(X) - i w' conj(X) at half - k, where w' = -conj(w).
            let (c, s) = self.fold[k];
            let (turned_re, turned_im) = (-(re * s + im * c), re * c - im * s);
            to.re[k] += re + turned_re;
            to.im[k] += im + turned_im;
            to.re[self.half - k] += re - turned_re;
            to.im[self.half - k] += turned_im - im;
        }
    }
}

/// One transform.
struct Transform<'a> {
    fft: &'a InverseRealFft,
    workspace: &'a mut Workspace,
    first: usize,
    directions: [&'a [f32]; 2],
    amplitude: &'a [f32],
    out: &'a mut [f32],
}

impl Work for Transform<'_> {
    #[inline(always)]
    fn run(self) {
        let Workspace { from, to } = self.workspace;
        self.fft
            .fold(from, self.first, self.directions, self.amplitude);
        for stage in &self.fft.stages {
            stage.run(from, to);
            core::mem::swap(from, to);
        }
        let parts = from.re.iter().zip(&from.im);
        for (pair, (re, im)) in self.out.as_chunks_mut::<2>().0.iter_mut().zip(parts) {
            *pair = [*re, *im];
        }
    }
}

impl Complexes {
    fn zeros(len: usize) -> Self {
        let zeros = || alloc::vec![0.0; len];
        Self {
            re: zeros(),
            im: zeros(),
        }
    }
}

impl Stage {
    fn new(radix: usize, length: usize, stride: usize) -> Self {
        let twiddle = |i: usize| unit(i / radix * (i % radix), length);
        let parts = length / radix;
        let along = |i: usize| unit(i % parts * (i / parts), length);
        let (re, im) = match stride {
            1 if WIDE => (0..length).map(along).unzip(),
            _ => Default::default(),
        };
        Self {
            radix,
            length,
            stride,
            twiddles: (0..length).map(twiddle).collect(),
            along: Complexes { re, im },
        }
    }

    #[inline(always)]
    fn run(&self, from: &Complexes, to: &mut Complexes) {
        match self.stride {
            1 if WIDE => self.run_first(from, to),
            s if WIDE && s.is_multiple_of(8) => self.run_on::<Lanes<8>>(from, to),
            s if s.is_multiple_of(4) => self.run_on::<Lanes<4>>(from, to),
            _ => self.run_on::<f32>(from, to),
        }
    }

    #[inline(always)]
    fn run_on<T: Number>(&self, from: &Complexes, to: &mut Complexes) {
        match self.radix {
            2 => self.run_by::<2, T, Two>(from, to),
            3 => self.run_by::<3, T, Three>(from, to),
            4 => self.run_by::<4, T, Four>(from, to),
            _ => self.run_by::<5, T, Five>(from, to),
        }
    }

    /// The stage of stride 1, whose neighbours are those of `p`.
    #[inline(always)]
    fn run_first(&self, from: &Complexes, to: &mut Complexes) {
        match self.radix {
            2 => self.run_along::<2, Two>(from, to),
            3 => self.run_along::<3, Three>(from, to),
            4 => self.run_along::<4, Four>(from, to),
            _ => self.run_along::<5, Five>(from, to),
        }
    }

    #[inline(always)]
    fn run_along<const R: usize, B: Butterfly<R>>(&self, from: &Complexes, to: &mut Complexes) {
        let eights = self.length / R / 8 * 8;
        self.part_along::<R, Lanes<8>, B>(from, to, 0..eights);
        self.part_along::<R, f32, B>(from, to, eights..self.length / R);
    }

    /// As many neighbours as there are in a `T` at a time.
    #[inline(always)]
    fn part_along<const R: usize, T: Number, B: Butterfly<R>>(
        &self,
        from: &Complexes,
        to: &mut Complexes,
        range: core::ops::Range<usize>,
    ) {
        let parts = self.length / R;
        for p in range.step_by(T::LEN) {
            let (mut re, mut im) = ([T::default(); R], [T::default(); R]);
            for j in 0..R {
                re[j] = load::<T>(&from.re, p + parts * j);
                im[j] = load::<T>(&from.im, p + parts * j);
            }
            let (re, im) = B::turn(re, im);
            let out_re = &mut to.re[R * p..R * (p + T::LEN)];
            let out_im = &mut to.im[R * p..R * (p + T::LEN)];
            for k in 0..R {
                let cos = load::<T>(&self.along.re, p + parts * k);
                let sin = load::<T>(&self.along.im, p + parts * k);
                let new_re = re[k].times(cos) - im[k].times(sin);
                let new_im = im[k].times(cos) + re[k].times(sin);
                for i in 0..T::LEN {
                    out_re[R * i + k] = new_re.number(i);
                    out_im[R * i + k] = new_im.number(i);
                }
            }
        }
    }

    #[inline(always)]
    fn run_by<const R: usize, T: Number, B: Butterfly<R>>(
        &self,
        from: &Complexes,
        to: &mut Complexes,
    ) {
        let (s, parts) = (self.stride, self.length / R);
        let twiddles = self.twiddles.as_chunks::<R>().0;
        let out_re = to.re.chunks_exact_mut(R * s);
        let out = out_re.zip(to.im.chunks_exact_mut(R * s));
        for ((p, twiddle), (out_re, out_im)) in twiddles.iter().enumerate().zip(out) {
            let rows = |x| core::array::from_fn(|j| groups::<T>(x, s * (p + parts * j), s));
            let (re, im): ([_; R], [_; R]) = (rows(&from.re), rows(&from.im));
            let out_re = rows_mut::<R, T>(out_re, s);
            let out_im = rows_mut::<R, T>(out_im, s);
            for q in 0..s / T::LEN {
                let (mut now_re, mut now_im) = ([T::default(); R], [T::default(); R]);
                for j in 0..R {
                    now_re[j] = T::load(re[j][q]);
                    now_im[j] = T::load(im[j][q]);
                }
                let (re, im) = B::turn(now_re, now_im);
                for k in 0..R {
                    let (cos, sin) = twiddle[k];
                    out_re[k][q] = (re[k] * cos - im[k] * sin).store();
                    out_im[k][q] = (im[k] * cos + re[k] * sin).store();
                }
            }
        }
    }
}

/// The numbers from `at` on.
#[inline(always)]
fn load<T: Number>(from: &[f32], at: usize) -> T {
    T::load(T::groups(&from[at..at + T::LEN])[0])
}

/// A transform of `R` numbers, real and imaginary parts apart. A trait, as functions that are passed are not always
/// compiled into the one that has the wide registers.
trait Butterfly<const R: usize> {
    fn turn<T: Number>(re: [T; R], im: [T; R]) -> ([T; R], [T; R]);
}

struct Two;
struct Three;
struct Four;
struct Five;

/// The groups of `len` numbers from `first` on. What the bounds of all rows of a loop are known by is
/// this length: nothing is checked at each number.
#[inline(always)]
fn groups<T: Number>(from: &[f32], first: usize, len: usize) -> &[T::Group] {
    &T::groups(&from[first..first + len])[..len / T::LEN]
}

/// `R` rows of `len` numbers each.
#[inline(always)]
fn rows_mut<const R: usize, T: Number>(to: &mut [f32], len: usize) -> [&mut [T::Group]; R] {
    let mut rows = to.chunks_exact_mut(len);
    core::array::from_fn(|_| {
        let row = T::groups_mut(rows.next().unwrap_or_default());
        &mut row[..len / T::LEN]
    })
}

impl Butterfly<2> for Two {
    #[inline(always)]
    fn turn<T: Number>([a, b]: [T; 2], [ai, bi]: [T; 2]) -> ([T; 2], [T; 2]) {
        ([a + b, a - b], [ai + bi, ai - bi])
    }
}

impl Butterfly<3> for Three {
    #[inline(always)]
    fn turn<T: Number>(re: [T; 3], im: [T; 3]) -> ([T; 3], [T; 3]) {
        const SIN: f32 = 0.866_025_4;
        let (sum, sum_i) = (re[1] + re[2], im[1] + im[2]);
        let (turned, turned_i) = ((im[2] - im[1]) * SIN, (re[1] - re[2]) * SIN);
        let (mean, mean_i) = (re[0] - sum * 0.5, im[0] - sum_i * 0.5);
        (
            [re[0] + sum, mean + turned, mean - turned],
            [im[0] + sum_i, mean_i + turned_i, mean_i - turned_i],
        )
    }
}

impl Butterfly<4> for Four {
    #[inline(always)]
    fn turn<T: Number>(re: [T; 4], im: [T; 4]) -> ([T; 4], [T; 4]) {
        let (even, even_i) = Two::turn([re[0], re[2]], [im[0], im[2]]);
        let (odd, odd_i) = Two::turn([re[1], re[3]], [im[1], im[3]]);
        (
            [
                even[0] + odd[0],
                even[1] - odd_i[1],
                even[0] - odd[0],
                even[1] + odd_i[1],
            ],
            [
                even_i[0] + odd_i[0],
                even_i[1] + odd[1],
                even_i[0] - odd_i[0],
                even_i[1] - odd[1],
            ],
        )
    }
}

impl Butterfly<5> for Five {
    #[inline(always)]
    fn turn<T: Number>(re: [T; 5], im: [T; 5]) -> ([T; 5], [T; 5]) {
        let (sum, sum_i) = (sums(re), sums(im));
        let (mean, mean_i) = (fifths(re[0], sum), fifths(im[0], sum_i));
        let (t, t_i) = (turned(im), turned(re));
        (
            [
                re[0] + (sum[0] + sum[1]),
                mean[0] - t[0],
                mean[1] - t[1],
                mean[1] + t[1],
                mean[0] + t[0],
            ],
            [
                im[0] + (sum_i[0] + sum_i[1]),
                mean_i[0] + t_i[0],
                mean_i[1] + t_i[1],
                mean_i[1] - t_i[1],
                mean_i[0] - t_i[0],
            ],
        )
    }
}

#[inline(always)]
fn sums<T: Number>(x: [T; 5]) -> [T; 2] {
    [x[1] + x[4], x[2] + x[3]]
}

/// By the cosines of one and of two fifths of a turn.
#[inline(always)]
fn fifths<T: Number>(first: T, [a, b]: [T; 2]) -> [T; 2] {
    const COS: [f32; 2] = [0.309_017, -0.809_017];
    [
        first + (a * COS[0] + b * COS[1]),
        first + (a * COS[1] + b * COS[0]),
    ]
}

/// By the sines of one and of two fifths of a turn.
#[inline(always)]
fn turned<T: Number>(x: [T; 5]) -> [T; 2] {
    const SIN: [f32; 2] = [0.951_056_54, 0.587_785_25];
    let [a, b] = [x[1] - x[4], x[2] - x[3]];
    [a * SIN[0] + b * SIN[1], a * SIN[1] - b * SIN[0]]
}

/// `exp(2πi k / length)` as cosine and sine.
fn unit(k: usize, length: usize) -> (f32, f32) {
    let (sin, cos) = libm::sincos(TAU * (k % length) as f64 / length as f64);
    (cos as f32, sin as f32)
}

/// The radices whose product is `n`; `None` if there is a prime above 5. Fours come first: later
/// strides are then even.
fn factors(mut n: usize) -> Option<Vec<usize>> {
    let mut factors = Vec::new();
    for radix in [4, 2, 3, 5] {
        while n.is_multiple_of(radix) {
            factors.push(radix);
            n /= radix;
        }
    }
    (n == 1).then_some(factors)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_transform_equals_the_direct_sum() {
        for half in [4, 6, 10, 15, 16, 45, 48, 120, 500] {
            let bins: Vec<(f32, f32)> = (2..half)
                .map(|k| (1.0 / k as f32, 0.3 - 0.01 * k as f32))
                .collect();
            let mut out = alloc::vec![0.0; 2 * half];
            let (re, im): (Vec<f32>, Vec<f32>) = bins.iter().copied().unzip();
            let fft = InverseRealFft::new(half);
            let ones = alloc::vec![1.0; re.len()];
            fft.run(&mut fft.workspace(), 2, [&re, &im], &ones, &mut out);
            let size: f64 = bins.iter().map(|(re, im)| f64::from(re.hypot(*im))).sum();
            for (n, y) in out.iter().enumerate() {
                let term = |(k, &(re, im)): (usize, &(f32, f32))| {
                    let turn = ((k + 2) * n % (2 * half)) as f64 / (2 * half) as f64;
                    let (s, c) = libm::sincos(TAU * turn);
                    2.0 * (f64::from(re) * c - f64::from(im) * s)
                };
                let expected: f64 = bins.iter().enumerate().map(term).sum();
                let error = (f64::from(*y) - expected).abs() / size;
                assert!(error < 3e-7, "{half}, sample {n}: {error:e} of the largest");
            }
        }
    }
}
