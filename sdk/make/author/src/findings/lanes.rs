//! Sums and maxima of long signals. A sum is computed as eight independent partial sums, so that no
//! addition has to wait for the result of the previous addition. The order of the additions affects
//! only the last digits of a sum, and no finding depends on these digits.

const LANES: usize = 8;

/// Returns the sum of `term(index, value)` over all values.
pub(super) fn sum(values: &[f64], term: impl Fn(f64, f64) -> f64) -> f64 {
    let (rounds, rest) = values.as_chunks::<LANES>();
    let mut sums = [0.0; LANES];
    for (round, values) in rounds.iter().enumerate() {
        let first = (round * LANES) as f64;
        for (lane, sum) in sums.iter_mut().enumerate() {
            *sum += term(first + lane as f64, values[lane]);
        }
    }
    let first = rounds.len() * LANES;
    let rest = rest.iter().enumerate().map(|(at, x)| term((first + at) as f64, *x));
    sums.into_iter().chain(rest).sum()
}

/// Returns the largest `term(value)` of all values; minus infinity if there are no values.
pub(super) fn largest(values: &[f64], term: impl Fn(f64) -> f64) -> f64 {
    // `f64::max` also handles NaN, but no term is NaN.
    let larger = |most: f64, x: f64| if x > most { x } else { most };
    let (rounds, rest) = values.as_chunks::<LANES>();
    let mut most = [f64::NEG_INFINITY; LANES];
    for values in rounds {
        for (most, x) in most.iter_mut().zip(values) {
            *most = larger(*most, term(*x));
        }
    }
    most.into_iter().chain(rest.iter().map(|x| term(*x))).fold(f64::NEG_INFINITY, larger)
}
