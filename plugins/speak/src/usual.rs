//! The usual ranges of the parameters: frequencies of the band of textures, and amplitudes up to
//! that of a single sinusoid, the square root of 2, since half their squares sum to one.

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::log("frequency_hz", (20.0, 1000.0)),
    Usual::linear("amplitude", (0.0, 1.42)),
    Usual::linear("random_phase", (0.0, 1.0)),
];
