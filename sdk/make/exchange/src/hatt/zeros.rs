//! Mirrors zeros that lie outside the unit circle to the inside. Noise that passes through the
//! mirrored filter has the same spectrum as before, except for a constant gain.

use std::f64::consts::TAU;

use htex_dsp::linear_prediction::step_down_in_place;
use htex_dsp::spectrum::Complex;

use super::work::Work;

/// Largest radius of a zero after mirroring.
const MOST_RADIUS: f64 = 1.0 - 1e-7;
/// Largest number of rounds that improve the roots. Some ten rounds are enough, unless roots are
/// equal.
const ROUNDS: usize = 500;
/// Number of angles at which the result is compared with the original polynomial.
const COMPARED: u32 = 512;
/// Largest allowed difference between the result and the original polynomial, relative to the
/// largest power.
const MOST_ERROR: f64 = 1e-6;

/// Why the zeros of a polynomial could not be found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum NotFound {
    /// The search failed for the coefficients of this polynomial.
    Here,
    /// The zeros of all filters in the file would take too much computation.
    TooMuch,
}

/// Returns the coefficients `B_1` to `B_q` of a polynomial `1 + Σ B_i z⁻ⁱ` with all zeros inside
/// the unit circle, and a gain. On the circle, this polynomial multiplied by the gain has the same
/// absolute value as the given polynomial.
pub(super) fn inside(coefficients: &[f64], work: &mut Work) -> Result<(Vec<f64>, f64), NotFound> {
    let mut reflection: Vec<f64> = coefficients.iter().map(|b| -b).collect();
    // The step-down recursion succeeds only if all zeros already lie inside.
    if step_down_in_place(&mut reflection) {
        return Ok((coefficients.to_vec(), 1.0));
    }
    // Trailing coefficients of 0 are zeros at the origin. The search leaves them out.
    let order = coefficients.iter().rposition(|b| *b != 0.0);
    let used = order.and_then(|last| coefficients.get(..=last)).ok_or(NotFound::Here)?;
    let (mut gain, mut zeros) = (1.0, roots(used, work)?);
    for zero in &mut zeros {
        let radius = zero.norm_sqr().sqrt();
        if radius > 1.0 {
            gain *= radius;
            // The mirror image of z at the unit circle is 1 / conj(z) = z / |z|².
            *zero /= radius * radius;
        }
        let moved = zero.norm_sqr().sqrt();
        if moved > MOST_RADIUS {
            *zero *= MOST_RADIUS / moved;
        }
    }
    let mut made = product(&zeros);
    // Zeros that are close to each other are found with few digits, so the result is compared with
    // the original.
    if !is_same(used, &made, gain) {
        return Err(NotFound::Here);
    }
    made.resize(coefficients.len(), 0.0);
    Ok((made, gain))
}

/// Finds all zeros of `z^n + Σ B_i z^(n-i)` at once (Aberth 1973).
fn roots(coefficients: &[f64], work: &mut Work) -> Result<Vec<Complex<f64>>, NotFound> {
    let order = coefficients.len();
    let last = coefficients.last().ok_or(NotFound::Here)?.abs();
    // The last coefficient is the product of all zeros, so this is their mean radius.
    let radius = libm::pow(last, 1.0 / order as f64).max(1e-3);
    // Adding 0.25 prevents starting points that are symmetric about the real axis.
    let start = |i: usize| turned(radius, TAU * (i as f64 + 0.25) / order as f64);
    let mut zeros: Vec<Complex<f64>> = (0..order).map(start).collect();
    for _ in 0..ROUNDS {
        work.add(order * order).ok_or(NotFound::TooMuch)?;
        let mut moved = 0.0f64;
        for i in 0..order {
            let at = *zeros.get(i).ok_or(NotFound::Here)?;
            let (value, slope) = value_and_slope(coefficients, at);
            let newton = value / slope;
            let others = zeros.iter().enumerate().filter(|(j, _)| *j != i);
            let pushed: Complex<f64> = others.map(|(_, other)| (at - other).inv()).sum();
            let step = newton / (Complex::new(1.0, 0.0) - newton * pushed);
            // The slope may be 0, or two estimates may be equal. Then this zero stays until the
            // others have moved.
            if step.re.is_finite() && step.im.is_finite() {
                *zeros.get_mut(i).ok_or(NotFound::Here)? -= step;
                moved = moved.max(step.norm_sqr() / at.norm_sqr().max(1e-30));
            }
        }
        // `moved` is a square, so this is a relative step of 1e-15, about the precision of a
        // double.
        if moved < 1e-30 {
            break;
        }
    }
    Ok(zeros)
}

fn value_and_slope(coefficients: &[f64], at: Complex<f64>) -> (Complex<f64>, Complex<f64>) {
    let one = Complex::new(1.0, 0.0);
    let begin = (one, Complex::new(0.0, 0.0));
    coefficients.iter().fold(begin, |(value, slope), b| (value * at + b, slope * at + value))
}

fn turned(radius: f64, angle: f64) -> Complex<f64> {
    Complex::new(radius * libm::cos(angle), radius * libm::sin(angle))
}

/// Returns the coefficients, from `B_1` on, of the polynomial with these zeros. They come in
/// conjugate pairs.
fn product(zeros: &[Complex<f64>]) -> Vec<f64> {
    let mut made = vec![Complex::new(1.0, 0.0)];
    for zero in zeros {
        let before = made.clone();
        made.push(Complex::new(0.0, 0.0));
        for (b, previous) in made.iter_mut().skip(1).zip(before) {
            *b -= previous * zero;
        }
    }
    // The zeros of real coefficients come in conjugate pairs, so imaginary parts are only rounding
    // errors.
    made.iter().skip(1).map(|b| b.re).collect()
}

/// Returns whether two polynomials have the same power on the circle, after the second is
/// multiplied by the gain.
fn is_same(a: &[f64], b: &[f64], gain: f64) -> bool {
    let at = |i: u32| TAU / 2.0 * f64::from(i) / f64::from(COMPARED);
    let powers = (0..=COMPARED).map(at).map(|w| (power(a, w), power(b, w) * gain * gain));
    let powers: Vec<(f64, f64)> = powers.collect();
    let largest = powers.iter().map(|(a, _)| *a).fold(0.0, f64::max);
    powers.iter().all(|(a, b)| (a - b).abs() <= MOST_ERROR * largest)
}

/// Returns the squared absolute value of `1 + Σ B_i z⁻ⁱ` at an angle on the unit circle.
fn power(coefficients: &[f64], angle: f64) -> f64 {
    let step = turned(1.0, -angle);
    let sum = coefficients.iter().rev().fold(Complex::new(0.0, 0.0), |sum, b| (sum + b) * step);
    (sum + 1.0).norm_sqr()
}

#[cfg(test)]
#[allow(clippy::unwrap_used)] // A failed unwrap is a failed test.
mod tests {
    use super::*;

    /// Zeros outside, on and inside the circle, single and in pairs. Zeros that are inside stay as
    /// they are.
    #[test]
    fn mirror_images_have_the_same_power() {
        let pair = |radius: f64, angle: f64| [turned(radius, angle), turned(radius, -angle)];
        for zeros in [
            vec![Complex::new(1.25, 0.0)],
            [pair(2.0, 0.7), pair(0.5, 2.0), pair(1.0, 1.1)].concat(),
            [&pair(1.001, 0.3)[..], &[Complex::new(-1.0, 0.0), Complex::new(1.0, 0.0)]].concat(),
            (1..9).flat_map(|i| pair(0.6 + 0.1 * f64::from(i), 0.37 * f64::from(i))).collect(),
        ] {
            let given = product(&zeros);
            let (found, gain) = inside(&given, &mut Work::default()).unwrap();
            let mut reflection: Vec<f64> = found.iter().map(|b| -b).collect();
            assert!(step_down_in_place(&mut reflection), "{zeros:?}");
            assert!(is_same(&given, &found, gain));
            assert!(gain >= 1.0);
        }
        for given in [&[0.5, 0.1][..], &[], &[0.0, 0.0]] {
            let found = inside(given, &mut Work::none());
            assert_eq!(found, Ok((given.to_vec(), 1.0)));
        }
        assert_eq!(inside(&[2.0], &mut Work::none()), Err(NotFound::TooMuch));
    }
}
