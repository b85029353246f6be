//! The usual ranges of the parameters: frequencies in the band of textures, and amplitudes up to
//! the square root of 2. A single sinusoid has this amplitude, because half the squares of the
//! amplitudes add up to one.

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::log("frequency_hz", (20.0, 1000.0)),
    Usual::linear("amplitude", (0.0, 1.42)),
    Usual::linear("random_phase", (0.0, 1.0)),
];
