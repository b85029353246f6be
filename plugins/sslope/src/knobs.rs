//! Values of the fit options in a sweep of accuracy against cost.

use htex_model::{Knob, Knobs};

pub const KNOBS: Knobs = Knobs {
    together: &[
        Knob::new("rounding_db_per_decade", &["20", "10", "5", "1"]),
        Knob::new("slopes", &["least-squares", "end-points", "anchored"]),
    ],
    alone: &[],
    not_above: None,
};
