//! Fits the slopes on both sides of the dominant peak, in decibels per decade. In the paper, the
//! first slope reaches from 20 Hz to the peak, and the second slope from the peak to 1 kHz.

use alloc::vec::Vec;

use htex_model::shaped::Curve;
use htex_model::{Error, Fit, FitInput};

use crate::{MAX_ORDER, ORDER_STEP, Shape};

const ROUNDING: usize = 0;
const METHOD: usize = 1;
/// Slope of a filter of order 1, decibels per decade.
const DB_PER_ORDER: f64 = 20.0;
/// Level of bins without energy, relative to the peak. It keeps the slopes finite.
const FLOOR_DB: f64 = -400.0;

pub(crate) fn fit(input: &FitInput<'_>) -> Result<Fit, Error> {
    let (peak, &top) = input
        .magnitude
        .iter()
        .enumerate()
        .reduce(|best, next| if next.1 > best.1 { next } else { best })
        .filter(|(_, top)| **top > 0.0)
        .ok_or_else(|| Error::cannot_fit("the spectrum is silent: there is no peak"))?;
    let points: Vec<(f64, f64)> = input
        .frequency_hz
        .iter()
        .zip(input.magnitude)
        .map(|(&f, &m)| (libm::log10(f), decibels(m / top)))
        .collect();
    // A peak at an edge of the band has no slope on that side. This side gets the lowest order.
    let order = |slope: Option<f64>| round_order(slope.unwrap_or(0.0), input.options[ROUNDING]);
    let slope = |points: &[(f64, f64)], peak: usize| match input.options[METHOD] as u32 {
        0 => least_squares(points),
        1 => end_points(points),
        _ => anchored(points, peak),
    };
    let orders =
        (order(slope(&points[..=peak], peak)), order(slope(&points[peak..], 0).map(|s| -s)));
    let peak_hz = input.frequency_hz[peak];
    let shape = Shape::with_orders(peak_hz, orders, input.band)?;
    Ok(Fit {
        parameters: vec![peak_hz, orders.0, orders.1],
        // The level is chosen such that shape times level equals the recording's magnitude at the
        // peak.
        level_rms: top * (shape.level() / shape.magnitude_at(peak_hz)),
    })
}

fn decibels(ratio: f64) -> f64 {
    if ratio > 0.0 { (20.0 * libm::log10(ratio)).max(FLOOR_DB) } else { FLOOR_DB }
}

/// Returns the filter order for a slope. The slope is rounded to a multiple of the step (half away
/// from zero), at least one step, and then to the resolution of files.
fn round_order(slope_db_per_decade: f64, step_db_per_decade: f64) -> f64 {
    let steps = libm::round(slope_db_per_decade / step_db_per_decade).max(1.0);
    let order = (steps * step_db_per_decade / DB_PER_ORDER).min(MAX_ORDER);
    ORDER_STEP * libm::round(order / ORDER_STEP)
}

/// Returns the slope of the least-squares line, or `None` if there are fewer than two points.
fn least_squares(points: &[(f64, f64)]) -> Option<f64> {
    let n = points.len() as f64;
    let mean_x = points.iter().map(|p| p.0).sum::<f64>() / n;
    let mean_y = points.iter().map(|p| p.1).sum::<f64>() / n;
    through(points, (mean_x, mean_y))
}

fn end_points(points: &[(f64, f64)]) -> Option<f64> {
    let (first, last) = (points.first()?, points.last()?);
    (last.0 > first.0).then(|| (last.1 - first.1) / (last.0 - first.0))
}

fn anchored(points: &[(f64, f64)], peak: usize) -> Option<f64> {
    through(points, *points.get(peak)?)
}

/// Returns the least-squares slope of a line through a given point.
fn through(points: &[(f64, f64)], (x0, y0): (f64, f64)) -> Option<f64> {
    let xy: f64 = points.iter().map(|(x, y)| (x - x0) * (y - y0)).sum();
    let xx: f64 = points.iter().map(|(x, _)| (x - x0) * (x - x0)).sum();
    (xx > 0.0).then(|| xy / xx)
}
