//! The wavelet transform of `.hjif`: the biorthogonal 9/7 transform of Cohen, Daubechies & Feauveau
//! (1992, *Comm. Pure Appl. Math.* 45). Blocks are extended by reflection at their ends. The
//! transform is repeated until the lowest band has four coefficients.
//!
//! The transform is computed by lifting (Daubechies & Sweldens 1998, *J. Fourier Anal. Appl.* 4),
//! i.e. by four lifting steps and a scaling. The inverse transform is therefore exact up to
//! rounding. The scaling is the same as in the reference software
//! (source/FilterBank/include/Wavelet.h): the coefficients of the low-pass filter sum to √2.

/// The four lifting steps of the 9/7 transform.
const STEPS: [f64; 4] =
    [-1.586_134_342_059_924, -0.052_980_118_572_961, 0.882_911_075_530_934, 0.443_506_852_043_971];
/// Scale of the low-pass band after the lifting steps.
const SCALE: f64 = 1.149_604_398_860_241;
/// Number of coefficients in the lowest band.
const LOWEST: usize = 4;

/// Transforms a block of samples to coefficients. The coefficients of the lowest band come first.
/// The number of samples must be a power of two.
#[must_use]
pub fn analysed(block: &[f64]) -> Vec<f64> {
    let mut all = block.to_vec();
    let mut len = all.len();
    while len > LOWEST {
        let (low, high) = forward(all.get(..len).unwrap_or_default());
        let next = low.into_iter().chain(high);
        all.iter_mut().zip(next).for_each(|(to, from)| *to = from);
        len /= 2;
    }
    all
}

/// Transforms coefficients back to the samples of a block.
#[must_use]
pub fn synthesised(coefficients: &[f64]) -> Vec<f64> {
    let mut all = coefficients.to_vec();
    let mut len = 2 * LOWEST;
    while len <= all.len() {
        let (low, high) = all.get(..len).unwrap_or_default().split_at(len / 2);
        let samples = backward(low, high);
        all.iter_mut().zip(samples).for_each(|(to, from)| *to = from);
        len *= 2;
    }
    all
}

fn forward(x: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let mut even: Vec<f64> = x.iter().step_by(2).copied().collect();
    let mut odd: Vec<f64> = x.iter().skip(1).step_by(2).copied().collect();
    for pair in STEPS.chunks(2) {
        if let [predict, update] = pair {
            lift_odd(&even, &mut odd, *predict);
            lift_even(&mut even, &odd, *update);
        }
    }
    even.iter_mut().for_each(|x| *x *= SCALE);
    odd.iter_mut().for_each(|x| *x /= -SCALE);
    (even, odd)
}

fn backward(low: &[f64], high: &[f64]) -> Vec<f64> {
    let mut even: Vec<f64> = low.iter().map(|x| x / SCALE).collect();
    let mut odd: Vec<f64> = high.iter().map(|x| x * -SCALE).collect();
    for pair in STEPS.chunks(2).rev() {
        if let [predict, update] = pair {
            lift_even(&mut even, &odd, -update);
            lift_odd(&even, &mut odd, -predict);
        }
    }
    even.into_iter().zip(odd).flat_map(|(even, odd)| [even, odd]).collect()
}

/// Adds a fraction of both neighbours to each odd sample. The last odd sample has only a left
/// neighbour, which counts twice.
fn lift_odd(even: &[f64], odd: &mut [f64], part: f64) {
    let right = even.iter().skip(1).chain(even.last());
    for ((odd, left), right) in odd.iter_mut().zip(even).zip(right) {
        *odd += part * (left + right);
    }
}

/// Adds a fraction of both neighbours to each even sample. The first even sample has only a right
/// neighbour, which counts twice.
fn lift_even(even: &mut [f64], odd: &[f64], part: f64) {
    let left = odd.first().into_iter().chain(odd);
    for ((even, left), right) in even.iter_mut().zip(left).zip(odd) {
        *even += part * (left + right);
    }
}
