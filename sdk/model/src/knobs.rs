//! The values of a model's fit options that a sweep of accuracy against cost takes. They do not
//! cross the ABI: the author of a model chooses them, and without them a sweep spans the ranges of
//! the descriptor.

/// A knob and its values in a sweep, besides its default.
#[derive(Debug, Clone, Copy)]
pub struct Knob {
    /// A fit option of the model, or an option of storing and playing.
    pub name: &'static str,
    /// Its values, from coarse to fine, as texts: numbers or choices.
    pub values: &'static [&'static str],
}

impl Knob {
    /// A knob with these values.
    pub const fn new(name: &'static str, values: &'static [&'static str]) -> Self {
        Self { name, values }
    }
}

/// The fit options of a model in a sweep.
#[derive(Debug, Clone, Copy)]
pub struct Knobs {
    /// Knobs that are varied in all combinations.
    pub together: &'static [Knob],
    /// Knobs that are varied one at a time, with the others at their defaults.
    pub alone: &'static [Knob],
    /// A knob that has no effect above the value of another.
    pub not_above: Option<(&'static str, &'static str)>,
}
