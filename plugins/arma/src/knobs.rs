//! Values of the fit options in a sweep of accuracy against cost.

use htex_model::{Knob, Knobs};

pub const KNOBS: Knobs = Knobs {
    together: &[
        Knob::new("poles", &["2", "4", "6", "12", "16", "20"]),
        Knob::new("zeros", &["0", "2", "8", "12", "18"]),
    ],
    alone: &[Knob::new("rate_hz", &["2500", "4000"])],
    not_above: None,
};
