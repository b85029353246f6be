//! The usual ranges of the parameters: nine tenths of the knots of 15 simulated recordings of five
//! surfaces lie 42 dB below the highest or less, and all but a few 60. The steps are those of the
//! sweep (`knobs`).

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::linear("below_highest", (0.0, 60.0)),
    Usual::log("step_db", (0.25, 3.0)),
    Usual::linear("layout", (0.0, 1.0)),
];
