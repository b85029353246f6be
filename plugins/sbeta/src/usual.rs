//! The usual ranges of the parameters. The fits to 15 simulated recordings of five surfaces have
//! 0.8 to 2.3 for alpha and 2.1 to 3.4 for beta. Below 1 the density rises without bound towards
//! its edge; at 20 it is a peak half an octave wide.

use htex_model::Usual;

pub const USUAL: &[Usual] = &[Usual::log("alpha", (0.5, 20.0)), Usual::log("beta", (0.5, 20.0))];
