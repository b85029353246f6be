//! Linear-phase FIR filters with a given magnitude.

use alloc::vec::Vec;

use crate::polyphase::dot;

const CHUNK: usize = 256;

/// A streaming linear-phase FIR filter.
#[derive(Debug, Clone)]
pub struct Fir {
    /// The symmetric kernel, padded with zeros to a multiple of eight.
    kernel: Vec<f32>,
    /// The last `kernel.len() - 1` samples, followed by space for one chunk.
    history: Vec<f32>,
}

impl Fir {
    /// Makes a filter whose magnitude approximates `magnitude(hertz)` from 0 to half of `rate_hz`.
    /// `taps` is rounded up to an odd number. The design is frequency sampling with a Hann window,
    /// so the resolution is about `4 · rate_hz / taps` hertz. The delay is half the length of the
    /// filter.
    pub fn with_magnitude(taps: usize, rate_hz: f64, magnitude: impl Fn(f64) -> f64) -> Self {
        let taps = taps.max(1) | 1;
        let half = taps / 2;
        // The frequency grid is fine, so that the truncated impulse response does not alias in
        // time.
        let bins = (4 * taps).max(64);
        let sampled: Vec<f64> =
            (0..=bins).map(|k| magnitude(0.5 * rate_hz * k as f64 / bins as f64)).collect();
        let cosine: Vec<f64> = (0..2 * bins)
            .map(|i| libm::cos(core::f64::consts::PI * i as f64 / bins as f64))
            .collect();
        let at = |lag: usize| {
            // The product `k * lag` is reduced in whole numbers, so a table of one period of
            // cosines is exact for every product.
            let term = |k: usize| sampled[k] * cosine[k * lag % (2 * bins)];
            let ends = 0.5 * (term(0) + term(bins));
            (ends + (1..bins).map(term).sum::<f64>()) / bins as f64
        };
        let window = |lag: usize| {
            // The window ends one sample outside the kernel, so that the outermost coefficients are
            // not zero.
            let x = core::f64::consts::PI * lag as f64 / (half + 1) as f64;
            0.5 + 0.5 * libm::cos(x)
        };
        let side: Vec<f64> = (0..=half).map(|lag| at(lag) * window(lag)).collect();
        let kernel = (0..taps).map(|i| side[i.abs_diff(half)] as f32).collect();
        Self::new(kernel)
    }

    /// Makes a filter that passes its input unchanged, without delay.
    pub fn through() -> Self {
        Self::new(alloc::vec![1.0])
    }

    fn new(mut kernel: Vec<f32>) -> Self {
        // Reversed, because the newest sample is multiplied by the last coefficient.
        kernel.reverse();
        let padded = kernel.len().next_multiple_of(8);
        // `dot` takes multiples of eight. Zeros in front are multiplied by the oldest samples, so
        // they add no delay.
        let mut front = alloc::vec![0.0; padded - kernel.len()];
        front.append(&mut kernel);
        Self { history: alloc::vec![0.0; padded - 1 + CHUNK], kernel: front }
    }

    /// Filters in place. Does not allocate.
    pub fn process(&mut self, block: &mut [f32]) {
        let before = self.kernel.len() - 1;
        for chunk in block.chunks_mut(CHUNK) {
            self.history[before..before + chunk.len()].copy_from_slice(chunk);
            for (i, sample) in chunk.iter_mut().enumerate() {
                *sample = dot(&self.kernel, &self.history[i..i + self.kernel.len()]);
            }
            self.history.copy_within(chunk.len()..chunk.len() + before, 0);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sines_get_the_wanted_gain() {
        let rate_hz = 2_000.0;
        let wanted = |f: f64| 1.0 / (0.1 + f / 500.0);
        for f in [60.0, 200.0, 555.0, 900.0] {
            let mut fir = Fir::with_magnitude(251, rate_hz, wanted);
            let mut signal: Vec<f32> = (0..4_000)
                .map(|n| libm::sin(core::f64::consts::TAU * f * n as f64 / rate_hz) as f32)
                .collect();
            signal.chunks_mut(33).for_each(|block| fir.process(block));
            let power: f64 = signal[1_000..].iter().map(|x| f64::from(x * x)).sum();
            let gain = libm::sqrt(2.0 * power / 3_000.0);
            let error_db = 20.0 * libm::log10(gain / wanted(f));
            assert!(error_db.abs() < 0.1, "{f} Hz: {error_db} dB");
        }
    }

    #[test]
    fn the_identity_filter_changes_nothing() {
        let mut block: Vec<f32> = (0..600).map(|n| n as f32).collect();
        let before = block.clone();
        Fir::through().process(&mut block);
        assert_eq!(block, before);
    }
}
