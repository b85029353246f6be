//! Spectral tilt: the magnitude as a power of frequency, one parameter.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

#[macro_use]
extern crate alloc;

use htex_dsp::grid::{Band, curve_level_rms};
use htex_model::{
    Error, Fit, FitInput, Model, Numbers, StaticDescriptor, StaticField, Values, mix,
};
use htex_shaped::{Curve, ShapedVoice};

const SLOPE: usize = 0;
/// Largest slope: 100 dB per decade.
const MAX_SLOPE: f64 = 5.0;
/// Bins below this part of the largest are left out of the regression.
const FAINTEST: f64 = 1e-3;

pub struct SpectralTilt;

htex_model::export_model!(SpectralTilt, symbols: "plugin");

impl Model for SpectralTilt {
    type Voice = ShapedVoice<Shape>;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.tilt",
        "Tilt",
        env!("CARGO_PKG_VERSION"),
        "The magnitude as a power of frequency: one number.",
    )
    .fields(&[StaticField::scalar(
        "slope",
        "1",
        (-MAX_SLOPE, MAX_SLOPE),
        "Exponent of the frequency: 20 dB per decade for 1.",
    )]);

    /// A straight line of least squares through the logarithms of magnitude and frequency.
    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        let largest = input.magnitude.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(Error::cannot_fit(
                "the spectrum is silent: there is no slope",
            ));
        }
        let heard = || {
            let bins = input.frequency_hz.iter().zip(input.magnitude);
            let heard = bins.filter(move |(_, m)| **m >= FAINTEST * largest);
            heard.map(move |(f, m)| (libm::log(*f), libm::log(*m / largest)))
        };
        let count = heard().count() as f64;
        let sum = |of: fn((f64, f64)) -> f64| heard().map(of).sum::<f64>();
        let (x, y) = (sum(|p| p.0) / count, sum(|p| p.1) / count);
        let (xx, xy) = heard().fold((0.0, 0.0), |(xx, xy), p| {
            (xx + (p.0 - x) * (p.0 - x), xy + (p.0 - x) * (p.1 - y))
        });
        let slope = if xx > 0.0 { xy / xx } else { 0.0 };
        let slope = f64::from(slope.clamp(-MAX_SLOPE, MAX_SLOPE) as f32);
        let line = |f: f64| libm::exp(y + slope * (libm::log(f) - x));
        Ok(Fit {
            parameters: vec![slope],
            level_rms: largest * curve_level_rms(input.band, line),
        })
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        htex_shaped::magnitude::<Shape>(parameters, band, frequency_hz, magnitude)
    }

    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        mix::linear(sets, weights, out)
    }

    fn voice_rate_hz(_: &Values<'_>, band: Band, wanted_hz: f64) -> f64 {
        htex_shaped::voice_rate_hz(band, wanted_hz)
    }

    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        ShapedVoice::new(parameters, band, rate_hz, seed)
    }
}

/// The power of the frequency, relative to the band's upper edge, and its RMS in the band.
#[derive(Clone)]
pub struct Shape {
    slope: f64,
    band: Band,
    level: f64,
}

impl Curve for Shape {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        let mut shape = Self {
            slope: parameters.scalar(SLOPE),
            band,
            level: 1.0,
        };
        shape.level = curve_level_rms(band, |f| shape.at(f));
        Ok(shape)
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.slope = parameters.scalar(SLOPE);
        Ok(())
    }

    fn at(&self, frequency_hz: f64) -> f64 {
        libm::pow(frequency_hz / self.band.high_hz, self.slope)
    }

    fn level(&self) -> f64 {
        self.level
    }
}
