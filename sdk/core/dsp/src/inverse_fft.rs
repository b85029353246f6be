//! Inverse FFT from a half spectrum to a real signal, bit-identical on every machine.
//!
//! Other FFT libraries use different instructions on different processors, so their rounding
//! differs between processors. These libraries are also slow in WASM. This FFT (Stockham, radices 2
//! to 5) is plain arithmetic on arrays. Compilers vectorise it in native libraries and in WASM
//! modules.
//!
//! The FFT is used only for noise frames. Their lengths have no prime factors above 5, so these
//! radices suffice.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use crate::butterflies::{Butterfly, Five, Four, Three, Two};
use crate::lanes::{Lanes, WIDTH};
use crate::wide::{Work, wide};

/// Inverse real FFT of one even length, with precomputed tables.
#[derive(Debug, Clone)]
pub(crate) struct InverseRealFft {
    half: usize,
    stages: Vec<Stage>,
    /// `exp(2πi k / len)` for each `k` below `half`.
    fold: Twiddles,
}

/// Working memory for transforms of one length.
#[derive(Debug, Clone)]
pub(crate) struct Workspace {
    from: Complexes,
    to: Complexes,
}

/// One pass of the transform, by one radix. Butterfly `i` reads the points `i + count j` for each
/// `j` below the radix. With `i = stride p + q`, it writes the points `radix stride p + stride k +
/// q` for each `k` below the radix.
#[derive(Debug, Clone)]
struct Stage {
    radix: usize,
    stride: usize,
    /// Number of butterflies in the stage.
    count: usize,
    /// Number of successive groups that have the same twiddles. A group is [`WIDTH`] butterflies.
    /// The number is 1 if the stride is not a multiple of the width. Such a stage writes its
    /// results in groups first, and then spreads them to their places.
    groups: usize,
    /// `exp(2πi p k / length)` for each run of these groups and each `k`: cosines, then sines.
    twiddles: Vec<[Lanes; 2]>,
}

/// Complex numbers. Real and imaginary parts are in separate arrays, as vector instructions need
/// them.
#[derive(Debug, Clone, Default)]
struct Complexes {
    re: Vec<f32>,
    im: Vec<f32>,
}

type Twiddles = Vec<(f32, f32)>;

const LARGEST_RADIX: usize = 5;

/// Returns the smallest number that is at least `least` and has no prime factor above 5.
pub(crate) fn smooth_length(least: usize) -> usize {
    let is_smooth = |n: &usize| factors(*n).is_some();
    // The search starts at 1, because `factors` would never end for 0.
    (least.max(1)..).find(is_smooth).unwrap_or(least)
}

impl InverseRealFft {
    /// Makes a transform to `2 * half` samples. If `half` has a prime factor above 5, the transform
    /// uses the next larger number without such a factor.
    pub(crate) fn new(half: usize) -> Self {
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
    pub(crate) fn workspace(&self) -> Workspace {
        Workspace { from: Complexes::zeros(self.half), to: Complexes::zeros(self.half) }
    }

    /// Writes `Σ 2 Re(X_k exp(2πi k n / len))` for each sample `n`.
    ///
    /// The bins `X_k` from `k = first` to `half - 1` are the products of directions (cosines and
    /// sines) and amplitudes. All other bins are zero, and surplus values are ignored. Does not
    /// allocate.
    pub(crate) fn run(
        &self,
        workspace: &mut Workspace,
        first: usize,
        directions: [&[f32]; 2],
        amplitude: &[f32],
        out: &mut [f32],
    ) {
        wide(Transform { fft: self, workspace, first, directions, amplitude, out });
    }

    /// Computes the spectrum of a complex signal: its real parts are the even samples, and its
    /// imaginary parts are the odd samples. With this method, a real signal needs a complex
    /// transform of only half its length.
    #[inline(always)]
    fn fold(&self, to: &mut Complexes, first: usize, [cos, sin]: [&[f32]; 2], amplitude: &[f32]) {
        to.re.fill(0.0);
        to.im.fill(0.0);
        let bins = cos.iter().zip(sin).zip(amplitude);
        // Bin 0 is left out: its mirror image would be point `half`, which does not exist.
        for (k, ((cos, sin), a)) in (first.max(1)..self.half).zip(bins) {
            let (re, im) = (cos * a, sin * a);
            // With X = X_k and w' = -conj(w), bin k adds X + i w X at k, and conj(X) - i w' conj(X)
            // at half - k.
            let (c, s) = self.fold[k];
            let (turned_re, turned_im) = (-(re * s + im * c), re * c - im * s);
            // The values are added and not set, because the bins `k` and `half - k` both contribute
            // to these two points.
            to.re[k] += re + turned_re;
            to.im[k] += im + turned_im;
            to.re[self.half - k] += re - turned_re;
            to.im[self.half - k] += turned_im - im;
        }
    }
}

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
        self.fft.fold(from, self.first, self.directions, self.amplitude);
        for stage in &self.fft.stages {
            stage.run(from, to);
        }
        let half = self.fft.half;
        let parts = from.re[..half].iter().zip(&from.im[..half]);
        // Each complex point is one even and one odd sample of the real signal.
        for (pair, (re, im)) in self.out.as_chunks_mut::<2>().0.iter_mut().zip(parts) {
            *pair = [*re, *im];
        }
    }
}

impl Complexes {
    /// Makes zeros for `len` points. Each row of a stage may have unused lanes after its last
    /// point, so there are some more zeros for these lanes.
    fn zeros(len: usize) -> Self {
        let zeros = || alloc::vec![0.0; len + LARGEST_RADIX * (WIDTH - 1)];
        Self { re: zeros(), im: zeros() }
    }
}

impl Stage {
    fn new(radix: usize, length: usize, stride: usize) -> Self {
        let count = length / radix * stride;
        let groups = if stride.is_multiple_of(WIDTH) { stride / WIDTH } else { 1 };
        let twiddle = |i: usize| {
            let (first, k) = (i / radix * groups * WIDTH, i % radix);
            // Neighbouring lanes often have the same twiddle, so a sine is computed only when `p`
            // changes.
            let (mut of, mut one) = (first / stride, unit(first / stride * k, length));
            let mut both = [Lanes::default(); 2];
            for lane in 0..WIDTH {
                let p = (first + lane) / stride;
                if p != of {
                    (of, one) = (p, unit(p * k, length));
                }
                (both[0].0[lane], both[1].0[lane]) = one;
            }
            both
        };
        Self {
            radix,
            stride,
            count,
            groups,
            twiddles: (0..radix * count.div_ceil(groups * WIDTH)).map(twiddle).collect(),
        }
    }

    /// Transforms the points in `from`; `to` is used as working memory.
    #[inline(always)]
    fn run(&self, from: &mut Complexes, to: &mut Complexes) {
        match self.radix {
            2 => self.run_by::<2, Two>(from, to),
            3 => self.run_by::<3, Three>(from, to),
            4 => self.run_by::<4, Four>(from, to),
            _ => self.run_by::<5, Five>(from, to),
        }
        if self.stride.is_multiple_of(WIDTH) {
            core::mem::swap(from, to);
        }
    }

    /// Transforms by one radix. The results are in `to` if the stride is a multiple of [`WIDTH`],
    /// otherwise in `from`.
    #[inline(always)]
    fn run_by<const R: usize, B: Butterfly<R>>(&self, from: &mut Complexes, to: &mut Complexes) {
        self.turn::<R, B>(from, to);
        match self.stride {
            1 => {
                spread_first::<R>(&to.re, &mut from.re);
                spread_first::<R>(&to.im, &mut from.im);
            }
            s if !s.is_multiple_of(WIDTH) => {
                self.spread(&to.re, &mut from.re);
                self.spread(&to.im, &mut from.im);
            }
            _ => {}
        }
    }

    /// Computes the butterflies of `from` and writes them to `to`. It handles `groups * WIDTH`
    /// butterflies at a time. For these, it writes first all results with `k = 0`, then all with
    /// `k = 1`, and so on.
    #[inline(always)]
    fn turn<const R: usize, B: Butterfly<R>>(&self, from: &Complexes, to: &mut Complexes) {
        let run = self.groups * WIDTH;
        let twiddles = self.twiddles.as_chunks::<R>().0;
        let out_re = to.re.chunks_exact_mut(R * run);
        let out = out_re.zip(to.im.chunks_exact_mut(R * run));
        for ((i, twiddle), (out_re, out_im)) in twiddles.iter().enumerate().zip(out) {
            let rows = |x| core::array::from_fn(|j| groups(x, run * i + self.count * j, run));
            let (re, im): ([_; R], [_; R]) = (rows(&from.re), rows(&from.im));
            let out_re = rows_mut::<R>(out_re, run);
            let out_im = rows_mut::<R>(out_im, run);
            for q in 0..self.groups {
                let (mut now_re, mut now_im) = ([Lanes::default(); R], [Lanes::default(); R]);
                for j in 0..R {
                    now_re[j] = Lanes(re[j][q]);
                    now_im[j] = Lanes(im[j][q]);
                }
                let (re, im) = B::turn(now_re, now_im);
                for k in 0..R {
                    let [cos, sin] = twiddle[k];
                    out_re[k][q] = (re[k] * cos - im[k] * sin).0;
                    out_im[k][q] = (im[k] * cos + re[k] * sin).0;
                }
            }
        }
    }

    /// Copies results to the places of their points. In the source, each group of [`WIDTH`]
    /// butterflies has first all its results with `k = 0`, then all with `k = 1`, and so on.
    #[cfg_attr(target_family = "wasm", inline(never))]
    #[cfg_attr(not(target_family = "wasm"), inline(always))]
    fn spread(&self, groups: &[f32], out: &mut [f32]) {
        // Results with the same `p` are neighbours both in the source and in the destination, so
        // several are copied at a time.
        match self.stride {
            s if WIDTH > 4 && s.is_multiple_of(4) => self.spread_by::<4>(groups, out),
            s if s.is_multiple_of(2) => self.spread_by::<2>(groups, out),
            _ => self.spread_by::<1>(groups, out),
        }
    }

    /// Does the same as [`Self::spread`], and copies `N` results at a time.
    #[inline(always)]
    fn spread_by<const N: usize>(&self, groups: &[f32], out: &mut [f32]) {
        let (groups, out) = (groups.as_chunks::<N>().0, out.as_chunks_mut::<N>().0);
        let (radix, stride, width) = (self.radix, self.stride / N, WIDTH / N);
        let mut i = 0;
        let points = out.chunks_exact_mut(radix * stride);
        for out in points.take(self.count / self.stride) {
            for q in 0..stride {
                let results = &groups[i / width * width * radix + i % width..];
                let results = results.iter().step_by(width);
                for (out, result) in out[q..].iter_mut().step_by(stride).zip(results) {
                    *out = *result;
                }
                i += 1;
            }
        }
    }
}

/// Does the same as [`Stage::spread`] for a first stage, whose stride is 1. Copies whole groups.
#[cfg_attr(target_family = "wasm", inline(never))]
#[cfg_attr(not(target_family = "wasm"), inline(always))]
fn spread_first<const R: usize>(groups: &[f32], out: &mut [f32]) {
    let groups = groups.as_chunks::<WIDTH>().0.as_chunks::<R>().0;
    let out = out.as_chunks_mut::<R>().0.as_chunks_mut::<WIDTH>().0;
    for (out, group) in out.iter_mut().zip(groups) {
        for k in 0..R {
            for i in 0..WIDTH {
                out[i][k] = group[k][i];
            }
        }
    }
}

/// Returns the groups of `len` numbers from `first` on. Because all rows are cut to the same `len`,
/// the compiler knows the bounds of all rows in a loop and omits the check of each index.
#[inline(always)]
fn groups(from: &[f32], first: usize, len: usize) -> &[[f32; WIDTH]] {
    &from[first..first + len].as_chunks().0[..len / WIDTH]
}

/// Returns `R` rows of `len` numbers each.
#[inline(always)]
fn rows_mut<const R: usize>(to: &mut [f32], len: usize) -> [&mut [[f32; WIDTH]]; R] {
    let mut rows = to.chunks_exact_mut(len);
    core::array::from_fn(|_| {
        let row = rows.next().unwrap_or_default().as_chunks_mut().0;
        &mut row[..len / WIDTH]
    })
}

/// `exp(2πi k / length)` as cosine and sine.
fn unit(k: usize, length: usize) -> (f32, f32) {
    // `k % length` keeps the angle within one turn, where its sine is exact to rounding.
    let (sin, cos) = crate::trig::sincos(TAU * (k % length) as f64 / length as f64);
    (cos as f32, sin as f32)
}

/// Returns the radices whose product is `n`, or `None` if `n` has a prime factor above 5. Fours
/// come first, so that all later strides are even.
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
        for half in [4, 6, 10, 15, 16, 45, 48, 90, 120, 500, 810] {
            let bins: Vec<(f32, f32)> =
                (2..half).map(|k| (1.0 / k as f32, 0.3 - 0.01 * k as f32)).collect();
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
