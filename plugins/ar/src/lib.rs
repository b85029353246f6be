//! Autoregressive model (`org.htex.ar`): white noise filtered by an all-pole filter (section
//! "Auto-regression" of the paper, after Culbertson et al. 2014).
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![no_std]

#[macro_use]
extern crate alloc;

mod fit;
mod lines;
mod together;
mod voice;

use alloc::vec::Vec;

use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::line_spectrum::coefficients_of_lines;
use htex_dsp::linear_prediction::{ar_magnitude, is_stable};
use htex_model::filtered::{FilteredVoice, finite_level, unstable};
use htex_model::{
    Error, Fit, FitInput, Model, Numbers, StaticDescriptor, StaticField, StaticOption, Store,
    UsualRange, Values, mix,
};

use lines::write_lines;
use voice::MovingPoles;

/// The voice of the model.
pub type AutoregressionVoice = FilteredVoice<MovingPoles>;

const COEFFICIENTS: usize = 0;
const MODEL_RATE: usize = 1;

/// Highest filter order.
pub(crate) const MAX_ORDER: usize = 64;

pub struct Autoregression;

htex_model::export_model!(Autoregression, symbols: "plugin");

impl Model for Autoregression {
    type Voice = AutoregressionVoice;

    const DESCRIPTOR: StaticDescriptor = StaticDescriptor::new(
        "org.htex.ar",
        "AR",
        env!("CARGO_PKG_VERSION"),
        "White noise through an all-pole filter. The parameters are the coefficients of the filter.",
    )
    .fields(&[
        StaticField::list(
            "coefficients",
            "1",
            (-1e6, 1e6),
            MAX_ORDER as u32,
            "A_1 to A_p in x[t] = sum A_i x[t-i] + e[t], where t counts samples at the model rate.",
        )
        .stored(Store::F64)
        // The fits to 15 simulated recordings of five surfaces have values from -3.4 to 3.3.
        .usual(UsualRange::linear(-4.0, 4.0)),
        StaticField::scalar("model_rate_hz", "Hz", (50.0, 1e6), "Rate at which the filter runs.")
            .usual(UsualRange::linear(2000.0, 4000.0)),
    ])
    .options(&[
        StaticOption::integer("order", (1, MAX_ORDER as u32), 6, "Filter order p. The paper uses six.")
            .sweep(&[
                2.0, 3.0, 4.0, 5.0, 6.0, 8.0, 10.0, 12.0, 16.0, 20.0, 24.0, 32.0, 40.0, 48.0, 64.0,
            ]),
        StaticOption::number(
            "rate_hz",
            "Hz",
            (50.0, 1e6),
            2000.0,
            "Rate at which the filter runs. If the band of the recording ends below 1000 Hz, the \
             rate is at most twice the upper edge of the band.",
        )
        .sweep(&[2000.0, 2500.0, 4000.0]),
        StaticOption::choice(
            "method",
            &["yule-walker", "burg", "covariance", "decibel"],
            "How the coefficients are estimated: `yule-walker` from the averaged power spectrum, \
             `burg` and `covariance` from the overlap-added segments of the recording; `decibel` \
             minimises the squared differences, in decibels, between the spectra of the filter and \
             of the recording, in 30 bands.",
        )
        .sweep_alone(&[0.0, 1.0, 2.0, 3.0]),
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

    /// Interpolates line spectral frequencies, because every weighted mean of them gives a stable
    /// filter.
    fn interpolate(
        sets: &[Values<'_>],
        weights: &[f64],
        out: &mut Numbers<'_>,
    ) -> Result<(), Error> {
        if let Some(set) = mix::sole(sets, weights) {
            out.extend(set.flat());
            return Ok(());
        }
        let rate_hz = sets[0].scalar(MODEL_RATE);
        if sets.iter().any(|set| set.scalar(MODEL_RATE) != rate_hz) {
            return Err(Error::argument("filters of different model rates cannot be mixed"));
        }
        let order = sets.iter().map(|s| s.list(COEFFICIENTS).len()).max().unwrap_or(0);
        // This memory is on the stack, because hosts may interpolate on the render thread.
        let mut all = [[0.0; MAX_ORDER]; 4];
        let [mixed, padded, lines, coefficients] = all.each_mut().map(|all| &mut all[..order]);
        for (set, &weight) in sets.iter().zip(weights) {
            let own = set.list(COEFFICIENTS);
            padded.fill(0.0);
            // Appended zero coefficients do not change a filter, but give all filters the same
            // number of lines.
            padded[..own.len()].copy_from_slice(own);
            if !write_lines(padded, lines) {
                return Err(unstable());
            }
            for (sum, w) in mixed.iter_mut().zip(&*lines) {
                *sum += weight * w;
            }
        }
        if !coefficients_of_lines(mixed, coefficients) {
            return Err(unstable());
        }
        out.push(order as f64);
        out.extend(coefficients);
        out.push(rate_hz);
        Ok(())
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
        AutoregressionVoice::new(parameters, band, rate_hz, seed)
    }
}

fn flat(coefficients: &[f64], rate_hz: f64) -> Vec<f64> {
    [&[coefficients.len() as f64], coefficients, &[rate_hz]].concat()
}

/// The all-pole filter.
#[derive(Clone, Copy)]
pub(crate) struct Filter<'a> {
    pub(crate) coefficients: &'a [f64],
    pub(crate) rate_hz: f64,
}

impl<'a> Filter<'a> {
    fn new(parameters: &Values<'a>) -> Result<Self, Error> {
        let filter = Self {
            coefficients: parameters.list(COEFFICIENTS),
            rate_hz: parameters.scalar(MODEL_RATE),
        };
        if is_stable(filter.coefficients) { Ok(filter) } else { Err(unstable()) }
    }

    /// Returns the magnitude `|H|`. It is zero above the Nyquist frequency of the model rate.
    pub(crate) fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        if frequency_hz > 0.5 * self.rate_hz {
            return 0.0;
        }
        ar_magnitude(self.coefficients, frequency_hz, self.rate_hz)
    }

    pub(crate) fn level(&self, band: Band) -> Result<f64, Error> {
        finite_level(curve_level_rms(band, |f| self.magnitude_at(f)))
    }
}
