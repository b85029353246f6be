//! Exponentials of slices of numbers, computed with vector instructions.

use core::f64::consts::{LN_2, LOG2_E};

use crate::wide::{Work, wide};

/// Adding this number rounds: if x has a magnitude below 2⁵¹, the low bits of the sum of both are
/// the integer nearest to x.
const ROUND: f64 = 1.5 * (1u64 << 52) as f64;
/// Count of numbers that are computed side by side. Only WASM modules need this, because they are
/// compiled without the vectorisation of loops (`xtask/src/wasm.rs`).
const GROUP: usize = if cfg!(target_family = "wasm") { 4 } else { 1 };
/// Range to which inputs are clamped. The exponentials at both ends are normal numbers.
const RANGE: (f64, f64) = (-700.0, 700.0);
/// Taylor coefficients, highest first. For arguments up to half of ln 2 the truncation error is
/// below 3e-10.
const TAYLOR: [f64; 9] = taylor();

const fn taylor() -> [f64; 9] {
    let mut terms = [1.0; 9];
    let mut i = 1;
    let mut factorial = 1.0;
    while i < terms.len() {
        factorial *= i as f64;
        terms[terms.len() - 1 - i] = 1.0 / factorial;
        i += 1;
    }
    terms
}

/// Replaces each number by its exponential, with a relative error below 1e-9. Inputs are clamped to
/// ±700; NaN counts as -700. The code has no branches, so compilers vectorise it. The results are
/// bit-identical on every machine.
///
/// ```
/// let mut numbers = [0.0, 1.0];
/// htex_dsp::exponential::exponentials(&mut numbers);
/// assert!(numbers[0] == 1.0 && (numbers[1] - std::f64::consts::E).abs() < 1e-8);
/// ```
pub fn exponentials(numbers: &mut [f64]) {
    wide(Exponentials(numbers));
}

struct Exponentials<'a>(&'a mut [f64]);

impl Work for Exponentials<'_> {
    #[inline(always)]
    fn run(self) {
        let (groups, rest) = self.0.as_chunks_mut::<GROUP>();
        for group in groups {
            let mut now = *group;
            for x in &mut now {
                *x = exponential(*x);
            }
            *group = now;
        }
        for x in rest {
            *x = exponential(*x);
        }
    }
}

/// `2^k exp(r)`, where `k` is the integer nearest to `x / ln 2`.
#[inline(always)]
fn exponential(x: f64) -> f64 {
    // This is not written as `clamp`, because `clamp` would keep NaN.
    #[allow(clippy::manual_clamp)]
    let x = x.max(RANGE.0).min(RANGE.1);
    let rounded = x * LOG2_E + ROUND;
    // One constant for ln 2 is enough for an error of 1e-9. Math libraries need two.
    let r = x - (rounded - ROUND) * LN_2;
    let mut sum = TAYLOR[0];
    for term in &TAYLOR[1..] {
        sum = sum * r + term;
    }
    // The integer is in the low bits of `rounded`, and the shift drops all other bits. A library
    // function for the power of two would have branches.
    sum * f64::from_bits(rounded.to_bits().wrapping_add(1023) << 52)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exponentials_match_the_math_library() {
        let numbers: alloc::vec::Vec<f64> =
            (-70_000..=70_000).map(|i| 0.01 * f64::from(i)).collect();
        let mut found = numbers.clone();
        exponentials(&mut found);
        for (x, y) in numbers.iter().zip(found) {
            let expected = libm::exp(*x);
            assert!((y / expected - 1.0).abs() < 1e-9, "{x}: {y} {expected}");
        }
        let mut odd = [f64::NAN, f64::NEG_INFINITY, f64::INFINITY];
        exponentials(&mut odd);
        assert!(odd[0] == odd[1] && odd[0] < 1e-303 && odd[2] > 1e303 && odd[2].is_finite());
    }
}
