//! The usual range of a parameter, for sliders.

/// The scale of a slider.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[cfg_attr(feature = "host", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "host", serde(rename_all = "kebab-case"))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(feature = "schemars", schemars(description = "The scale of a slider."))]
pub enum Scale {
    /// Equal movements of the slider change the value by equal differences.
    Linear,
    /// Equal movements of the slider change the value by equal ratios.
    Log,
}

/// The usual range of a parameter, for sliders. The range of a list field applies to each number of
/// the list.
///
/// A field's own range contains every value that can be stored. This range is much wider than a
/// slider needs, e.g. 0.001 to 1,000,000 for a shape parameter of sBeta.
///
/// ```
/// use htex_model::{StaticField, UsualRange};
/// let peak = StaticField::scalar("peak_hz", "Hz", (1.0, 2000.0), "Peak.")
///     .usual(UsualRange::log(20.0, 1000.0));
/// assert_eq!(peak.usual.map(|range| range.max), Some(1000.0));
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
#[cfg_attr(feature = "host", derive(serde::Serialize, serde::Deserialize))]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[cfg_attr(
    feature = "schemars",
    schemars(
        description = "The usual range of a parameter, for sliders. For a list, it applies to each of its numbers."
    )
)]
pub struct UsualRange {
    /// Lower end, within the range of the field; above 0 if the scale is `log`.
    pub min: f64,
    /// Upper end, within the range of the field and above `min`.
    pub max: f64,
    /// Scale of the slider: linear or logarithmic.
    pub scale: Scale,
}

impl UsualRange {
    /// A range for a linear slider.
    #[must_use]
    pub const fn linear(min: f64, max: f64) -> Self {
        Self { min, max, scale: Scale::Linear }
    }

    /// A range above 0 for a logarithmic slider.
    #[must_use]
    pub const fn log(min: f64, max: f64) -> Self {
        Self { min, max, scale: Scale::Log }
    }
}
