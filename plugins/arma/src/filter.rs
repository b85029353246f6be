//! The filter of a parameter set.

use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::line_spectrum::{coefficients_of_lines, zeros_of_lines};
use htex_dsp::linear_prediction::{ar_magnitude, step_down_in_place};
use htex_model::{Error, Values};

use crate::{MAX_ORDER, MODEL_RATE, POLE_LINES, ZERO_LINES};

/// `(1 - Σ B_i z⁻ⁱ) / (1 - Σ A_i z⁻ⁱ)`.
#[derive(Clone, Copy)]
pub(crate) struct Filter {
    poles: Polynomial,
    zeros: Polynomial,
    rate_hz: f64,
}

/// The coefficients of `1 - Σ A_i z⁻ⁱ`.
#[derive(Clone, Copy)]
struct Polynomial {
    coefficients: [f64; MAX_ORDER],
    order: usize,
}

impl Polynomial {
    fn of_lines(lines: &[f64], convert: fn(&[f64], &mut [f64]) -> bool) -> Option<Self> {
        let mut coefficients = [0.0; MAX_ORDER];
        let order = lines.len();
        let is_one = convert(lines, coefficients.get_mut(..order)?);
        is_one.then_some(Self {
            coefficients,
            order,
        })
    }

    fn coefficients(&self) -> &[f64] {
        &self.coefficients[..self.order]
    }

    /// Reflection coefficients, and zeros beyond the order; `None` if a zero is not inside the unit circle.
    fn reflection(&self) -> Option<[f64; MAX_ORDER]> {
        let mut reflection = self.coefficients;
        step_down_in_place(&mut reflection[..self.order]).then_some(reflection)
    }
}

impl Filter {
    pub(crate) fn new(parameters: &Values<'_>) -> Result<Self, Error> {
        let lines = [POLE_LINES, ZERO_LINES].map(|field| parameters.list(field));
        let filter = Self::of_lines(lines[0], lines[1], parameters.scalar(MODEL_RATE))?;
        match filter.reflection() {
            Some(_) => Ok(filter),
            None => Err(unstable()),
        }
    }

    /// The filter of lines, stable to rounding.
    pub(crate) fn of_lines(poles: &[f64], zeros: &[f64], rate_hz: f64) -> Result<Self, Error> {
        Ok(Self {
            poles: Polynomial::of_lines(poles, coefficients_of_lines).ok_or_else(unordered)?,
            zeros: Polynomial::of_lines(zeros, zeros_of_lines).ok_or_else(descending)?,
            rate_hz,
        })
    }

    /// `A_1` to `A_p`.
    pub(crate) fn poles(&self) -> &[f64] {
        self.poles.coefficients()
    }

    /// `B_1` to `B_q`.
    pub(crate) fn zeros(&self) -> &[f64] {
        self.zeros.coefficients()
    }

    /// Reflection coefficients of the denominator; `None` if rounding made it unstable.
    pub(crate) fn reflection(&self) -> Option<[f64; MAX_ORDER]> {
        self.poles.reflection()
    }

    /// Magnitude `|H|`; zero above the Nyquist frequency of the model rate.
    pub(crate) fn at(&self, frequency_hz: f64) -> f64 {
        if frequency_hz > 0.5 * self.rate_hz {
            return 0.0;
        }
        let inverse = |of: &Polynomial| ar_magnitude(of.coefficients(), frequency_hz, self.rate_hz);
        inverse(&self.poles) / inverse(&self.zeros)
    }

    pub(crate) fn level(&self, band: Band) -> Result<f64, Error> {
        finite_level(curve_level_rms(band, |f| self.at(f)))
    }
}

/// Checks that a level is usable as a divisor of magnitudes and samples.
pub(crate) fn finite_level(level: f64) -> Result<f64, Error> {
    if level > 0.0 && level.is_finite() {
        return Ok(level);
    }
    Err(Error::parameters(
        "the filter has no finite energy in the band",
    ))
}

pub(crate) fn unstable() -> Error {
    Error::parameters("the filter is not stable: a pole lies on or outside the unit circle")
}

fn unordered() -> Error {
    Error::parameters("the lines of the poles do not ascend between 0 and pi")
}

fn descending() -> Error {
    Error::parameters("the lines of the zeros descend")
}
