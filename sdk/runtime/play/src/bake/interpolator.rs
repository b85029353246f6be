//! The low-pass filter with which the player converts samples from the internal rate to the
//! output's sample rate.

use std::f64::consts::PI;

use htex_player::layout::{MOST_ROW, MOST_UP, RATE_HZ};

use crate::Error;
use crate::bake::filter::bessel;

/// Smallest ratio between the internal rate and the texture's highest frequency, if the sample rate
/// permits it.
const PREFERRED: f64 = 2.5;
/// Smallest ratio between the sample rate and the texture's highest frequency.
const LEAST: f64 = 2.05;
/// Attenuation of images, decibels.
const ATTENUATION_DB: f64 = 70.0;

/// The rates of a block, and the coefficients of the filter between them.
pub(crate) struct Interpolator {
    pub(crate) rate_hz: f64,
    pub(crate) internal_hz: f64,
    pub(crate) up: usize,
    pub(crate) row: usize,
    /// Highest frequency that passes the filter, cycles per sample of the internal rate.
    pub(crate) highest: f64,
    /// The coefficients, phase by phase, each from the oldest input to the newest.
    pub(crate) rows: Vec<f64>,
}

impl Interpolator {
    /// Makes an interpolator with the output rate `rate_hz`, for frequencies up to `top_hz`.
    /// Chooses the lowest internal rate that is sufficient.
    pub(crate) fn new(rate_hz: f64, top_hz: f64) -> Result<Self, Error> {
        // The block stores the rate in single precision, so everything is computed for that rate.
        let rate_hz = f64::from(rate_hz as f32);
        let (least_hz, most_hz) = ((LEAST * top_hz).max(RATE_HZ.0.into()), RATE_HZ.1.into());
        if !(least_hz..=most_hz).contains(&rate_hz) {
            return Err(Error::BakeRate { rate_hz, least_hz, most_hz, top_hz });
        }
        // Rounded down, so that the internal rate is not below the preferred one.
        let up = ((rate_hz / (PREFERRED * top_hz)) as usize).clamp(1, MOST_UP);
        let internal_hz = rate_hz / up as f64;
        let row = match up {
            1 => 0,
            _ => row(internal_hz, top_hz),
        };
        let phases = (0..up).flat_map(|phase| coefficients(row, phase as f64 / up as f64));
        Ok(Self {
            rate_hz,
            internal_hz,
            up,
            row,
            // Without a filter, everything up to half the rate passes.
            highest: if up == 1 { 0.5 } else { top_hz / internal_hz },
            rows: phases.collect(),
        })
    }
}

/// Returns Kaiser's estimate of the filter's length, in inputs, rounded up to a multiple of four.
fn row(internal_hz: f64, top_hz: f64) -> usize {
    // The first image of the band begins at the internal rate minus the highest frequency.
    let transition = 2.0 * PI * (internal_hz - 2.0 * top_hz) / internal_hz;
    let length = (ATTENUATION_DB - 8.0) / (2.285 * transition);
    (length.ceil() as usize).next_multiple_of(4).min(MOST_ROW)
}

/// Returns the coefficients of a phase. `phase` is the position after an input, from 0 to 1. The
/// sum of the coefficients is 1.
fn coefficients(row: usize, phase: f64) -> Vec<f64> {
    // Kaiser's formula for attenuations above 50 dB.
    let beta = 0.1102 * (ATTENUATION_DB - 8.7);
    let half = 0.5 * row as f64;
    let at = |input: usize| {
        let t = (row - 1 - input) as f64 - half + phase;
        let x = t / half;
        let sinc = if t == 0.0 { 1.0 } else { (PI * t).sin() / (PI * t) };
        sinc * bessel(beta * (1.0 - x * x).max(0.0).sqrt())
    };
    let all: Vec<f64> = (0..row).map(at).collect();
    // If the sums of the phases differed, a steady signal would ripple at the internal rate.
    let sum: f64 = all.iter().sum();
    all.into_iter().map(|c| c / sum).collect()
}
