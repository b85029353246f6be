//! Values of the fit options in a sweep of accuracy against cost.

use htex_model::{Knob, Knobs};

pub const KNOBS: Knobs = Knobs {
    together: &[
        Knob::new(
            "count",
            &["1", "2", "3", "4", "6", "8", "10", "12", "16", "24", "32", "48", "64"],
        ),
        Knob::new("jnd", &["0.24", "0.12", "0.06", "0.03", "0"]),
    ],
    alone: &[],
    not_above: None,
};
