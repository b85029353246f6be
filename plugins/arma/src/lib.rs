//! ARMA model: white noise filtered by a filter with poles and zeros, as in the Penn Haptic Texture
//! Toolkit (Culbertson et al. 2014).
//!
//! Files store the polynomials of poles and zeros as line spectral frequencies. The reason is that
//! interpolation computes weighted means, and every weighted mean of line spectral frequencies
//! describes a stable filter. Line spectral frequencies cannot store zeros outside the unit circle.
//! Such zeros are not needed, because noise has the same spectrum if they are replaced by their
//! mirror images inside the circle.
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

extern crate alloc;

mod filter;
mod fit;
mod mixing;
mod voice;

use htex_dsp::all_zero;
use htex_dsp::grid::Band;
use htex_model::filtered::FilteredVoice;
use htex_model::{
    Error, Fit, FitInput, Model, Numbers, StaticDescriptor, StaticField, StaticOption, UsualRange,
    Values,
};

use filter::Filter;
use voice::MovingZerosAndPoles;

/// The voice of the model.
pub type ArmaVoice = FilteredVoice<MovingZerosAndPoles>;

const POLE_LINES: usize = 0;
const ZERO_LINES: usize = 1;
const MODEL_RATE: usize = 2;

/// Largest number of poles, and of zeros.
pub(crate) const MAX_ORDER: usize = all_zero::MAX_ORDER;
/// Highest line spectral frequency: π rounded to a 32-bit float, which is slightly more than π.
const MAX_LINE: f64 = core::f32::consts::PI as f64;

pub(crate) struct PolesAndZeros;

htex_model::export_model!(PolesAndZeros, symbols: "plugin");

impl Model for PolesAndZeros {
    type Voice = ArmaVoice;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.arma",
        "ARMA",
        env!("CARGO_PKG_VERSION"),
        "White noise through a filter with poles and zeros. The parameters are their line spectral frequencies.",
    )
    .only_named()
    .fields(&[
        StaticField::list(
            "pole_lines",
            "rad",
            (0.0, MAX_LINE),
            MAX_ORDER as u32,
            "Line spectral frequencies of the denominator, in radians per sample at the model rate. They ascend, \
             between 0 and pi.",
        )
        .usual(UsualRange::linear(0.0, MAX_LINE)),
        StaticField::list(
            "zero_lines",
            "rad",
            (0.0, MAX_LINE),
            MAX_ORDER as u32,
            "Line spectral frequencies of the numerator, in radians per sample. For a zero on the unit circle, two \
             of them are equal.",
        )
        .usual(UsualRange::linear(0.0, MAX_LINE)),
        StaticField::scalar(
            "model_rate_hz",
            "Hz",
            (50.0, 1e6),
            "Rate at which the filter runs.",
        )
        // The usual range goes from the rate of the Penn Haptic Texture Toolkit (1 kHz) to the
        // highest rate of the sweep.
        .usual(UsualRange::linear(1000.0, 4000.0)),
    ])
    .options(&[
        StaticOption::integer("poles", (0, MAX_ORDER as u32), 8, "Number of poles.")
        .sweep(&[2.0, 4.0, 6.0, 12.0, 16.0, 20.0]),
        StaticOption::integer("zeros", (0, MAX_ORDER as u32), 4, "Number of zeros.")
        .sweep(&[0.0, 2.0, 8.0, 12.0, 18.0]),
        StaticOption::number(
            "rate_hz",
            "Hz",
            (50.0, 1e6),
            2000.0,
            "Rate at which the filter runs. If the band of the recording ends below 1000 Hz, the rate is at most \
             twice the upper edge of the band.",
        )
        .sweep_alone(&[2500.0, 4000.0]),
    ]);

    fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
        fit::fit(input)
    }

    fn magnitude(
        parameters: &Values<'_>,
        band: Band,
        frequency_hz: &[f64],
        magnitude: &mut [f64],
    ) -> Result<(), Error> {
        let filter = Filter::new(parameters)?;
        let level = filter.level(band)?;
        for (m, &f) in magnitude.iter_mut().zip(frequency_hz) {
            *m = if band.contains(f) { filter.magnitude_at(f) / level } else { 0.0 };
        }
        Ok(())
    }

    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        mixing::mix(sets, weights, out)
    }

    fn voice_rate_hz(parameters: &Values<'_>, _: Band, _: f64) -> f64 {
        parameters.scalar(MODEL_RATE)
    }

    fn voice(
        parameters: &Values<'_>,
        band: Band,
        rate_hz: f64,
        seed: u64,
    ) -> Result<Self::Voice, Error> {
        ArmaVoice::new(parameters, band, rate_hz, seed)
    }
}
