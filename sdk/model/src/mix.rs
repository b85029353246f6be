//! Interpolation that most models share.

use alloc::vec::Vec;

use crate::{Error, Values};

/// The set that has all the weight, if one has.
pub fn sole<'a, 'v>(sets: &'a [Values<'v>], weights: &[f64]) -> Option<&'a Values<'v>> {
    let i = weights.iter().position(|&w| w == 1.0)?;
    sets.get(i)
}

/// The weighted mean of sets whose fields have the same lengths; a set with all the weight comes
/// back to the bit.
///
/// # Errors
/// When the sets differ in length.
pub fn linear(sets: &[Values<'_>], weights: &[f64]) -> Result<Vec<f64>, Error> {
    if let Some(set) = sole(sets, weights) {
        return Ok(set.flat().to_vec());
    }
    let mut mixed = alloc::vec![0.0; sets.first().map_or(0, |set| set.flat().len())];
    for (set, &weight) in sets.iter().zip(weights) {
        if set.flat().len() != mixed.len() {
            return Err(Error::argument(
                "parameter sets of different lengths cannot be mixed",
            ));
        }
        for (sum, &x) in mixed.iter_mut().zip(set.flat()) {
            *sum += weight * x;
        }
    }
    Ok(mixed)
}
