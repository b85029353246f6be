//! The usual ranges of the parameters: peaks in the band of textures, and orders around 1 to 5,
//! which are the orders of the fits to 15 simulated recordings of five surfaces.

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::log("peak_hz", (20.0, 1000.0)),
    Usual::linear("order_high_pass", (0.5, 6.0)),
    Usual::linear("order_low_pass", (0.5, 6.0)),
];
