//! Values of the fit options in a sweep of accuracy against cost.

use htex_model::{Knob, Knobs};

pub const KNOBS: Knobs = Knobs {
    together: &[
        Knob::new("coefficients", &["4", "5", "6", "8", "10", "13", "16", "20", "26", "32", "40"]),
        Knob::new("bands", &["26", "40"]),
        Knob::new("inverse", &["pinv", "nnls", "interpolate"]),
    ],
    alone: &[Knob::new("bands", &["20", "32", "64"])],
    not_above: Some(("coefficients", "bands")),
};
