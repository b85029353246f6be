//! The model {{LABEL}} ({{ID}}), which has a single resonance until you change it.
//!
//! The model plays noise with the spectrum of a two-pole band-pass filter:
//! `1 / sqrt(1 + ((f/centre - centre/f) centre/bandwidth)²)`.
//!
//! `cargo build --release` builds the native library, and `cargo module` builds the WASM module. The
//! module does not link the standard library, so it is small enough to embed in an asset.
#![no_std]

extern crate alloc;

#[cfg(feature = "motion")]
mod follow;

use alloc::vec;
use alloc::vec::Vec;

use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::nelder_mead::{Options, minimize};
use htex_model::shaped::{Curve, ShapedVoice};
use htex_model::{
    Error, Fit, FitInput, Model, Numbers, StaticDescriptor, StaticField, Values, mix,
};

const CENTRE: usize = 0;
const BANDWIDTH: usize = 1;
const CENTRE_HZ: (f64, f64) = (5.0, 2000.0);
const BANDWIDTH_HZ: (f64, f64) = (20.0, 2000.0);

/// The model.
pub struct {{TYPE}};

#[cfg(not(feature = "motion"))]
htex_model::export_model!({{TYPE}}, symbols: "plugin");
#[cfg(feature = "motion")]
htex_model::export_model!({{TYPE}}, symbols: "plugin", extensions: [motion]);

#[cfg(not(feature = "motion"))]
type Sound = ShapedVoice<Shape>;
#[cfg(feature = "motion")]
type Sound = follow::Following;

impl Model for {{TYPE}} {
    type Voice = Sound;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "{{ID}}",
        "{{LABEL}}",
        env!("CARGO_PKG_VERSION"),
        "{{LABEL}}: one resonance, where it lies and how wide it is.",
    )
    .fields(&[
        StaticField::scalar("centre_hz", "Hz", CENTRE_HZ, "Frequency of the resonance."),
        StaticField::scalar(
            "bandwidth_hz",
            "Hz",
            BANDWIDTH_HZ,
            "Width between the points 3 dB below it.",
        ),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        let largest = input.magnitude.iter().copied().fold(0.0, f64::max);
        if largest <= 0.0 {
            return Err(Error::cannot_fit(
                "the spectrum is silent, so the model cannot be fitted",
            ));
        }
        let band: Band = input.band;
        let relative: Vec<f64> = input.magnitude.iter().map(|m| m / largest).collect();
        let shape = best_shape(input.frequency_hz, &relative, band);
        let scale = scale(input.frequency_hz, &relative, &shape);
        let level = curve_level_rms(band, |f| shape.magnitude_at(f));
        Ok(Fit {
            parameters: vec![shape.centre_hz, shape.bandwidth_hz],
            level_rms: largest * scale * level,
        })
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        htex_model::shaped::magnitude::<Shape>(parameters, band, frequency_hz, magnitude)
    }

    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        mix::linear(sets, weights, out)
    }

    fn voice_rate_hz(_: &Values<'_>, band: Band, wanted_hz: f64) -> f64 {
        htex_model::shaped::voice_rate_hz(band, wanted_hz)
    }

    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        let sound = ShapedVoice::new(parameters, band, rate_hz, seed)?;
        #[cfg(feature = "motion")]
        let sound = follow::Following::new(sound, rate_hz);
        Ok(sound)
    }
}

/// The curve of parameters in a band.
pub struct Shape {
    centre_hz: f64,
    bandwidth_hz: f64,
    band: Band,
    level: f64,
}

impl Curve for Shape {
    fn new(parameters: &Values<'_>, band: Band) -> Result<Self, Error> {
        let mut shape = Self {
            centre_hz: 0.0,
            bandwidth_hz: 0.0,
            band,
            level: 0.0,
        };
        shape.set(parameters)?;
        Ok(shape)
    }

    fn band(&self) -> Band {
        self.band
    }

    fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.centre_hz = parameters.scalar(CENTRE);
        self.bandwidth_hz = parameters.scalar(BANDWIDTH);
        self.level = curve_level_rms(self.band, |f| self.magnitude_at(f));
        if self.level > 0.0 {
            return Ok(());
        }
        Err(Error::argument("no multiple of 5 Hz lies in the band"))
    }

    fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        let f = frequency_hz / self.centre_hz;
        let detuned = (f - 1.0 / f) * self.centre_hz / self.bandwidth_hz;
        1.0 / libm::sqrt(1.0 + detuned * detuned)
    }

    fn level(&self) -> f64 {
        self.level
    }
}

/// Returns the resonance with the least squared error, searched from several centres in logarithmic
/// parameters.
fn best_shape(frequency_hz: &[f64], magnitude: &[f64], band: Band) -> Shape {
    let shape = |x: &[f64; 2]| Shape {
        centre_hz: libm::exp(x[0]).clamp(CENTRE_HZ.0, CENTRE_HZ.1),
        bandwidth_hz: libm::exp(x[1]).clamp(BANDWIDTH_HZ.0, BANDWIDTH_HZ.1),
        band,
        level: 1.0,
    };
    let distance = |x: &[f64; 2]| {
        let shape = shape(x);
        let scale = scale(frequency_hz, magnitude, &shape);
        let pairs = frequency_hz.iter().zip(magnitude);
        pairs.map(|(&f, m)| scale * shape.magnitude_at(f) - m).map(|d| d * d).sum()
    };
    let (low, high) = (libm::log(band.low_hz), libm::log(band.high_hz));
    let mut best = [low, low, f64::INFINITY];
    for part in [0.2, 0.4, 0.6, 0.8] {
        let start = [low + part * (high - low), libm::log(100.0)];
        let found = minimize(distance, start, &Options::default());
        if found.value < best[2] {
            best = [found.x[0], found.x[1], found.value];
        }
    }
    shape(&[best[0], best[1]])
}

/// Returns the factor with which a shape is closest to a spectrum.
fn scale(frequency_hz: &[f64], magnitude: &[f64], shape: &Shape) -> f64 {
    let (mut hm, mut hh) = (0.0, 0.0);
    for (&f, m) in frequency_hz.iter().zip(magnitude) {
        let h = shape.magnitude_at(f);
        hm += h * m;
        hh += h * h;
    }
    if hh > 0.0 { hm / hh } else { 0.0 }
}
