//! The usual ranges of a model's parameters, for sliders. They do not cross the ABI: a descriptor
//! has the ranges of what may be stored, which are wide (0.001 to 1,000,000 for a shape parameter
//! of sBeta).

/// The scale on which a range is even.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scale {
    /// Equal steps are equal differences.
    Linear,
    /// Equal steps are equal ratios.
    Log,
}

impl Scale {
    /// Its name in documents: `linear` or `log`.
    #[must_use]
    pub const fn name(self) -> &'static str {
        match self {
            Self::Linear => "linear",
            Self::Log => "log",
        }
    }
}

/// The usual range of a parameter; of a list, that of each of its numbers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Usual {
    /// The parameter: a field of the descriptor.
    pub field: &'static str,
    /// Its lower end.
    pub min: f64,
    /// Its upper end.
    pub max: f64,
    /// The scale on which it is even.
    pub scale: Scale,
}

impl Usual {
    /// A range in which equal differences are equally far.
    #[must_use]
    pub const fn linear(field: &'static str, (min, max): (f64, f64)) -> Self {
        Self { field, min, max, scale: Scale::Linear }
    }

    /// A range above 0 in which equal ratios are equally far.
    #[must_use]
    pub const fn log(field: &'static str, range: (f64, f64)) -> Self {
        Self { scale: Scale::Log, ..Self::linear(field, range) }
    }
}
