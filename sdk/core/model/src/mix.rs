//! Linear interpolation of parameter sets, as most models use it.

use crate::{Error, Numbers, Values};

/// Returns the set that has weight 1, if there is one.
pub fn sole<'a, 'v>(sets: &'a [Values<'v>], weights: &[f64]) -> Option<&'a Values<'v>> {
    let i = weights.iter().position(|&w| w == 1.0)?;
    sets.get(i)
}

/// Writes the weighted mean of parameter sets. The lists of all sets must have the same lengths.
/// Each number of the mean is limited to the range of the corresponding numbers in the sets. A set
/// with weight 1 is copied unchanged. Does not allocate.
///
/// # Errors
/// Returns an error if the sets differ in length.
pub fn linear(sets: &[Values<'_>], weights: &[f64], out: &mut Numbers<'_>) -> Result<(), Error> {
    if let Some(set) = sole(sets, weights) {
        out.extend(set.flat());
        return Ok(());
    }
    let len = sets.first().map_or(0, |set| set.flat().len());
    if sets.iter().any(|set| set.flat().len() != len) {
        return Err(Error::argument("parameter sets of different lengths cannot be mixed"));
    }
    for i in 0..len {
        let values = || sets.iter().map(|set| set.flat()[i]);
        let sum: f64 = values().zip(weights).map(|(x, weight)| weight * x).sum();
        // The sum of the weights may differ from one by a rounding error. This error could move a
        // parameter out of its range.
        let low = values().fold(f64::INFINITY, f64::min);
        out.push(sum.max(low).min(values().fold(f64::NEG_INFINITY, f64::max)));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{StaticDescriptor, StaticField};

    const DESCRIPTOR: StaticDescriptor =
        StaticDescriptor::new("org.example.x", "X", "1.0.0", "An example.")
            .fields(&[StaticField::scalar("x", "1", (0.0, 0.7), "Something.")]);

    #[test]
    fn rounding_stays_inside_the_range() {
        let flat = [0.7];
        let set = || Values::read(&DESCRIPTOR, &flat).unwrap();
        let sets = [set(), set(), set()];
        for i in 1..1000 {
            let first = f64::from(i) / 1001.0;
            let second = (1.0 - first) / 3.0;
            let weights = [first, second, 1.0 - first - second];
            let mut mixed = [0.0];
            linear(&sets, &weights, &mut Numbers::new(&mut mixed)).unwrap();
            assert_eq!(mixed, [0.7], "{weights:?}");
        }
    }
}
