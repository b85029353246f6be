//! Finds the largest magnitude between the points of the frequency grid.
//!
//! It is found in 1/magnitude², which is a parabola for a resonance. The response file only holds
//! the grid, since its readers interpolate.

use serde::Serialize;

/// The largest magnitude of a response.
///
/// It is interpolated by a parabola through `1 / magnitude²` at the largest point and its two
/// neighbours. A lightly damped resonance has this shape.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Peak {
    pub frequency_hz: f64,
    /// Magnitude, output over input.
    pub magnitude: f64,
    /// The magnitude in decibels.
    pub magnitude_db: f64,
}

impl Peak {
    /// Finds the peak. `None` if the magnitude is largest at the first or last frequency, or zero
    /// next to the largest one.
    pub(crate) fn of(frequency_hz: &[f64], magnitude: &[f64]) -> Option<Self> {
        let larger = |best: usize, at: usize| {
            if magnitude[at] > magnitude[best] { at } else { best }
        };
        let top = (0..magnitude.len()).reduce(larger)?;
        let (before, after) = (top.checked_sub(1)?, top + 1);
        let step_hz = frequency_hz.get(after)? - frequency_hz[top];
        let [y0, y1, y2] = [before, top, after].map(|at| 1.0 / (magnitude[at] * magnitude[at]));
        if ![y0, y1, y2].iter().all(|y| y.is_finite()) {
            return None;
        }
        let bend = y0 - 2.0 * y1 + y2;
        let shift = if bend > 0.0 { 0.5 * (y0 - y2) / bend } else { 0.0 };
        let least = y1 - 0.25 * (y0 - y2) * shift;
        // If the points do not belong to one resonance, the parabola may fall below 0.
        let magnitude = if least > 0.0 { 1.0 / least.sqrt() } else { magnitude[top] };
        Some(Self {
            frequency_hz: frequency_hz[top] + shift * step_hz,
            magnitude,
            magnitude_db: 20.0 * libm::log10(magnitude),
        })
    }
}
