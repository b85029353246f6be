//! Usual ranges of a model's parameters, for sliders. They are not part of the ABI.
//!
//! A descriptor contains the ranges that can be stored, which are much wider than a slider needs
//! (0.001 to 1,000,000 for a shape parameter of sBeta).

/// The scale of a slider.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps of the slider are equal differences.
    Linear,
    /// Equal steps of the slider are equal ratios.
    Log,
}

impl Scale {
    /// Name of the scale in documents: `linear` or `log`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Log => "log",
        }
    }
}

/// The usual range of a parameter. For a list, the range applies to each of its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Usual {
    /// Name of the parameter: a field of the descriptor.
    pub field: &'static str,
    /// Lower end of the range.
    pub min: f64,
    /// Upper end of the range.
    pub max: f64,
    /// Scale on which a slider moves evenly.
    pub scale: Scale,
}

impl Usual {
    /// A range for a linear slider.
    #[must_use]
    pub const fn linear(field: &'static str, (min, max): (f64, f64)) -> Self {
        Self { field, min, max, scale: Scale::Linear }
    }

    /// A range above 0 for a logarithmic slider.
    #[must_use]
    pub const fn log(field: &'static str, range: (f64, f64)) -> Self {
        Self { scale: Scale::Log, ..Self::linear(field, range) }
    }
}
