//! Costs and error measures that are compared.

use htex_format::{By, ErrorMeasure};
use htex_report::Axis;

use crate::point::Point;
use crate::setting::Keep;

/// The cost that error is compared with.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Cost {
    /// Bytes of stored parameters; the error is that of the magnitudes.
    Bytes,
    /// Nanoseconds per sample; the error is that of the samples.
    Time,
}

/// A pair of cost and error measure.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Against {
    pub cost: Cost,
    pub error: ErrorMeasure,
}

impl Cost {
    pub(crate) fn name(self) -> &'static str {
        match self {
            Self::Bytes => "bytes",
            Self::Time => "time",
        }
    }

    /// Whether a point's cost is comparable with that of the others.
    pub(crate) fn compares(self, point: &Point) -> bool {
        match self {
            Self::Bytes => point.how.plays_as_default(),
            Self::Time => point.how.times_compare() && point.how.store == Keep::Model,
        }
    }

    pub(crate) fn amount(self, cost: f64) -> String {
        match self {
            Self::Bytes => format!("{cost} bytes"),
            Self::Time => format!("{cost:.1} ns"),
        }
    }

    pub(crate) fn words(self, cost: f64, error: f64) -> String {
        format!("{} at {error:.2} dB", self.amount(cost))
    }

    pub(crate) fn axis(self) -> Axis {
        match self {
            Self::Bytes => Axis::log("stored parameters / bytes"),
            Self::Time => Axis::log("time of a sample / ns"),
        }
    }
}

impl Against {
    /// Returns cost and error of a point.
    pub(crate) fn place(self, point: &Point) -> (f64, f64) {
        let measure = self.error.measure();
        match self.cost {
            Cost::Bytes => (point.bytes as f64, point.get(By::Magnitude, measure)),
            Cost::Time => (point.ns_per_sample, point.get(By::Samples, measure)),
        }
    }
}
