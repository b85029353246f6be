//! No options: a map is as large as it may be.

use htex_model::Knobs;

pub const KNOBS: Knobs = Knobs {
    together: &[],
    alone: &[],
    not_above: None,
};
