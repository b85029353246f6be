//! Mapping from values to pixels along one axis.

use crate::report::axis::{Axis, Scale};
use crate::report::ticks::{Tick, ticks};

/// One axis, mapped to a length in pixels.
#[derive(Debug, Clone)]
pub(crate) struct Projection {
    scale: Scale,
    low: f64,
    high: f64,
}

/// Points further outside the plot than this many axis lengths are clamped, so that coordinates
/// stay short.
const FAR: f64 = 20.0;

impl Projection {
    /// Creates the mapping of `axis` for the finite `values`.
    pub(crate) fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = axis.resolve(values);
        let scale = axis.scale;
        Self { scale, low, high }
    }

    /// Returns the position of `value`: 0 at the low end, 1 at the high end; `None` if the axis
    /// cannot show it.
    pub(crate) fn fraction(&self, value: f64) -> Option<f64> {
        let fraction = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log if value > 0.0 => (value / self.low).ln() / (self.high / self.low).ln(),
            Scale::Log => return None,
        };
        let usable = value.is_finite() && !fraction.is_nan();
        usable.then(|| fraction.clamp(-FAR, FAR))
    }

    /// Returns the value at which stems start: zero if the axis shows it, otherwise the end of the
    /// axis closest to zero.
    pub(crate) fn base(&self) -> f64 {
        match self.scale {
            Scale::Linear => 0f64.clamp(self.low, self.high),
            Scale::Log => self.low,
        }
    }

    /// Returns about `count` labelled ticks, each with its position from 0 to 1.
    pub(crate) fn ticks(&self, count: usize) -> Vec<(f64, Tick)> {
        let all = ticks(self.scale, self.low, self.high, count);
        let placed = all.into_iter().filter_map(|t| Some((self.fraction(t.value)?, t)));
        placed.collect()
    }
}
