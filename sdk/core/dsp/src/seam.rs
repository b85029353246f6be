//! Seamless loops of samples.
//!
//! A cross-fade joins the end of the loop to its start. The gains of the cross-fade depend on the
//! correlation of the two pieces, so that both noise and tones keep their power.

use alloc::vec::Vec;

/// Smallest correlation for the gains of a cross-fade. At lower correlations the gain would grow
/// without bound.
const LEAST_CORRELATION: f32 = -0.9;

/// An endless loop of samples, joined by a cross-fade that preserves their power.
///
/// ```
/// use htex_dsp::seam::Loop;
/// let mut loop_ = Loop::new(vec![0.0, 1.0, 0.0, -1.0], 0);
/// let mut out = [0.0; 6];
/// loop_.render(&mut out);
/// assert_eq!(out, [0.0, 1.0, 0.0, -1.0, 0.0, 1.0]);
/// ```
#[derive(Debug, Clone)]
pub struct Loop {
    samples: Vec<f32>,
    next: usize,
}

impl Loop {
    /// Makes a loop of `samples`. A cross-fade of `fade` samples (at most half of all samples)
    /// mixes the end of `samples` into the start. Therefore, the loop is `fade` samples shorter
    /// than `samples`.
    ///
    /// The gains of the cross-fade are a sine and a cosine, divided by a common factor. Without
    /// this division, the sum of the two pieces would have a power that depends on their
    /// correlation. The factor is the square root of this power. Noise keeps its power, and a sound
    /// that repeats with the period of the loop stays unchanged.
    pub fn new(mut samples: Vec<f32>, fade: usize) -> Self {
        let fade = fade.min(samples.len() / 2);
        let len = samples.len() - fade;
        let (body, after) = samples.split_at_mut(len);
        let correlation = correlation(&body[..fade], after);
        for (n, (start, after)) in body.iter_mut().zip(after).enumerate() {
            // The offset of half a sample makes the fade symmetric.
            let angle = core::f32::consts::FRAC_PI_2 * (n as f32 + 0.5) / fade as f32;
            let (sin, cos) = (libm::sinf(angle), libm::cosf(angle));
            let power = 1.0 + 2.0 * correlation * sin * cos;
            *start = (sin * *start + cos * *after) / libm::sqrtf(power);
        }
        samples.truncate(len);
        Self { samples, next: 0 }
    }

    /// The samples of one period.
    pub fn samples(&self) -> &[f32] {
        &self.samples
    }

    /// Scales the loop to another RMS. A silent loop stays silent.
    #[must_use]
    pub fn with_rms(mut self, rms: f64) -> Self {
        let squares = self.samples.iter().map(|&x| f64::from(x) * f64::from(x));
        let own = crate::root::sqrt(squares.sum::<f64>() / self.samples.len().max(1) as f64);
        if own > 0.0 {
            let gain = (rms / own) as f32;
            self.samples.iter_mut().for_each(|x| *x *= gain);
        }
        self
    }

    /// Fills `out` with the next samples, or with silence if the loop is empty. Does not allocate.
    pub fn render(&mut self, out: &mut [f32]) {
        if self.samples.is_empty() {
            out.fill(0.0);
            return;
        }
        let mut rest = out;
        while !rest.is_empty() {
            let run = rest.len().min(self.samples.len() - self.next);
            rest[..run].copy_from_slice(&self.samples[self.next..self.next + run]);
            self.next = (self.next + run) % self.samples.len();
            rest = &mut rest[run..];
        }
    }
}

/// Correlation of two pieces of the same length; means are not removed.
fn correlation(a: &[f32], b: &[f32]) -> f32 {
    let sum = |x: &[f32], y: &[f32]| x.iter().zip(y).map(|(x, y)| x * y).sum::<f32>();
    let both = libm::sqrtf(sum(a, a) * sum(b, b));
    if both > 0.0 { (sum(a, b) / both).clamp(LEAST_CORRELATION, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::noise::GaussianNoise;

    const LEN: usize = 1_000;
    const FADE: usize = 200;

    fn white(seed: u64) -> Vec<f32> {
        let mut noise = GaussianNoise::new(seed);
        (0..LEN + FADE).map(|_| noise.next_sample()).collect()
    }

    #[test]
    fn the_seam_has_the_power_of_the_rest() {
        let loops = 400;
        let mut power = [0.0f64; LEN];
        for seed in 0..loops {
            let closed = Loop::new(white(seed), FADE);
            for (sum, x) in power.iter_mut().zip(closed.samples()) {
                *sum += f64::from(x * x) / loops as f64;
            }
        }
        // Each part sums 50 places of 400 loops, so its standard error is 1 %.
        for part in power.chunks(50) {
            let mean = part.iter().sum::<f64>() / part.len() as f64;
            assert!((mean - 1.0).abs() < 0.05, "{mean}");
        }
    }

    #[test]
    fn a_periodic_signal_is_unchanged() {
        let sine = |n: usize| libm::sinf(core::f32::consts::TAU * 7.0 * n as f32 / LEN as f32);
        let mut closed = Loop::new((0..LEN + FADE).map(sine).collect(), FADE);
        let mut out = [0.0; 2 * LEN];
        closed.render(&mut out);
        for (n, x) in out.iter().enumerate() {
            assert!((x - sine(n % LEN)).abs() < 1e-5, "{n}: {x}");
        }
    }

    #[test]
    fn the_loop_is_continuous_for_any_block_size() {
        // The signal is slow and not periodic. The test would find a jump at the seam.
        let slow = |n: usize| libm::sinf(0.0123 * n as f32 + 0.4);
        let closed = Loop::new((0..LEN + FADE).map(slow).collect(), FADE);
        let mut whole = [0.0; 3 * LEN];
        closed.clone().render(&mut whole);
        let steepest = whole.windows(2).map(|w| (w[1] - w[0]).abs());
        assert!(steepest.fold(0.0, f32::max) < 0.05);
        assert_eq!(whole[..LEN], whole[LEN..2 * LEN]);
        let mut parts = [0.0; 3 * LEN];
        let mut again = closed.clone();
        parts.chunks_mut(77).for_each(|part| again.render(part));
        assert_eq!(whole, parts);
        let louder = closed.with_rms(3.0);
        let square = |x: &f32| f64::from(*x).powi(2);
        let power: f64 = louder.samples().iter().map(square).sum();
        assert!((power / LEN as f64 - 9.0).abs() < 1e-5);
    }

    #[test]
    fn degenerate_loops_are_silent() {
        let mut out = [1.0; 3];
        Loop::new(Vec::new(), 5).with_rms(1.0).render(&mut out);
        assert_eq!(out, [0.0; 3]);
        Loop::new(alloc::vec![0.0; 4], 2).with_rms(1.0).render(&mut out);
        assert_eq!(out, [0.0; 3]);
    }
}
