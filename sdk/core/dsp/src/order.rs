//! Sorts values of all types with one compiled copy of the standard library's generic sort. A
//! further copy, for another type or comparison, would add some 6 kB to a program.

use core::cmp::Ordering;

use alloc::vec::Vec;

/// Returns the indices below `len`, sorted by comparing the items at these indices. Equal items
/// keep their order.
///
/// ```
/// let names = ["cork", "ash", "birch"];
/// assert_eq!(htex_dsp::order::order(3, &|a, b| names[a].cmp(names[b])), [1, 2, 0]);
/// ```
pub fn order(len: usize, compare: &dyn Fn(usize, usize) -> Ordering) -> Vec<usize> {
    let mut order: Vec<usize> = (0..len).collect();
    order.sort_by(|a, b| compare(*a, *b));
    order
}

/// Sorts values by a comparison. Equal values keep their order.
///
/// ```
/// let mut values = [3.0, 1.0, 2.0];
/// htex_dsp::order::sort_by(&mut values, f64::total_cmp);
/// assert_eq!(values, [1.0, 2.0, 3.0]);
/// ```
pub fn sort_by<T>(values: &mut [T], compare: impl Fn(&T, &T) -> Ordering) {
    let mut from = order(values.len(), &|a, b| compare(&values[a], &values[b]));
    // Follows each cycle of the permutation once. A position that is finished points to itself.
    for start in 0..from.len() {
        let mut at = start;
        while from[at] != start {
            let next = from[at];
            values.swap(at, next);
            from[at] = at;
            at = next;
        }
        from[at] = at;
    }
}

/// Sorts values by their own order. Equal values keep their order.
pub fn sort<T: Ord>(values: &mut [T]) {
    sort_by(values, T::cmp);
}

#[cfg(test)]
mod tests {
    use super::*;
    use alloc::vec;

    #[test]
    fn it_is_the_stable_sort_of_the_standard_library() {
        let mut state = 1u64;
        for len in 0..200 {
            let mut values = vec![(0, 0); len];
            for (i, value) in values.iter_mut().enumerate() {
                state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                *value = ((state >> 33) % 20, i);
            }
            let mut expected = values.clone();
            expected.sort_by_key(|(key, _)| *key);
            sort_by(&mut values, |a, b| a.0.cmp(&b.0));
            assert_eq!(values, expected);
        }
    }
}
