//! Values of the fit options in a sweep of accuracy against cost.

use htex_model::{Knob, Knobs};

pub const KNOBS: Knobs = Knobs {
    together: &[
        Knob::new("points", &["3", "4", "5", "6", "8", "10", "15", "20", "30", "50"]),
        Knob::new("lower_bound", &["1", "0"]),
        Knob::new("error", &["magnitude", "decibel"]),
    ],
    alone: &[
        Knob::new("jnd", &["0.24", "0.12", "0.06", "0"]),
        Knob::new("bins", &["0", "5", "10", "20", "40"]),
    ],
    not_above: None,
};
