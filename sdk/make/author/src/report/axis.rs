//! Axes of a plot: label, scale and range.

/// Spacing of values along an axis.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps for equal differences.
    Linear,
    /// Equal steps for equal ratios; values at or below zero are not shown.
    Log,
}

/// One axis of a [`Plot`](crate::report::Plot).
#[derive(Debug, Clone, PartialEq)]
pub struct Axis {
    /// Quantity and unit, separated by a slash: `"frequency / Hz"`.
    pub label: String,
    /// Whether the axis is linear or logarithmic.
    pub scale: Scale,
    /// Lowest and highest value shown, in the label's unit. If absent, the range follows from the
    /// data.
    pub range: Option<(f64, f64)>,
}

/// Values with a larger magnitude are limited to this, so that spans and ratios stay finite.
const LARGEST: f64 = 1e140;
const SMALLEST: f64 = 1e-140;

impl Axis {
    /// Creates a linear axis whose range is taken from the data.
    pub fn linear(label: &str) -> Self {
        Self { label: label.to_owned(), scale: Scale::Linear, range: None }
    }

    /// Creates a logarithmic axis whose range is taken from the data.
    pub fn log(label: &str) -> Self {
        Self { scale: Scale::Log, ..Self::linear(label) }
    }

    /// Sets the range from `low` to `high`, in the label's unit.
    #[must_use]
    pub fn with_range(mut self, low: f64, high: f64) -> Self {
        self.range = Some((low, high));
        self
    }

    /// Returns the unit: the text after the label's last slash, or an empty string if there is no
    /// slash.
    pub fn unit(&self) -> &str {
        self.label.rsplit_once(" / ").map_or("", |(_, unit)| unit)
    }

    /// Whether an axis of this kind can show `value`.
    pub(crate) fn shows(&self, value: f64) -> bool {
        value.is_finite() && (self.scale == Scale::Linear || value > 0.0)
    }

    /// Returns the range to draw for `values`: always finite, increasing, wide enough to divide by,
    /// and positive on a log axis.
    pub(crate) fn resolve(&self, values: impl Iterator<Item = f64>) -> (f64, f64) {
        let given = self.range.filter(|(a, b)| self.shows(*a) && self.shows(*b));
        match given {
            Some(range) => sound_range(Some(range), self.scale),
            None => {
                let found = extremes(values.filter(|v| self.shows(*v)));
                with_margin(sound_range(found, self.scale), self.scale)
            }
        }
    }
}

/// Returns a valid range with a margin for markers at both ends. The margin does not extend the
/// range across zero.
fn with_margin((low, high): (f64, f64), scale: Scale) -> (f64, f64) {
    const MARGIN: f64 = 0.03;
    match scale {
        Scale::Linear => {
            let margin = MARGIN * (high - low);
            let floor = if low >= 0.0 { 0.0 } else { f64::NEG_INFINITY };
            ((low - margin).max(floor), high + margin)
        }
        Scale::Log => {
            let margin = (high / low).powf(MARGIN);
            (low / margin, high * margin)
        }
    }
}

fn extremes(values: impl Iterator<Item = f64>) -> Option<(f64, f64)> {
    values.fold(None, |range, v| match range {
        None => Some((v, v)),
        Some((low, high)) => Some((v.min(low), v.max(high))),
    })
}

/// Returns `range` in increasing order, widened if it is too narrow to be divided into steps.
pub(crate) fn sound_range(range: Option<(f64, f64)>, scale: Scale) -> (f64, f64) {
    let usable = range.filter(|(a, b)| a.is_finite() && b.is_finite());
    match scale {
        Scale::Linear => {
            let (a, b) = usable.unwrap_or((0.0, 1.0));
            sound_linear(a.min(b), a.max(b))
        }
        Scale::Log => {
            let (a, b) = usable.filter(|(a, b)| *a > 0.0 && *b > 0.0).unwrap_or((1.0, 10.0));
            sound_log(a.min(b), a.max(b))
        }
    }
}

fn sound_linear(low: f64, high: f64) -> (f64, f64) {
    let (low, high) = (low.clamp(-LARGEST, LARGEST), high.clamp(-LARGEST, LARGEST));
    let size = low.abs().max(high.abs());
    if high - low > (1e-9 * size).max(SMALLEST) {
        (low, high)
    } else {
        let margin = if size > SMALLEST { 0.1 * size } else { 0.5 };
        (low - margin, high + margin)
    }
}

fn sound_log(low: f64, high: f64) -> (f64, f64) {
    let (low, high) = (low.clamp(SMALLEST, LARGEST), high.clamp(SMALLEST, LARGEST));
    if high / low > 1.0 + 1e-6 { (low, high) } else { (low / 2.0, high * 2.0) }
}
