//! Line spectral frequencies of a stable all-pole model (Itakura 1975). The denominator of the
//! model is the mean of a symmetric and an antisymmetric polynomial. The line spectral frequencies
//! are the angles of the zeros of these two polynomials.
//!
//! The angles of the two polynomials alternate. So any weighted mean of the line spectral
//! frequencies of two stable models belongs to a stable model. This makes line spectral frequencies
//! safe to interpolate.

use alloc::vec::Vec;
use core::f64::consts::PI;

use crate::linear_prediction::coefficients_to_reflection;

/// Limit on the steps of a search. At least every third step halves the bracket. Therefore, this
/// number of steps halves `[0, π]` 56 times, to less than the resolution of f64.
const MOST_STEPS: usize = 3 * 56;
/// Relative phase difference up to which two phases count as equal.
const NEAR: f64 = 4.0 * f64::EPSILON;

/// Returns the p line spectral frequencies in radians, ascending inside (0, π), or `None` if the
/// model is unstable.
///
/// The lattice of the model contains an all-pass filter. The line spectral frequencies are the
/// angles at which the phase of this filter is a multiple of π. The phase decreases monotonically,
/// from 0 at ω = 0 to -(p + 1)π at ω = π. The phase is computed as a sum over the reflection
/// coefficients, so it has no ambiguity of 2π. Therefore, Newton's method inside a bracket finds
/// each angle, at any order.
///
/// ```
/// use htex_dsp::line_spectrum::{from_line_spectral_frequencies, line_spectral_frequencies};
/// let model = [1.5, -0.8];
/// let lsf = line_spectral_frequencies(&model).ok_or("unstable")?;
/// let back = from_line_spectral_frequencies(&lsf).ok_or("out of order")?;
/// assert!((back[0] - 1.5).abs() < 1e-12 && (back[1] + 0.8).abs() < 1e-12);
/// # Ok::<(), &str>(())
/// ```
pub fn line_spectral_frequencies(coefficients: &[f64]) -> Option<Vec<f64>> {
    coefficients_to_reflection(coefficients).map(|k| line_spectral_frequencies_of_reflection(&k))
}

/// Does the same as [`line_spectral_frequencies`], but takes reflection coefficients, each inside
/// (-1, 1).
pub fn line_spectral_frequencies_of_reflection(reflection: &[f64]) -> Vec<f64> {
    lines_of_reflection(reflection).collect()
}

/// Does the same as [`line_spectral_frequencies_of_reflection`], but returns an iterator. Does not
/// allocate.
pub fn lines_of_reflection(reflection: &[f64]) -> impl Iterator<Item = f64> {
    let mut from = 0.0;
    (1..=reflection.len()).map(move |i| {
        from = angle_of_phase(reflection, i as f64 * PI, from);
        from
    })
}

/// Finds the ω in `[from, π]` at which the phase equals `target`.
fn angle_of_phase(reflection: &[f64], target: f64, from: f64) -> f64 {
    let (mut low, mut high) = (from, PI);
    let mut at = 0.5 * (low + high);
    for step in 1..=MOST_STEPS {
        let (lag, slope) = all_pass_lag(reflection, at);
        if lag < target {
            low = at;
        } else {
            high = at;
        }
        if (lag - target).abs() <= NEAR * target {
            break;
        }
        let newton = at - (lag - target) / slope;
        // Newton's method alone has no bound on its steps. A bisection at every third step limits
        // their number (`MOST_STEPS`).
        at = if step % 3 != 0 && newton > low && newton < high {
            newton
        } else {
            0.5 * (low + high)
        };
    }
    at
}

/// Phase lag of `z⁻¹ B_p(z) / A_p(z)` at ω, and its slope; `B` is `A` reversed. One stage maps the
/// lag θ to `ω + θ + 2 arg(1 - k e^{-iθ})`. For |k| < 1, this argument is within ±π/2.
fn all_pass_lag(reflection: &[f64], omega: f64) -> (f64, f64) {
    reflection.iter().fold((omega, 1.0), |(theta, slope), k| {
        let (sine, cosine) = crate::trig::sincos(theta);
        let turn = 2.0 * libm::atan2(k * sine, 1.0 - k * cosine);
        let power = 1.0 - 2.0 * k * cosine + k * k;
        let stretch = 1.0 + 2.0 * k * (cosine - k) / power;
        (omega + theta + turn, 1.0 + slope * stretch)
    })
}

/// Converts line spectral frequencies, in radians, to prediction coefficients. For a stable model,
/// the frequencies must be strictly ascending inside (0, π). Returns `None` if they are not, or if
/// there are more than [`MOST_LINES`] frequencies.
pub fn from_line_spectral_frequencies(lsf: &[f64]) -> Option<Vec<f64>> {
    let mut coefficients = alloc::vec![0.0; lsf.len()];
    coefficients_of_lines(lsf, &mut coefficients).then_some(coefficients)
}

/// Does the same as [`from_line_spectral_frequencies`], but writes to an array of the same length,
/// and returns false instead of `None`. Does not allocate.
pub fn coefficients_of_lines(lsf: &[f64], coefficients: &mut [f64]) -> bool {
    let inside = lsf.iter().all(|&w| w > 0.0 && w < PI);
    let ascend = lsf.windows(2).all(|pair| pair[0] < pair[1]);
    inside && ascend && zeros_of_lines(lsf, coefficients)
}

/// Does the same as [`coefficients_of_lines`], but for a numerator. Its zeros may lie on the unit
/// circle, so two frequencies may be equal, and a frequency may be 0 or π. Returns false if the
/// frequencies are not ascending, or if there are too many.
pub fn zeros_of_lines(lsf: &[f64], coefficients: &mut [f64]) -> bool {
    let mut cosines = [0.0; MOST_LINES];
    let ascend = lsf.windows(2).all(|pair| pair[0] <= pair[1]);
    let Some(cosines) = cosines.get_mut(..lsf.len()).filter(|_| ascend) else {
        return false;
    };
    for (cosine, w) in cosines.iter_mut().zip(lsf) {
        *cosine = crate::trig::cos(*w);
    }
    coefficients_of_cosines(cosines, coefficients);
    true
}

/// Does the same as [`zeros_of_lines`], but takes the cosines of at most [`MOST_LINES`] lines.
///
/// The symmetric and the antisymmetric polynomial each consist of a fixed factor and the quadratic
/// factors of every second line. The coefficients of the product of these quadratic factors are a
/// palindrome, so only half of them are computed. Both polynomials are computed together.
pub fn coefficients_of_cosines(cosines: &[f64], coefficients: &mut [f64]) {
    // If the lines are few, a small array is used, because it takes less time to clear.
    match cosines.len() {
        // 24 lines give 12 factors, and `multiply` needs two more elements.
        0..=24 => Halves::<14>::new(cosines).write(coefficients),
        _ => Halves::<{ MOST_FACTORS + 2 }>::new(cosines).write(coefficients),
    }
}

/// Largest number of line spectral frequencies that can be converted back to a model.
pub const MOST_LINES: usize = 128;
/// Largest number of quadratics in the symmetric polynomial.
const MOST_FACTORS: usize = MOST_LINES / 2;

/// The first halves of the symmetric and of the antisymmetric polynomial, both without their fixed
/// factors. Each is a palindrome of degree `2 factors`: the product `Π (1 - 2 cos ω z⁻¹ + z⁻²)`
/// over every second line. The last coefficient stored is the middle one.
struct Halves<const N: usize> {
    coefficients: [[f64; 2]; N],
    factors: [usize; 2],
}

impl<const N: usize> Halves<N> {
    fn new(cosines: &[f64]) -> Self {
        let mut halves = Self { coefficients: [[0.0; 2]; N], factors: [0; 2] };
        halves.coefficients[0] = [1.0; 2];
        let (pairs, last) = cosines.as_chunks::<2>();
        for i in spread_order(pairs.len()) {
            halves.multiply(pairs[i].map(|cosine| -2.0 * cosine));
        }
        if let [cosine] = last {
            // With an odd number of lines, the symmetric polynomial has one more factor. `multiply`
            // changes both polynomials, so the antisymmetric one is restored afterwards.
            let other = halves.coefficients;
            halves.multiply([-2.0 * cosine, 0.0]);
            let own = halves.coefficients.iter_mut();
            own.zip(other).for_each(|(c, other)| c[1] = other[1]);
            halves.factors[1] -= 1;
        }
        halves
    }

    /// Multiplies each of the two polynomials by a quadratic with the given middle coefficient.
    fn multiply(&mut self, middle: [f64; 2]) {
        let ([k, _], c) = (self.factors, &mut self.coefficients);
        // The coefficient after the middle one is its mirror image.
        c[k + 1] = if k == 0 { [0.0; 2] } else { c[k - 1] };
        let (mut before, mut last) = ([0.0; 2], [0.0; 2]);
        for x in &mut c[..k + 2] {
            let own = *x;
            for i in 0..2 {
                x[i] = (own[i] + before[i]) + middle[i] * last[i];
            }
            (before, last) = (last, own);
        }
        self.factors = self.factors.map(|factors| factors + 1);
    }

    /// Writes the coefficients of half the sum of the two polynomials, each multiplied by its fixed
    /// factor: `(1 + z⁻¹)` and `(1 - z⁻¹)`, or 1 and `(1 - z⁻²)`.
    fn write(&self, coefficients: &mut [f64]) {
        let (back, added) = if coefficients.len().is_multiple_of(2) { (1, 1.0) } else { (2, 0.0) };
        // The coefficients, with two zeros before them and further zeros after them.
        let mut whole = [[[0.0; 2]; 2]; N];
        let whole = whole.as_flattened_mut();
        for (which, k) in self.factors.into_iter().enumerate() {
            for (i, c) in self.coefficients[..=k].iter().enumerate() {
                whole[2 + i][which] = c[which];
                whole[2 + 2 * k - i][which] = c[which];
            }
        }
        let own = whole[3..].iter();
        for (a, (own, below)) in coefficients.iter_mut().zip(own.zip(&whole[3 - back..])) {
            *a = -0.5 * ((own[0] + added * below[0]) + (own[1] - below[1]));
        }
    }
}

/// Returns `0..n` in bit-reversed order, so that neighbours are far apart. In ascending order the
/// product of the first factors would contain large binomial coefficients, which the last factors
/// would cancel.
fn spread_order(n: usize) -> impl Iterator<Item = usize> {
    let bits = n.next_power_of_two().trailing_zeros();
    // For a single factor, the shift would be by all bits of the number. `>>` does not allow this.
    let reversed = move |i: usize| i.reverse_bits().checked_shr(usize::BITS - bits).unwrap_or(0);
    (0..1 << bits).map(reversed).filter(move |&i| i < n)
}
