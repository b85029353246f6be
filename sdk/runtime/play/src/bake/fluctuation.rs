//! How a block stores the fluctuation of a texture's strength over time.

use htex_format::Fluctuation;

/// Approximate rate at which a player computes values of the envelope, hertz. The player
/// interpolates linearly between these values.
const VALUES_HZ: f64 = 500.0;
/// Number of sinusoids in each part of the envelope's logarithm.
const LINES: usize = 8;
/// Lowest frequency of each part, and the width of the range of each sinusoid, hertz.
const PARTS_HZ: [[f64; 2]; 2] = [[0.5, 0.9375], [8.0, 3.0]];
/// A value that the envelope rarely exceeds, in standard deviations of its logarithm.
const DEVIATIONS: f64 = 2.0;

/// The fluctuation of a block.
#[derive(Debug, Clone, Copy)]
pub(crate) struct BlockFluctuation {
    /// Samples between two values of the envelope.
    pub(crate) period: u16,
    pub(crate) strength: Fluctuation,
    /// Added to the logarithm so that the mean square of the envelope is 1, octaves.
    pub(crate) offset: f32,
}

impl BlockFluctuation {
    pub(crate) fn new(strength: Fluctuation, rate_hz: f64) -> Self {
        let period = (rate_hz / VALUES_HZ).round().clamp(1.0, f64::from(u16::MAX));
        // Over random phases, exp(2 a cos) has the mean I0(2 a), and the product of two values that
        // are the angle t apart has the mean I0(2 a cos(t / 2)).
        let (mut square, mut product) = (0.0, 0.0);
        for (sigma, [low, width]) in nepers(strength).into_iter().zip(PARTS_HZ) {
            let amplitude = sigma * libm::sqrt(2.0 / LINES as f64);
            for i in 0..LINES {
                let hertz = low + width * (i as f64 + 0.5);
                let half = std::f64::consts::PI * hertz * period / rate_hz;
                square += ln_bessel(2.0 * amplitude);
                product += ln_bessel(2.0 * amplitude * libm::cos(half));
            }
        }
        // Linear interpolation between two values reduces the mean square to this fraction.
        let interpolated = (2.0 + libm::exp(product - square)) / 3.0;
        let offset = -0.5 * (square + libm::log(interpolated)) / std::f64::consts::LN_2;
        Self { period: period as u16, strength, offset: offset as f32 }
    }

    /// Returns the factor by which a fluctuation raises the magnitude that samples rarely exceed.
    pub(crate) fn crest(&self) -> f64 {
        let [slow, fast] = nepers(self.strength);
        libm::exp(DEVIATIONS * libm::sqrt(slow * slow + fast * fast))
    }
}

/// The standard deviations of the two parts, as natural logarithms.
fn nepers(strength: Fluctuation) -> [f64; 2] {
    strength.decibels().map(|db| db * std::f64::consts::LN_10 / 20.0)
}

/// The natural logarithm of the modified Bessel function I0, for arguments of a few units.
fn ln_bessel(x: f64) -> f64 {
    let (mut term, mut sum) = (1.0, 1.0);
    for k in 1..30 {
        term *= 0.25 * x * x / f64::from(k * k);
        sum += term;
    }
    libm::log(sum)
}
