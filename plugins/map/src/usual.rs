//! The usual ranges of the parameters.

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::linear("width", (1.0, 255.0)),
    Usual::log("pitch_mm", (0.01, 2.0)),
    Usual::log("speed_mm_s", (20.0, 200.0)),
    Usual::linear("force_n", (0.0, 2.0)),
    Usual::log("rms", (1.0, 120.0)),
    Usual::linear("grey", (0.0, 255.0)),
];
