//! Spectral slope: an asymmetric band-pass around the dominant peak, three numbers (paper, Spectral
//! slope).
//!
//! The orders are whole with the paper's rounding to 20 dB a decade, and may be fractional with a
//! finer one or between two conditions. White noise is therefore shaped in the frequency domain by
//! the Butterworth magnitude, which is defined for both, rather than by a recursive filter.

mod fit;

use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::shaped_noise::{ShapedNoise, economical_rate_hz};
use htex_model::{Descriptor, Error, Fit, FitInput, Model, Store, Values, Voice, mix};

const PEAK: usize = 0;
const HIGH_PASS: usize = 1;
const LOW_PASS: usize = 2;

/// Highest filter order: 400 dB a decade.
pub const MAX_ORDER: f64 = 20.0;

/// The model.
pub struct SpectralSlope;

htex_model::export_model!(SpectralSlope, symbols: "plugin");

impl Model for SpectralSlope {
    type Voice = SpectralSlopeVoice;

    fn descriptor() -> Descriptor {
        let steps = |scale| Store::U16 {
            scale,
            offset: 0.0,
            log: false,
        };
        // A twentieth of an order is 1 dB a decade.
        let order = Store::U16 {
            scale: 0.05,
            offset: 0.0,
            log: false,
        };
        Descriptor::new(
            "org.htex.sslope",
            "sSlope",
            env!("CARGO_PKG_VERSION"),
            "An asymmetric band-pass around the dominant peak: its frequency and two filter orders.",
        )
        .scalar("peak_hz", "Hz", (1.0, 2000.0), "Dominant peak and cut-off of both filters.")
        .stored(steps(0.03125))
        .scalar("order_high_pass", "1", (0.05, MAX_ORDER), "Order r_a of the Butterworth high-pass.")
        .stored(order)
        .scalar("order_low_pass", "1", (0.05, MAX_ORDER), "Order r_b of the Butterworth low-pass.")
        .stored(order)
        .option(
            "rounding_db_per_decade",
            "dB/decade",
            (1.0, 20.0),
            20.0,
            "Slopes are rounded to whole multiples of this (paper: 20).",
        )
        .choice(
            "slopes",
            &["least-squares", "end-points", "anchored"],
            "How slopes are measured: a line through all bins, through both ends, or through the \
             peak.",
        )
    }

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        fit::fit(input)
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: htex_model::Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        let band: Band = band.edges().into();
        let shape = Shape::new(parameters);
        let level = shape.level(band)?;
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = if band.contains(f) {
                shape.at(f) / level
            } else {
                0.0
            };
        }
        Ok(())
    }

    fn interpolate(sets: &[Values<'_>], weights: &[f64]) -> Result<Vec<f64>, Error> {
        mix::linear(sets, weights)
    }

    fn voice_rate_hz(_: &Values<'_>, band: htex_model::Band, wanted_hz: f64) -> f64 {
        economical_rate_hz(wanted_hz, band.edges().into())
    }

    fn voice(
        parameters: &Values<'_>,
        band: htex_model::Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        let band = band.edges().into();
        let shape = Shape::new(parameters);
        shape.level(band)?;
        let mut noise = ShapedNoise::new(rate_hz, band, seed);
        noise.start(|_, f| shape.at(f));
        Ok(SpectralSlopeVoice { band, noise })
    }
}

/// White noise through the band-pass.
pub struct SpectralSlopeVoice {
    band: Band,
    noise: ShapedNoise,
}

impl Voice for SpectralSlopeVoice {
    fn render(&mut self, out: &mut [f32]) {
        self.noise.render(out);
    }

    fn retune(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        let shape = Shape::new(parameters);
        shape.level(self.band)?;
        self.noise.retune(|_, f| shape.at(f));
        Ok(())
    }
}

/// Butterworth high-pass times low-pass with one cut-off.
#[derive(Clone, Copy)]
pub(crate) struct Shape {
    pub(crate) peak_hz: f64,
    pub(crate) high_pass: f64,
    pub(crate) low_pass: f64,
}

impl Shape {
    fn new(parameters: &Values<'_>) -> Self {
        Self {
            peak_hz: parameters.scalar(PEAK),
            high_pass: parameters.scalar(HIGH_PASS),
            low_pass: parameters.scalar(LOW_PASS),
        }
    }

    /// Magnitude; one half at the peak.
    pub(crate) fn at(&self, frequency_hz: f64) -> f64 {
        let above = frequency_hz / self.peak_hz;
        butterworth(above, self.low_pass) * butterworth(1.0 / above, self.high_pass)
    }

    pub(crate) fn level(&self, band: Band) -> Result<f64, Error> {
        let level = curve_level_rms(band, |f| self.at(f));
        if level > 0.0 && level.is_finite() {
            return Ok(level);
        }
        Err(Error::parameters(format!(
            "a peak at {} Hz leaves nothing in the band {} to {} Hz",
            self.peak_hz, band.low_hz, band.high_hz
        )))
    }
}

/// Magnitude of a Butterworth low-pass of any positive order at `ratio` times its cut-off.
fn butterworth(ratio: f64, order: f64) -> f64 {
    1.0 / libm::sqrt(1.0 + libm::pow(ratio, 2.0 * order))
}
