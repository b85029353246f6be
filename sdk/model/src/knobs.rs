//! The values of a model's fit options that a sweep of accuracy against cost tries. They are not
//! part of the ABI: the author of a model chooses them. Without them, a sweep covers the ranges of
//! the descriptor.

/// One option of a sweep, and the values that the sweep tries in addition to the default.
#[derive(Debug, Clone, Copy)]
pub struct Knob {
    /// Name of the option: a fit option of the model, or an option for storing or playing.
    pub name: &'static str,
    /// The values from coarse to fine, as text: numbers or choices.
    pub values: &'static [&'static str],
}

impl Knob {
    /// Makes a knob with these values.
    pub const fn new(name: &'static str, values: &'static [&'static str]) -> Self {
        Self { name, values }
    }
}

/// The options that a sweep of one model varies.
#[derive(Debug, Clone, Copy)]
pub struct Knobs {
    /// Knobs that the sweep varies in all combinations.
    pub together: &'static [Knob],
    /// Knobs that the sweep varies one at a time, with all others at their defaults.
    pub alone: &'static [Knob],
    /// Two knobs: the first has no effect above the value of the second.
    pub not_above: Option<(&'static str, &'static str)>,
}
