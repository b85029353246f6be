//! A random envelope, which makes stationary noise fluctuate as a recording does.
//!
//! The envelope is `exp(x)`, where x is Gaussian noise with the frequencies 0.5 to 32 Hz. Two
//! parameters are the standard deviations of the slow part (0.5 to 8 Hz) and of the fast part (8 to
//! 32 Hz) of x. The mean square of the envelope is 1. Therefore, the envelope does not change the
//! level of the noise. It also does not change the power in a band that is wider than the range of
//! the envelope's frequencies.
//!
//! At every sample rate, the envelope is computed 500 times a second, and interpolated linearly
//! between these times. Therefore it costs little, and is the same function of time at every rate.

use core::f64::consts::LN_10;

use crate::biquad::{Biquad, Cascade};
use crate::butterworth::{high_pass, low_pass};
use crate::exponential::exponentials;
use crate::noise::GaussianNoise;

/// Edges of the slow and of the fast part, hertz.
pub const PARTS_HZ: [[f64; 2]; 2] = [[0.5, 8.0], [8.0, 32.0]];
/// Rate at which the envelope is computed, hertz.
const CONTROL_HZ: f64 = 500.0;
/// Order of the filters at each edge of a part.
const ORDER: usize = 4;
/// The variance of white noise of variance 1 after the filters of each part.
const VARIANCE: [f64; 2] = [0.030_778_483_466_2, 0.098_116_785_489_8];
/// Correlation of successive values of each part.
const CORRELATION: [f64; 2] = [0.997_772_984_366_6, 0.957_474_394_533_0];
/// Time before the first sample at which the filters start, seconds.
const LEAD_S: f64 = 4.0;
/// Numbers that change the seed. With them, the two noises differ from each other, and from the
/// noise of a voice with the same seed.
const STREAMS: [u64; 2] = [0x666c_7563_7475_6174, 0x696f_6e20_6661_7374];

/// A random envelope with the mean square 1.
///
/// ```
/// use htex_dsp::random_envelope::RandomEnvelope;
/// let mut samples = vec![1.0; 20_000];
/// RandomEnvelope::new([3.0, 2.0], 20_000.0, 7).apply(&mut samples);
/// assert!(samples.iter().all(|x| *x > 0.0));
/// ```
#[derive(Debug, Clone)]
pub struct RandomEnvelope {
    parts: [Part; 2],
    /// Added to the logarithm, so that the mean square is 1.
    offset: f64,
    /// The values before and after the present sample. The field `place` is the sample's place
    /// between them, from 0 to 1.
    between: [f32; 2],
    place: f64,
    step: f64,
}

/// The slow or the fast part of the logarithm.
#[derive(Debug, Clone)]
struct Part {
    noise: GaussianNoise,
    filter: Cascade,
    /// The factor that gives the filtered noise its standard deviation.
    factor: f64,
}

impl RandomEnvelope {
    /// Makes an envelope for samples at `rate_hz`. `strength_db` contains the standard deviations
    /// of the slow and of the fast part of the envelope's logarithm, decibels. Values above 12 are
    /// reduced to 12. A rate that is not positive counts as 500 Hz.
    pub fn new(strength_db: [f64; 2], rate_hz: f64, seed: u64) -> Self {
        // This is not written as `clamp`, because `clamp` would keep NaN.
        #[allow(clippy::manual_clamp)]
        let sigma = strength_db.map(|db| db.max(0.0).min(12.0) * LN_10 / 20.0);
        let part = |i: usize| Part {
            noise: GaussianNoise::new(seed ^ STREAMS[i]),
            filter: Cascade::new(&sections(PARTS_HZ[i])),
            factor: sigma[i] / crate::root::sqrt(VARIANCE[i]),
        };
        let variance = |i: usize| sigma[i] * sigma[i];
        // The mean product of two successive values is `exp(-lost)`, if the mean of their squares
        // is 1.
        let lost: f64 = (0..2).map(|i| variance(i) * (1.0 - CORRELATION[i])).sum();
        let product = libm::exp(-lost);
        // Linear interpolation between the values lowers the mean square to this number.
        let interpolated = (2.0 + product) / 3.0;
        let mut envelope = Self {
            parts: [part(0), part(1)],
            offset: -(variance(0) + variance(1)) - 0.5 * libm::log(interpolated),
            between: [1.0; 2],
            place: 0.0,
            step: if rate_hz > 0.0 { CONTROL_HZ / rate_hz } else { 1.0 },
        };
        for _ in 0..(LEAD_S * CONTROL_HZ) as usize {
            envelope.parts.iter_mut().for_each(|part| {
                part.next();
            });
        }
        envelope.between = core::array::from_fn(|_| envelope.next());
        envelope
    }

    /// Multiplies the next samples by the envelope. The result does not depend on how the samples
    /// are divided into blocks. Does not allocate.
    pub fn apply(&mut self, block: &mut [f32]) {
        for sample in block {
            while self.place >= 1.0 {
                self.place -= 1.0;
                self.between = [self.between[1], self.next()];
            }
            let [from, to] = self.between;
            *sample *= from + (to - from) * self.place as f32;
            self.place += self.step;
        }
    }

    fn next(&mut self) -> f32 {
        let mut value = [self.offset + self.parts[0].next() + self.parts[1].next()];
        exponentials(&mut value);
        value[0] as f32
    }
}

impl Part {
    fn next(&mut self) -> f64 {
        self.factor * self.filter.tick(self.noise.next_sample().into())
    }
}

/// The filters of a part.
fn sections([low_hz, high_hz]: [f64; 2]) -> [Biquad; ORDER] {
    let mut all = [Biquad::IDENTITY; ORDER];
    // Both edges are constants within the range that the filter designs allow, so both designs
    // return sections.
    let edges = [high_pass(ORDER, low_hz, CONTROL_HZ), low_pass(ORDER, high_hz, CONTROL_HZ)];
    let designed = edges.iter().flatten().flat_map(|sections| sections.iter());
    all.iter_mut().zip(designed).for_each(|(section, of)| *section = *of);
    all
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Computes the integrals that give the two constants.
    #[test]
    fn the_filters_leave_this_variance_and_correlation() {
        const STEPS: usize = 20_000;
        for (i, part) in PARTS_HZ.into_iter().enumerate() {
            let filter = Cascade::new(&sections(part));
            let (mut power, mut product) = (0.0, 0.0);
            for k in 0..STEPS {
                let turn = (k as f64 + 0.5) / STEPS as f64;
                let magnitude = filter.magnitude(0.5 * CONTROL_HZ * turn, CONTROL_HZ);
                power += magnitude * magnitude;
                product += magnitude * magnitude * libm::cos(core::f64::consts::PI * turn);
            }
            let found = [power / STEPS as f64, product / power];
            assert!((found[0] / VARIANCE[i] - 1.0).abs() < 1e-6, "{part:?} {found:?}");
            assert!((found[1] - CORRELATION[i]).abs() < 1e-8, "{part:?} {found:?}");
        }
    }

    fn squares(strength_db: [f64; 2], rate_hz: f64, seed: u64, seconds: usize) -> f64 {
        let mut samples = alloc::vec![1.0; seconds * rate_hz as usize];
        RandomEnvelope::new(strength_db, rate_hz, seed).apply(&mut samples);
        let sum: f64 = samples.iter().map(|x| f64::from(*x) * f64::from(*x)).sum();
        sum / samples.len() as f64
    }

    /// Over an hour, the mean square varies by about 1 %.
    #[test]
    fn the_mean_square_is_one() {
        for strength in [[0.0, 0.0], [3.0, 0.0], [0.0, 4.0], [4.0, 3.0]] {
            let found = squares(strength, 1000.0, 3, 3600);
            assert!((found - 1.0).abs() < 0.03, "{strength:?} {found}");
        }
        assert_eq!(squares([0.0, 0.0], 1000.0, 3, 10), 1.0);
    }

    #[test]
    fn blocks_and_sample_rates_do_not_change_the_envelope() {
        let whole = |rate_hz: f64| {
            let mut samples = alloc::vec![1.0; rate_hz as usize];
            RandomEnvelope::new([4.0, 3.0], rate_hz, 5).apply(&mut samples);
            samples
        };
        let (coarse, fine) = (whole(1000.0), whole(8000.0));
        for (i, x) in coarse.iter().enumerate() {
            assert!((x - fine[8 * i]).abs() < 1e-5);
        }
        let mut parts = alloc::vec![1.0; 8000];
        let mut envelope = RandomEnvelope::new([4.0, 3.0], 8000.0, 5);
        for block in parts.chunks_mut(77) {
            envelope.apply(block);
        }
        assert_eq!(parts, fine);
    }

    #[test]
    fn odd_strengths_and_rates_give_finite_samples() {
        for strength in [[f64::NAN, f64::INFINITY], [-1.0, 1e300]] {
            for rate_hz in [0.0, f64::NAN, 100.0, 1e7] {
                let mut samples = [1.0; 50];
                RandomEnvelope::new(strength, rate_hz, 1).apply(&mut samples);
                assert!(samples.iter().all(|x| x.is_finite()), "{strength:?} {rate_hz}");
            }
        }
    }
}
