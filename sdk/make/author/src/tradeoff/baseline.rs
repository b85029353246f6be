//! The two baselines with which a sweep compares models: the quantised spectrum, and the recording
//! itself.

use htex_dsp::grid::{Band, level_rms};
use htex_dsp::resample::Resampler;
use htex_dsp::shaped_noise::{ShapedNoise, economical_rate_hz};
use htex_host::HostError;

/// Number of quantisation steps in a byte.
const STEPS: f64 = 255.0;
/// Lower limit of a bin relative to the largest bin: -120 dB.
const FLOOR: f64 = 1e-6;
/// Size of the two single-precision numbers that store the lowest and highest logarithm.
const RANGE_BYTES: usize = 8;

/// Quantises magnitudes to one byte each, on a logarithmic scale from the lowest to the highest.
/// Each magnitude is rounded up or down. Returns the magnitudes as they are read back, and the
/// number of bytes.
pub(crate) fn quantise(magnitude: &[f64]) -> (Vec<f64>, usize) {
    let top = magnitude.iter().copied().fold(0.0, f64::max);
    let bytes = magnitude.len() + RANGE_BYTES;
    if top <= 0.0 {
        return (vec![0.0; magnitude.len()], bytes);
    }
    let logs: Vec<f64> = magnitude.iter().map(|m| libm::log(m.max(FLOOR * top))).collect();
    let single = |x: f64| f64::from(x as f32);
    let low = single(logs.iter().copied().fold(f64::INFINITY, f64::min));
    let step = (single(libm::log(top)) - low) / STEPS;
    // Each bin's rounding error in energy is carried over to the next bin, up to half a step, so
    // that bands keep their energies.
    let mut left_over = 0.0;
    let stored = |log: &f64| {
        if step <= 0.0 {
            return libm::exp(low);
        }
        let (exact, power) = ((log - low) / step, libm::exp(2.0 * log));
        let carried = f64::clamp(left_over, -step * power, step * power);
        let wanted = (0.5 * libm::log((power + carried).max(0.5 * power)) - low) / step;
        let nearest = wanted.round().clamp(exact.floor(), exact.ceil());
        let stored = libm::exp(low + step * nearest.clamp(0.0, STEPS));
        left_over = power + carried - stored * stored;
        stored
    };
    (logs.iter().map(stored).collect(), bytes)
}

/// Noise of unit RMS, shaped by magnitudes on the band's grid, and played in the same way as the
/// noise of the models.
pub(crate) struct SpectrumNoise {
    noise: ShapedNoise,
    resampler: Option<Resampler>,
}

impl SpectrumNoise {
    pub(crate) fn new(
        magnitude: &[f64],
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self, HostError> {
        let noise_hz = economical_rate_hz(rate_hz, band);
        let mut noise = ShapedNoise::new(noise_hz, band, seed);
        let level = level_rms(magnitude);
        let last = magnitude.len().saturating_sub(1);
        noise.start(|_, hz| {
            let place = (hz / htex_dsp::GRID_HZ - band.first_bin() as f64).clamp(0.0, last as f64);
            let (below, part) = (place as usize, place.fract());
            let (a, b) = (magnitude[below], magnitude[(below + 1).min(last)]);
            (a + part * (b - a)) / level
        });
        let resampler = Resampler::new(noise_hz, rate_hz, band.high_hz)?;
        Ok(Self { noise, resampler })
    }

    pub(crate) fn render(&mut self, out: &mut [f32]) {
        let noise = &mut self.noise;
        match &mut self.resampler {
            Some(resampler) => resampler.process(out, &mut |block| noise.render(block)),
            None => noise.render(out),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_byte_a_bin_is_near() {
        let magnitude: Vec<f64> = (0..197).map(|i| 0.01 * (-0.03 * f64::from(i)).exp()).collect();
        let (stored, bytes) = quantise(&magnitude);
        assert_eq!(bytes, 205);
        // 51 dB in 255 steps of 0.2 dB. Over ten bins together, the error is much smaller.
        for (a, b) in magnitude.iter().zip(&stored) {
            assert!((20.0 * (b / a).log10()).abs() < 0.201, "{a} {b}");
        }
        let power = |m: &[f64]| m.iter().map(|m| m * m).sum::<f64>();
        for (a, b) in magnitude.chunks(10).zip(stored.chunks(10)) {
            assert!((10.0 * (power(b) / power(a)).log10()).abs() < 0.04);
        }
        assert_eq!(quantise(&[0.0; 3]).0, [0.0; 3]);
        assert!((quantise(&[0.5; 3]).0[1] - 0.5).abs() < 1e-6);
    }
}
