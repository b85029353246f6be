//! From values to pixels along one axis.

use crate::axis::{Axis, Scale};
use crate::ticks::{Tick, ticks};

/// One axis laid along a length of pixels.
#[derive(Debug, Clone)]
pub(crate) struct Projection {
    scale: Scale,
    low: f64,
    high: f64,
}

/// Beyond this many lengths outside the plot a point may as well stand there: keeps coordinates
/// short whatever the data.
const FAR: f64 = 20.0;

impl Projection {
    /// The projection of `axis` for the finite ones of `values`.
    pub(crate) fn new(axis: &Axis, values: impl Iterator<Item = f64>) -> Self {
        let (low, high) = axis.resolve(values);
        let scale = axis.scale;
        Self { scale, low, high }
    }

    /// Where `value` stands: 0 at the low end, 1 at the high end; none where the axis has no
    /// place for it.
    pub(crate) fn fraction(&self, value: f64) -> Option<f64> {
        let fraction = match self.scale {
            Scale::Linear => (value - self.low) / (self.high - self.low),
            Scale::Log if value > 0.0 => (value / self.low).ln() / (self.high / self.low).ln(),
            Scale::Log => return None,
        };
        let usable = value.is_finite() && !fraction.is_nan();
        usable.then(|| fraction.clamp(-FAR, FAR))
    }

    /// The value stems rise from: zero where the axis shows it, otherwise the end nearest to it.
    pub(crate) fn base(&self) -> f64 {
        match self.scale {
            Scale::Linear => 0f64.clamp(self.low, self.high),
            Scale::Log => self.low,
        }
    }

    /// About `count` labelled marks, each with its fraction of the length.
    pub(crate) fn ticks(&self, count: usize) -> Vec<(f64, Tick)> {
        let all = ticks(self.scale, self.low, self.high, count);
        let placed = all
            .into_iter()
            .filter_map(|t| Some((self.fraction(t.value)?, t)));
        placed.collect()
    }
}
