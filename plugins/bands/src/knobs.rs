//! Values of the fit options in a sweep of accuracy against cost.

use htex_model::{Knob, Knobs};

pub const KNOBS: Knobs = Knobs {
    together: &[
        Knob::new(
            "bands",
            &[
                "1", "2", "3", "4", "5", "6", "7", "8", "9", "10", "12", "14", "16", "19", "20",
                "22", "24", "26", "28", "30", "34", "40", "48", "56", "64",
            ],
        ),
        Knob::new("step_db", &["3", "1.5", "1", "0.75", "0.5", "0.25"]),
    ],
    alone: &[Knob::new("layout", &["within"])],
    not_above: None,
};
