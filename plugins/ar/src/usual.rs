//! The usual ranges of the parameters, outside the fits to 15 simulated recordings of five
//! surfaces: coefficients of -3.4 to 3.3. The rates are those of the sweep (`knobs`).

use htex_model::Usual;

pub const USUAL: &[Usual] =
    &[Usual::linear("coefficients", (-4.0, 4.0)), Usual::linear("model_rate_hz", (2000.0, 4000.0))];
