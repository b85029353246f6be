//! The usual ranges of the parameters: lines from 0 to π, and the rates of the Penn Haptic Texture
//! Toolkit (1 kHz) and of the sweep (`knobs`).

use htex_model::Usual;

use crate::MAX_LINE;

pub const USUAL: &[Usual] = &[
    Usual::linear("pole_lines", (0.0, MAX_LINE)),
    Usual::linear("zero_lines", (0.0, MAX_LINE)),
    Usual::linear("model_rate_hz", (1000.0, 4000.0)),
];
