//! The usual ranges of the parameters. The coefficients of the fits to 15 simulated recordings of
//! five surfaces, from -3.4 to 3.3, lie inside. The sweep uses the same rates (`knobs`).

use htex_model::Usual;

pub const USUAL: &[Usual] =
    &[Usual::linear("coefficients", (-4.0, 4.0)), Usual::linear("model_rate_hz", (2000.0, 4000.0))];
