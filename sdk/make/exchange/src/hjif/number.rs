//! Writes whole numbers as JSON integers, which the reference software requires.

use serde::Serializer;

/// Up to this number, a double represents every integer exactly.
const EXACT: f64 = 9_007_199_254_740_992.0;

pub(super) fn whole<S: Serializer>(number: &f64, serializer: S) -> Result<S::Ok, S::Error> {
    if *number == libm::trunc(*number) && number.abs() <= EXACT {
        serializer.serialize_i64(*number as i64)
    } else {
        serializer.serialize_f64(*number)
    }
}

pub(super) fn whole_or_none<S: Serializer>(
    number: &Option<f64>,
    serializer: S,
) -> Result<S::Ok, S::Error> {
    match number {
        Some(number) => whole(number, serializer),
        None => serializer.serialize_none(),
    }
}
