//! Real FFTs of any length in double precision, bit-identical on every machine.
//!
//! Other FFT libraries use different instructions on different processors, so their rounding
//! differs between processors. Those libraries also take sines from the system's C library. The
//! FFTs of this module are plain arithmetic, with tables from `libm`. These FFTs use Stockham's
//! algorithm (radices 2 to 5 and 7). For lengths with other prime factors they use Bluestein's
//! algorithm.

use alloc::vec::Vec;
use core::f64::consts::TAU;

use num_complex::Complex;

use complex::{ComplexFft, Points};

mod complex;

/// FFT of real signals of one length. The value contains its tables and working memory.
///
/// ```
/// use htex_dsp::fft::RealFft;
/// let mut fft = RealFft::new(4);
/// let mut bins = fft.make_bins();
/// fft.forward(&[1.0, 0.0, -1.0, 0.0], &mut bins);
/// assert_eq!(bins.iter().map(|bin| bin.re).collect::<Vec<_>>(), [0.0, 2.0, 0.0]);
/// ```
#[derive(Debug, Clone)]
pub struct RealFft {
    len: usize,
    /// A transform of half the length if the length is even, otherwise of the whole length.
    complex: ComplexFft,
    points: Points,
    /// `exp(2πi k / len)` for each `k` below half the length, if the length is even.
    fold: Vec<Complex<f64>>,
}

impl RealFft {
    /// Makes a transform of `len` samples.
    pub fn new(len: usize) -> Self {
        let (points, folds) = if len.is_multiple_of(2) { (len / 2, len / 2) } else { (len, 0) };
        Self {
            len,
            complex: ComplexFft::new(points),
            points: Points::zeros(points),
            fold: (0..folds).map(|k| unit(k, len)).collect(),
        }
    }

    /// Makes a buffer for a spectrum: `len / 2 + 1` bins, from 0 Hz to half the sample rate.
    pub fn make_bins(&self) -> Vec<Complex<f64>> {
        alloc::vec![Complex::ZERO; self.len / 2 + 1]
    }

    /// Writes `X_k = Σ x_n exp(-2πi k n / len)`. Samples beyond the length are ignored, and missing
    /// samples count as zero. Does not allocate.
    pub fn forward(&mut self, samples: &[f64], bins: &mut [Complex<f64>]) {
        let samples = &samples[..samples.len().min(self.len)];
        if self.len.is_multiple_of(2) {
            let pair = |pair: &[f64]| [pair[0], pair.get(1).copied().unwrap_or(0.0)];
            self.points.fill(samples.chunks(2).map(pair));
            self.complex.forward(&mut self.points);
            self.unfold(bins);
        } else {
            self.points.fill(samples.iter().map(|x| [*x, 0.0]));
            self.complex.forward(&mut self.points);
            for (k, bin) in bins.iter_mut().enumerate().take(self.len / 2 + 1) {
                *bin = self.points.point(k);
            }
        }
    }

    /// Writes `x_n = Re X_0 + Σ 2 Re(X_k exp(2πi k n / len))`. If the length is even, the last bin
    /// has the factor 1 instead of 2. The result is `len` times the signal that has this spectrum.
    /// Missing bins count as zero. Does not allocate.
    pub fn inverse(&mut self, bins: &[Complex<f64>], samples: &mut [f64]) {
        let len = self.len;
        let bin = |k: usize| bins.get(k).copied().unwrap_or_default();
        // Drops imaginary parts that the spectrum of a real signal cannot have.
        let bin =
            |k: usize| if k == 0 || 2 * k == len { Complex::new(bin(k).re, 0.0) } else { bin(k) };
        if len.is_multiple_of(2) {
            let folded = self.fold.iter().enumerate().map(|(k, turn)| {
                let (x, mirrored) = (bin(k), bin(len / 2 - k).conj());
                let odd = (x - mirrored) * turn;
                [x.re + mirrored.re - odd.im, x.im + mirrored.im + odd.re]
            });
            self.points.fill(folded);
            self.complex.inverse(&mut self.points);
            for (n, pair) in samples.chunks_mut(2).enumerate().take(len / 2) {
                let z = self.points.point(n);
                pair.iter_mut().zip([z.re, z.im]).for_each(|(x, z)| *x = z);
            }
        } else {
            let whole = (0..len).map(|k| if k <= len / 2 { bin(k) } else { bin(len - k).conj() });
            self.points.fill(whole.map(|x| [x.re, x.im]));
            self.complex.inverse(&mut self.points);
            for (n, x) in samples.iter_mut().enumerate().take(len) {
                *x = self.points.point(n).re;
            }
        }
    }

    /// Computes the spectrum of the real signal. It is given the spectrum of a complex signal: the
    /// real parts are the even samples, and the imaginary parts are the odd samples.
    fn unfold(&self, bins: &mut [Complex<f64>]) {
        let half = self.fold.len();
        for (k, bin) in bins.iter_mut().enumerate().take(half) {
            // `% half`, because bin 0 is its own mirror image.
            let (z, mirrored) = (self.points.point(k), self.points.point((half - k) % half).conj());
            let (even, odd) = ((z + mirrored) * 0.5, (z - mirrored) * 0.5);
            // The sum over the odd samples is divided by i.
            let odd = Complex::new(odd.im, -odd.re) * self.fold[k].conj();
            *bin = even + odd;
        }
        // A transform of length 0 also has this bin, but has no point from which to compute it.
        if let (Some(last), true) = (bins.get_mut(half), half > 0) {
            let z = self.points.point(0);
            *last = Complex::new(z.re - z.im, 0.0);
        }
    }
}

/// `exp(2πi k / length)`.
fn unit(k: usize, length: usize) -> Complex<f64> {
    let (sin, cos) = libm::sincos(TAU * (k % length) as f64 / length as f64);
    Complex::new(cos, sin)
}

#[cfg(test)]
mod tests {
    use alloc::sync::Arc;

    use proptest::prelude::*;
    use realfft::{ComplexToReal, RealFftPlanner, RealToComplex};

    use super::*;

    fn peers(len: usize) -> (Arc<dyn RealToComplex<f64>>, Arc<dyn ComplexToReal<f64>>) {
        let mut planner = RealFftPlanner::new();
        (planner.plan_fft_forward(len), planner.plan_fft_inverse(len))
    }

    proptest! {
        /// The results equal rustfft's for all kinds of lengths: products of small primes, primes,
        /// and odd numbers.
        #[test]
        fn transforms_equal_those_of_rustfft(
            len in prop_oneof![1..400usize, Just(4_000), Just(8_820), Just(9_600), Just(2_205), Just(4_003), Just(10_006)],
            seed in any::<u64>(),
        ) {
            let mut noise = crate::noise::GaussianNoise::new(seed);
            let signal: Vec<f64> = (0..len).map(|_| f64::from(noise.next_sample())).collect();
            let (forward, inverse) = peers(len);

            let mut fft = RealFft::new(len);
            let mut bins = fft.make_bins();
            fft.forward(&signal, &mut bins);
            let mut expected = forward.make_output_vec();
            forward.process(&mut signal.clone(), &mut expected).unwrap();
            let size = (len as f64).sqrt();
            for (x, y) in bins.iter().zip(&expected) {
                prop_assert!((x - y).norm() < 1e-14 * size * size.ln().max(1.0), "{len}: {x} {y}");
            }

            let mut back = alloc::vec![0.0; len];
            fft.inverse(&bins, &mut back);
            let mut again = alloc::vec![0.0; len];
            inverse.process(&mut expected, &mut again).unwrap();
            for ((x, y), z) in back.iter().zip(&again).zip(&signal) {
                prop_assert!((x - y).abs() < 1e-13 * len as f64, "{len}: {x} {y}");
                prop_assert!((x - z * len as f64).abs() < 1e-13 * len as f64, "{len}: {x} {z}");
            }
        }
    }

    #[test]
    fn missing_samples_and_bins_are_zero() {
        let mut fft = RealFft::new(6);
        let mut bins = fft.make_bins();
        fft.forward(&[1.0, 2.0, 3.0], &mut bins);
        let mut whole = fft.make_bins();
        fft.forward(&[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 9.0], &mut whole);
        assert_eq!(bins, whole);
        let mut samples = [7.0; 6];
        fft.inverse(&[], &mut samples);
        assert_eq!(samples, [0.0; 6]);
    }
}
