//! The usual ranges of the parameters. The coefficients of the fits to 15 simulated recordings of
//! five surfaces, from -80 to 18, lie inside. The first coefficient, a sum of logarithms, is by far
//! the lowest. The sweep uses the same numbers of bands (`knobs`).

use htex_model::Usual;

pub const USUAL: &[Usual] = &[
    Usual::linear("cepstrum", (-80.0, 20.0)),
    Usual::linear("bands", (20.0, 64.0)),
    Usual::linear("inverse", (0.0, 2.0)),
];
