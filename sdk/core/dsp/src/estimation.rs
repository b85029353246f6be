//! Linear prediction from signals: Yule–Walker, Burg and covariance method.
//!
//! Each method takes several segments of one random process, and computes its sums over all
//! segments. No window is applied, and no prediction crosses a boundary between segments. For a
//! single signal, pass `&[signal]`. Segments that are not longer than the order contribute nothing.

use alloc::vec::Vec;

use crate::least_squares::PseudoInverse;
use crate::linear_prediction::{
    LinearPrediction, Stages, coefficients_to_reflection, levinson_durbin, stabilize,
};

/// Returns the biased autocorrelation for the lags `0..=order`: `r[m] = Σ x[n] x[n + m] / N`. The
/// sum runs over all segments, and N is the number of all their samples. Returns zeros if there are
/// no samples.
pub fn autocorrelation(segments: &[&[f64]], order: usize) -> Vec<f64> {
    let total: usize = segments.iter().map(|segment| segment.len()).sum();
    (0..=order)
        .map(|m| {
            let sum: f64 = segments.iter().map(|segment| lagged_product(segment, m)).sum();
            sum / total.max(1) as f64
        })
        .collect()
}

fn lagged_product(segment: &[f64], lag: usize) -> f64 {
    let later = segment.get(lag..).unwrap_or(&[]);
    segment.iter().zip(later).map(|(x, y)| x * y).sum()
}

/// Yule–Walker estimate: [`levinson_durbin`] on the biased autocorrelation.
pub fn yule_walker(segments: &[&[f64]], order: usize) -> LinearPrediction {
    levinson_durbin(&autocorrelation(segments, order), order)
}

/// Burg's estimate: each reflection coefficient minimises the sum of forward and backward error
/// power (Burg 1975). For short signals, this estimate resolves frequencies better than the
/// Yule–Walker estimate. The model is always stable.
pub fn burg(segments: &[&[f64]], order: usize) -> LinearPrediction {
    let mut errors: Vec<BurgErrors> = segments.iter().map(|s| BurgErrors::new(s)).collect();
    let mut stages = Stages::new(order, autocorrelation(segments, 0)[0]);
    let mut sums = added(errors.iter().map(BurgErrors::sums));
    while stages.is_open() {
        let (cross, power) = sums;
        // If the segments are too short for another stage, the quotient is 0 / 0, i.e. NaN, which
        // `push` refuses.
        let reflection = 2.0 * cross / power;
        stages.push(reflection);
        sums = added(errors.iter_mut().map(|error| error.advance(reflection)));
    }
    stages.finish()
}

/// Adds up the sums of all segments.
fn added(sums: impl Iterator<Item = (f64, f64)>) -> (f64, f64) {
    sums.fold((0.0, 0.0), |(cross, power), (c, p)| (cross + c, power + p))
}

/// Forward error at n and backward error at n - 1 of one segment.
struct BurgErrors {
    forward: Vec<f64>,
    backward: Vec<f64>,
}

impl BurgErrors {
    fn new(segment: &[f64]) -> Self {
        Self {
            forward: segment.get(1..).unwrap_or(&[]).to_vec(),
            backward: segment[..segment.len().saturating_sub(1)].to_vec(),
        }
    }

    /// `Σ f b` and `Σ f² + b²`.
    fn sums(&self) -> (f64, f64) {
        let pairs = self.forward.iter().zip(&self.backward);
        pairs.fold((0.0, 0.0), |(cross, power), (f, b)| (cross + f * b, power + f * f + b * b))
    }

    /// Advances to the next stage: updates both errors, and delays the backward error by one
    /// sample. Returns the sums of that stage.
    fn advance(&mut self, k: f64) -> (f64, f64) {
        let (forward, backward) = (&mut self.forward[..], &mut self.backward[..]);
        let (mut cross, mut power) = (0.0, 0.0);
        // The next stage pairs each forward error with the backward error one sample earlier.
        // Therefore, the forward errors move down by one element.
        let mut delayed = None;
        for i in 0..forward.len().min(backward.len()) {
            let (f, b) = (forward[i], backward[i]);
            let (next, later) = (f - k * b, b - k * f);
            backward[i] = later;
            if let Some(earlier) = delayed.replace(later) {
                forward[i - 1] = next;
                cross += next * earlier;
                power = power + next * next + earlier * earlier;
            }
        }
        self.forward.pop();
        self.backward.pop();
        (cross, power)
    }
}

/// Covariance estimate: least squares of the forward error, over all samples that have `order`
/// predecessors in their segment. The estimate is exact for noiseless resonances, but may be
/// unstable. The function makes an unstable estimate stable with [`stabilize`], and then sets
/// `adjusted` in the result. `error` is the residual power per predicted sample before this
/// correction.
pub fn covariance(segments: &[&[f64]], order: usize) -> LinearPrediction {
    let long: Vec<&[f64]> = segments.iter().copied().filter(|s| s.len() > order).collect();
    let count: usize = long.iter().map(|s| s.len() - order).sum();
    let gram = covariance_matrix(&long, order);
    let stride = order + 1;
    // Products of finite samples overflow from 1e154 on.
    if !gram.iter().all(|g| g.is_finite()) {
        return LinearPrediction::silent(order);
    }
    let matrix: Vec<f64> =
        (1..stride).flat_map(|i| gram[i * stride + 1..(i + 1) * stride].iter().copied()).collect();
    let inverse = PseudoInverse::new(&matrix, order, order);
    let mut coefficients = alloc::vec![0.0; order];
    inverse.apply(&gram[1..stride], &mut coefficients);
    let explained: f64 = coefficients.iter().zip(&gram[1..]).map(|(a, g)| a * g).sum();
    // If the signal is predicted completely, only a rounding error is left, which may be negative.
    let error = (gram[0] - explained).max(0.0) / count.max(1) as f64;
    stable_model(coefficients, error, inverse.rank())
}

/// `Σ_n x[n - i] x[n - j]` for i, j in `0..=order`, row after row.
fn covariance_matrix(segments: &[&[f64]], order: usize) -> Vec<f64> {
    let stride = order + 1;
    let mut gram = alloc::vec![0.0; stride * stride];
    for i in 0..stride {
        for j in i..stride {
            let product = |s: &&[f64]| -> f64 {
                let (x, y) = (&s[order - i..s.len() - i], &s[order - j..s.len() - j]);
                x.iter().zip(y).map(|(x, y)| x * y).sum()
            };
            let sum = segments.iter().map(product).sum();
            gram[i * stride + j] = sum;
            gram[j * stride + i] = sum;
        }
    }
    gram
}

fn stable_model(coefficients: Vec<f64>, error: f64, rank: usize) -> LinearPrediction {
    let order = coefficients.len();
    if let Some(reflection) = coefficients_to_reflection(&coefficients) {
        return LinearPrediction {
            coefficients,
            reflection,
            error,
            usable_stages: rank,
            adjusted: rank < order,
        };
    }
    let coefficients = stabilize(&coefficients);
    match coefficients_to_reflection(&coefficients) {
        Some(reflection) => LinearPrediction {
            coefficients,
            reflection,
            error,
            usable_stages: rank,
            adjusted: true,
        },
        None => LinearPrediction::silent(order),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linear_prediction::is_stable;

    fn decaying(radius: f64) -> Vec<f64> {
        let (mut x, mut y) = (1.0, 0.3);
        (0..200)
            .map(|_| {
                (x, y) = (2.0 * radius * 0.8 * x - radius * radius * y, x);
                x
            })
            .collect()
    }

    #[test]
    fn covariance_finds_a_noiseless_resonance_and_mirrors_a_growing_one() {
        let model = covariance(&[&decaying(0.98)], 2);
        assert!((model.coefficients[0] - 1.568).abs() < 1e-9 && !model.adjusted);
        let grown = covariance(&[&decaying(1.01)], 2);
        assert!(grown.adjusted && is_stable(&grown.coefficients));
        assert!((grown.coefficients[1] + 1.0 / 1.0201).abs() < 1e-6);
        // The signal has two poles only.
        let more = covariance(&[&decaying(0.98)], 3);
        assert!(more.adjusted && more.usable_stages == 2);
    }

    #[test]
    fn pooling_copies_changes_nothing_and_short_or_silent_segments_are_harmless() {
        let x = decaying(0.9);
        for estimate in [yule_walker, burg, covariance] {
            let (one, two) = (estimate(&[&x], 4), estimate(&[&x, &x], 4));
            for (a, b) in one.reflection.iter().zip(&two.reflection) {
                assert!((a - b).abs() < 1e-6);
            }
            for segments in [&[][..], &[&[][..]], &[&[1.0][..]], &[&[0.0; 50][..]]] {
                let model = estimate(segments, 4);
                assert_eq!(model.coefficients.len(), 4);
                assert!(is_stable(&model.coefficients));
                let heard = segments.concat().iter().any(|&x| x != 0.0);
                assert!(heard || model.adjusted && model.usable_stages == 0);
            }
            for broken in [f64::NAN, f64::INFINITY, 1e200] {
                for order in [0, 4] {
                    let model = estimate(&[&[&[broken, 1.0][..], &x].concat()], order);
                    assert_eq!(model.coefficients, alloc::vec![0.0; order]);
                    assert_eq!((model.error, model.usable_stages), (0.0, 0));
                    assert_eq!(model.adjusted, order > 0);
                }
            }
        }
    }
}
