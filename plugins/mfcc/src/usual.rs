//! The usual ranges of the parameters, outside the fits to 15 simulated recordings of five
//! surfaces: coefficients of -80 to 18, of which the first, a sum of logarithms, is by far the
//! lowest. The bands are those of the sweep (`knobs`).

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::linear("cepstrum", (-80.0, 20.0)),
    Usual::linear("bands", (20.0, 64.0)),
    Usual::linear("inverse", (0.0, 2.0)),
];
