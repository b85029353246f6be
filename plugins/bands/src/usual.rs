//! The usual ranges of the parameters. In the fits to 15 simulated recordings of five surfaces,
//! nine tenths of the knots are at most 42 dB below the highest one, and all but a few at most 60
//! dB. The sweep uses the same steps (`knobs`).

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::linear("below_highest", (0.0, 60.0)),
    Usual::log("step_db", (0.25, 3.0)),
    Usual::linear("layout", (0.0, 1.0)),
];
