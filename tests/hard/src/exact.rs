//! Linear prediction in exact rational arithmetic, as a reference.

use num_rational::BigRational;
use num_traits::{One, Signed, ToPrimitive, Zero};

/// Converts a number without rounding.
pub fn exact(x: f64) -> BigRational {
    BigRational::from_float(x).unwrap()
}

/// `|x - reference| / |reference|`, or the difference itself if the reference is zero.
pub fn relative_error(x: f64, reference: &BigRational) -> f64 {
    if !x.is_finite() {
        return f64::NAN;
    }
    let off = (exact(x) - reference).abs();
    let off = if reference.is_zero() { off } else { off / reference.abs() };
    off.to_f64().unwrap_or(f64::NAN)
}

/// Reflection coefficients and error power of an autocorrelation, without rounding.
pub fn levinson(lags: &[f64], order: usize) -> (Vec<BigRational>, BigRational) {
    let lags: Vec<BigRational> = lags.iter().map(|&r| exact(r)).collect();
    let (mut a, mut error): (Vec<BigRational>, _) = (Vec::new(), lags[0].clone());
    let mut reflection = Vec::new();
    for m in 0..order {
        let predicted = (0..m).fold(BigRational::zero(), |sum, i| sum + &a[i] * &lags[m - i]);
        let k = (&lags[m + 1] - predicted) / &error;
        let before = a.clone();
        for i in 0..m {
            a[i] -= &k * &before[m - 1 - i];
        }
        a.push(k.clone());
        error *= BigRational::one() - &k * &k;
        reflection.push(k);
    }
    (reflection, error)
}

/// The reflection coefficients of a model, without rounding; `None` if one is not inside (-1, 1).
pub fn step_down(coefficients: &[f64]) -> Option<Vec<BigRational>> {
    let mut a: Vec<BigRational> = coefficients.iter().map(|&a| exact(a)).collect();
    for m in (0..a.len()).rev() {
        let k = a[m].clone();
        if k.abs() >= BigRational::one() {
            return None;
        }
        let scale = BigRational::one() - &k * &k;
        let before = a[..m].to_vec();
        for i in 0..m {
            a[i] = (&before[i] + &k * &before[m - 1 - i]) / &scale;
        }
    }
    Some(a)
}

/// Whether all poles of a model lie inside the unit circle, without rounding.
pub fn is_stable(coefficients: &[f64]) -> bool {
    step_down(coefficients).is_some()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_known_model_comes_back() {
        // x[t] = 0.5 x[t-1] + e[t]: k = [1/2, 0].
        let (k, error) = levinson(&[4.0, 2.0, 1.0], 2);
        assert_eq!(k, [exact(0.5), exact(0.0)]);
        assert_eq!(error, exact(3.0));
        assert_eq!(step_down(&[0.5, 0.0]).unwrap(), k);
        assert!(!is_stable(&[1.0]) && !is_stable(&[2.0, -1.0]) && is_stable(&[1.5, -0.75]));
    }
}
