//! The usual ranges of the parameters: peaks within the band of textures, and orders around those
//! of the fits to 15 simulated recordings of five surfaces, 1 to 5.

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::log("peak_hz", (20.0, 1000.0)),
    Usual::linear("order_high_pass", (0.5, 6.0)),
    Usual::linear("order_low_pass", (0.5, 6.0)),
];
