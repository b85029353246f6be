//! Values of the fit options in a sweep of accuracy against cost.

use htex_model::{Knob, Knobs};

pub const KNOBS: Knobs = Knobs {
    together: &[
        Knob::new(
            "order",
            &["2", "3", "4", "5", "6", "8", "10", "12", "16", "20", "24", "32", "40", "48", "64"],
        ),
        Knob::new("rate_hz", &["2000", "2500", "4000"]),
    ],
    alone: &[Knob::new("method", &["yule-walker", "burg", "covariance"])],
    not_above: None,
};
