//! The filter that a parameter set describes.

use core::f64::consts::PI;

use htex_dsp::band_limit::PassedPower;
use htex_dsp::grid::{Band, curve_level_rms};
use htex_dsp::line_spectrum::coefficients_of_cosines;
use htex_dsp::linear_prediction::{ar_magnitude, step_down_in_place};
use htex_dsp::trig::half_turn_cosines;
use htex_model::filtered::{finite_level, unstable};
use htex_model::{Error, Values};

use crate::{MAX_ORDER, MODEL_RATE, POLE_LINES, ZERO_LINES};

/// The filter `(1 - Σ B_i z⁻ⁱ) / (1 - Σ A_i z⁻ⁱ)`.
pub(crate) struct Filter {
    poles: Polynomial,
    zeros: Polynomial,
    /// Reflection coefficients of the denominator.
    reflection: [f64; MAX_ORDER],
    rate_hz: f64,
}

/// A polynomial `1 - Σ A_i z⁻ⁱ`, with the cosines of its line spectral frequencies.
struct Polynomial {
    coefficients: [f64; MAX_ORDER],
    cosines: [f64; MAX_ORDER],
    order: usize,
}

impl Polynomial {
    const ONE: Self = Self { coefficients: [0.0; MAX_ORDER], cosines: [0.0; MAX_ORDER], order: 0 };

    /// Sets the polynomial from its line spectral frequencies. Returns false if there are too many
    /// lines.
    fn set(&mut self, lines: &[f64]) -> bool {
        let order = lines.len();
        let Some(cosines) = self.cosines.get_mut(..order) else {
            return false;
        };
        half_turn_cosines(lines, cosines);
        coefficients_of_cosines(cosines, &mut self.coefficients[..order]);
        self.coefficients[order..].fill(0.0);
        self.order = order;
        true
    }

    fn coefficients(&self) -> &[f64] {
        &self.coefficients[..self.order]
    }

    fn cosines(&self) -> &[f64] {
        &self.cosines[..self.order]
    }
}

impl Filter {
    /// Makes a filter that changes nothing, at this sample rate.
    pub(crate) fn one(rate_hz: f64) -> Self {
        Self {
            poles: Polynomial::ONE,
            zeros: Polynomial::ONE,
            reflection: [0.0; MAX_ORDER],
            rate_hz,
        }
    }

    pub(crate) fn new(parameters: &Values<'_>) -> Result<Self, Error> {
        let mut filter = Self::one(parameters.scalar(MODEL_RATE));
        filter.set(parameters)?;
        Ok(filter)
    }

    pub(crate) fn of_lines(poles: &[f64], zeros: &[f64], rate_hz: f64) -> Result<Self, Error> {
        let mut filter = Self::one(rate_hz);
        filter.set_lines(poles, zeros)?;
        Ok(filter)
    }

    /// Sets the filter from parameters with the same rate. Works in place, because voices call this
    /// function for each motion. After an error, the filter is unusable.
    pub(crate) fn set(&mut self, parameters: &Values<'_>) -> Result<(), Error> {
        self.set_lines(parameters.list(POLE_LINES), parameters.list(ZERO_LINES))
    }

    fn set_lines(&mut self, poles: &[f64], zeros: &[f64]) -> Result<(), Error> {
        let is_inside = poles.iter().all(|w| *w > 0.0 && *w < PI);
        if !is_inside || poles.windows(2).any(|pair| pair[0] >= pair[1]) {
            return Err(unordered());
        }
        if zeros.windows(2).any(|pair| pair[0] > pair[1]) {
            return Err(descending());
        }
        if !self.poles.set(poles) {
            return Err(unordered());
        }
        if !self.zeros.set(zeros) {
            return Err(descending());
        }
        let (own, beyond) = self.reflection.split_at_mut(poles.len());
        // Ascending lines should give a stable filter. But if lines are very close, rounding can
        // make the filter unstable, so the stability is checked here.
        own.copy_from_slice(self.poles.coefficients());
        beyond.fill(0.0);
        if step_down_in_place(own) { Ok(()) } else { Err(unstable()) }
    }

    /// Returns the prediction coefficients of the denominator, `A_1` to `A_p`.
    pub(crate) fn poles(&self) -> &[f64] {
        self.poles.coefficients()
    }

    /// Returns the coefficients of the numerator, `B_1` to `B_q`.
    pub(crate) fn zeros(&self) -> &[f64] {
        self.zeros.coefficients()
    }

    /// Returns the coefficients of [`Self::zeros`], followed by zeros up to the highest order.
    pub(crate) fn zeros_of_any_order(&self) -> &[f64; MAX_ORDER] {
        &self.zeros.coefficients
    }

    /// Returns the reflection coefficients of the denominator, followed by zeros up to the highest
    /// order.
    pub(crate) fn reflection(&self) -> &[f64; MAX_ORDER] {
        &self.reflection
    }

    /// Returns the RMS of white noise after this filter and the filters at the band's edges.
    pub(crate) fn passed_level(&self, passed: &PassedPower) -> Result<f64, Error> {
        finite_level(passed.rational_level_rms(self.zeros.cosines(), self.poles.cosines()))
    }

    /// Returns the magnitude `|H|`. It is zero above the Nyquist frequency of the model rate.
    pub(crate) fn magnitude_at(&self, frequency_hz: f64) -> f64 {
        if frequency_hz > 0.5 * self.rate_hz {
            return 0.0;
        }
        let inverse = |of: &Polynomial| ar_magnitude(of.coefficients(), frequency_hz, self.rate_hz);
        inverse(&self.poles) / inverse(&self.zeros)
    }

    pub(crate) fn level(&self, band: Band) -> Result<f64, Error> {
        finite_level(curve_level_rms(band, |f| self.magnitude_at(f)))
    }
}

fn unordered() -> Error {
    Error::parameters("the lines of the poles do not ascend between 0 and pi")
}

fn descending() -> Error {
    Error::parameters("the lines of the zeros descend")
}
