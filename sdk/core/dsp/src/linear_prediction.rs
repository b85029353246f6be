//! Linear prediction: `x[t] = Σ A_i x[t-i] + e[t]`, so `H(z) = 1 / (1 - Σ A_i z⁻ⁱ)` (paper,
//! Autoregressive model).
//!
//! A model of order p has p prediction coefficients, or, equivalently, p reflection coefficients.
//! The model is stable if, and only if, all reflection coefficients are inside (-1, 1). The
//! reflection coefficient of stage m equals the last prediction coefficient of the model of order
//! m, including its sign: `k_m = A_m`.

use alloc::vec::Vec;
use core::f64::consts::PI;

/// Largest absolute value of an estimated reflection coefficient. If a stage would exceed this
/// limit, the signal is predicted completely: it is a pure sinusoid, or only rounding errors are
/// left. The limit corresponds to a resonance that decays over 10¹⁰ samples.
pub(crate) const MAX_REFLECTION: f64 = 1.0 - 1e-10;

/// A stable all-pole model, and how well it predicts a signal.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearPrediction {
    /// `A_1 ..= A_p`.
    pub coefficients: Vec<f64>,
    /// Reflection coefficients, each inside (-1, 1).
    pub reflection: Vec<f64>,
    /// Power of the prediction error, in the squared unit of the signal.
    pub error: f64,
    /// Number of stages that the data determine. This number is below p if fewer than p stages
    /// predict the signal completely. The magnitude of the last usable reflection coefficient is
    /// then limited to 1 - 1e-10, and the coefficients after it are zero.
    pub usable_stages: usize,
    /// Whether the estimate was changed to make it stable (see `usable_stages`, and [`stabilize`]
    /// for the covariance method).
    pub adjusted: bool,
}

impl LinearPrediction {
    /// The model of a signal without power: zero coefficients, zero error.
    pub(crate) fn silent(order: usize) -> Self {
        Self {
            coefficients: alloc::vec![0.0; order],
            reflection: alloc::vec![0.0; order],
            error: 0.0,
            usable_stages: 0,
            adjusted: order > 0,
        }
    }
}

/// Builds a model stage by stage, and stops before the model becomes unstable.
pub(crate) struct Stages {
    model: LinearPrediction,
    open: bool,
}

impl Stages {
    /// Starts from the mean square `power` of the signal.
    pub(crate) fn new(order: usize, power: f64) -> Self {
        let mut model = LinearPrediction::silent(order);
        let open = power > 0.0 && power.is_finite();
        if open {
            model.error = power;
        }
        Self { model, open }
    }

    /// Prediction error power after the stages so far.
    pub(crate) fn error(&self) -> f64 {
        self.model.error
    }

    /// The prediction coefficients so far, one per stage.
    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.model.coefficients[..self.model.usable_stages]
    }

    /// Whether another stage can be added.
    pub(crate) fn is_open(&self) -> bool {
        self.open && self.model.usable_stages < self.model.coefficients.len()
    }

    /// Adds a stage. A coefficient too close to ±1 is limited, and no further stage can be added.
    pub(crate) fn push(&mut self, reflection: f64) {
        if !self.is_open() || reflection.is_nan() {
            self.open = false;
            return;
        }
        let k = reflection.clamp(-MAX_REFLECTION, MAX_REFLECTION);
        // After a limited stage almost no error is left, and further stages would fit rounding
        // errors.
        self.open = k == reflection;
        let stage = self.model.usable_stages;
        step_up(&mut self.model.coefficients[..=stage], k);
        self.model.reflection[stage] = k;
        // Not `1 - k * k`, which would cancel for |k| near 1.
        self.model.error *= (1.0 - k) * (1.0 + k);
        self.model.usable_stages += 1;
    }

    pub(crate) fn finish(mut self) -> LinearPrediction {
        let complete = self.model.usable_stages == self.model.coefficients.len();
        self.model.adjusted = !complete || !self.open && !self.model.coefficients.is_empty();
        self.model
    }
}

/// Solves the Yule–Walker equations for autocorrelation lags `0..=order` (Levinson–Durbin).
///
/// Missing lags count as zero. The resulting model is stable for every autocorrelation. All
/// coefficients are zero if the signal has no power. If a lag is not finite, the reflection
/// coefficients of its stage and of all later stages are zero.
///
/// ```
/// use htex_dsp::linear_prediction::levinson_durbin;
/// // x[t] = 0.9 x[t-1] + e[t], with error power 1.
/// let r0 = 1.0 / (1.0 - 0.81);
/// let model = levinson_durbin(&[r0, 0.9 * r0, 0.81 * r0], 2);
/// assert!((model.coefficients[0] - 0.9).abs() < 1e-12 && (model.error - 1.0).abs() < 1e-12);
/// ```
pub fn levinson_durbin(autocorrelation: &[f64], order: usize) -> LinearPrediction {
    let lag = |m: usize| autocorrelation.get(m).copied().unwrap_or(0.0);
    let mut stages = Stages::new(order, lag(0));
    while stages.is_open() {
        let a = stages.coefficients();
        let m = a.len();
        let predicted: f64 = (0..m).map(|i| a[i] * lag(m - i)).sum();
        let reflection = (lag(m + 1) - predicted) / stages.error();
        stages.push(reflection);
    }
    stages.finish()
}

/// Converts reflection coefficients to prediction coefficients.
pub fn reflection_to_coefficients(reflection: &[f64]) -> Vec<f64> {
    let mut coefficients = alloc::vec![0.0; reflection.len()];
    for (stage, &k) in reflection.iter().enumerate() {
        step_up(&mut coefficients[..=stage], k);
    }
    coefficients
}

/// Converts the prediction coefficients of a stable model to reflection coefficients. Returns
/// `None` if the model is unstable or not finite.
///
/// Each stage divides by `1 - k` and `1 + k`, so precision is lost if several poles are very close
/// to the unit circle.
pub fn coefficients_to_reflection(coefficients: &[f64]) -> Option<Vec<f64>> {
    let mut a = coefficients.to_vec();
    step_down_in_place(&mut a).then_some(a)
}

/// Does the same as [`coefficients_to_reflection`], in place and without allocating. Returns false
/// if the model is unstable or not finite; the contents of `a` are then unspecified.
pub fn step_down_in_place(a: &mut [f64]) -> bool {
    for m in (0..a.len()).rev() {
        let k = a[m];
        if k.is_nan() || k.abs() >= 1.0 {
            return false;
        }
        // Each stage leaves its reflection coefficient in its own element.
        step_down(&mut a[..m], k);
    }
    true
}

/// Whether all poles lie inside the unit circle.
pub fn is_stable(coefficients: &[f64]) -> bool {
    coefficients_to_reflection(coefficients).is_some()
}

/// Makes an unstable model stable by scaling its poles: the result is `A_i g^i`. The factor g moves
/// the outermost pole to its mirror image in the unit circle, which has the same magnitude peak. A
/// stable model is returned unchanged. If a coefficient is not finite, all coefficients of the
/// result are zero.
pub fn stabilize(coefficients: &[f64]) -> Vec<f64> {
    if is_stable(coefficients) {
        return coefficients.to_vec();
    }
    if coefficients.iter().any(|a| !a.is_finite()) {
        return alloc::vec![0.0; coefficients.len()];
    }
    let stable = largest_stable_factor(coefficients, 1.0);
    // The outermost radius is `1 / stable`, and the radius of its mirror image is `stable`.
    let mirrored = scale_poles(coefficients, stable * stable);
    if is_stable(&mirrored) {
        mirrored
    } else {
        // Poles on the unit circle would stay on it, because they are their own mirror images.
        scale_poles(coefficients, stable * stable * (1.0 - 1e-6))
    }
}

/// Limits the radius of every pole to `radius` (below 1). If a pole lies farther out, the result is
/// `A_i g^i`, where the factor g moves the outermost pole to `radius`. This function also corrects
/// a model whose poles lie outside the unit circle because its coefficients were rounded. If a
/// coefficient is not finite, all coefficients of the result are zero.
///
/// ```
/// use htex_dsp::linear_prediction::within_radius;
/// assert_eq!(within_radius(&[0.5], 0.9), [0.5]);
/// assert!((within_radius(&[1.0], 0.9)[0] - 0.9).abs() < 1e-12);
/// ```
pub fn within_radius(coefficients: &[f64], radius: f64) -> Vec<f64> {
    if is_stable(&scale_poles(coefficients, 1.0 / radius)) {
        return coefficients.to_vec();
    }
    if coefficients.iter().any(|a| !a.is_finite()) {
        return alloc::vec![0.0; coefficients.len()];
    }
    let largest = largest_stable_factor(coefficients, 1.0 / radius);
    scale_poles(coefficients, largest * radius)
}

/// Returns the largest factor, up to `unstable`, by which the poles can be scaled so that the
/// result is stable. This factor is 1 divided by the radius of the outermost pole. The function
/// finds it by bisection, because the factor 0 always gives a stable result.
fn largest_stable_factor(coefficients: &[f64], mut unstable: f64) -> f64 {
    let mut stable = 0.0;
    // 60 halvings reach the resolution of f64.
    for _ in 0..60 {
        let middle = 0.5 * (stable + unstable);
        if is_stable(&scale_poles(coefficients, middle)) {
            stable = middle;
        } else {
            unstable = middle;
        }
    }
    stable
}

/// Multiplies the radius of every pole by `factor` (bandwidth expansion): `A_i factor^i`.
pub fn scale_poles(coefficients: &[f64], factor: f64) -> Vec<f64> {
    let mut power = 1.0;
    coefficients
        .iter()
        .map(|a| {
            power *= factor;
            a * power
        })
        .collect()
}

/// Magnitude `|H|` of a model at `f_hz`, at the sample rate `rate_hz`, both in hertz: the magnitude
/// of the output for white noise of unit magnitude. The magnitude grows without bound near a pole
/// on the unit circle.
pub fn ar_magnitude(coefficients: &[f64], f_hz: f64, rate_hz: f64) -> f64 {
    let omega = 2.0 * PI * f_hz / rate_hz;
    let (mut re, mut im) = (1.0, 0.0);
    for (i, a) in coefficients.iter().enumerate() {
        let (sine, cosine) = crate::trig::sincos(omega * (i + 1) as f64);
        re -= a * cosine;
        im += a * sine;
    }
    1.0 / libm::hypot(re, im)
}

/// Converts the coefficients of order m - 1 (all elements but the last) to coefficients of order m.
pub(crate) fn step_up(a: &mut [f64], k: f64) {
    let Some((last, previous)) = a.split_last_mut() else {
        return;
    };
    *last = k;
    let m = previous.len();
    for i in 0..m.div_ceil(2) {
        // The loop changes two elements at a time, one from each end, because each needs the old
        // value of the other. In the middle of an odd number of elements the two are the same
        // element, and both lines write the same value.
        let (front, back) = (previous[i], previous[m - 1 - i]);
        previous[i] = front - k * back;
        previous[m - 1 - i] = back - k * front;
    }
}

/// Inverse of [`step_up`], for all coefficients but the last: `(front + k back) / (1 - k²)`. The
/// function computes it from the sum and the difference of `front` and `back`, because these stay
/// precise even if |k| is nearly 1.
fn step_down(previous: &mut [f64], k: f64) {
    let m = previous.len();
    let (of_sum, of_difference) = (0.5 / (1.0 - k), 0.5 / (1.0 + k));
    for i in 0..m.div_ceil(2) {
        let (front, back) = (previous[i], previous[m - 1 - i]);
        let (even, odd) = ((front + back) * of_sum, (front - back) * of_difference);
        previous[i] = even + odd;
        previous[m - 1 - i] = even - odd;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pure_line_is_limited_and_reported() {
        let lag = |m: usize| crate::trig::cos(PI * (40 * m) as f64 / 200.0);
        let model = levinson_durbin(&(0..=6).map(lag).collect::<Vec<f64>>(), 6);
        assert_eq!(model.usable_stages, 2);
        assert!(model.adjusted && is_stable(&model.coefficients));
        let loudest = (1..200).max_by(|&a, &b| {
            let magnitude = |k: usize| ar_magnitude(&model.coefficients, 5.0 * k as f64, 2000.0);
            magnitude(a).total_cmp(&magnitude(b))
        });
        assert_eq!(loudest, Some(40));
    }

    #[test]
    fn silence_and_non_finite_input_give_zero_coefficients() {
        for r in [&[0.0, 0.0][..], &[], &[f64::NAN, 1.0], &[-1.0, 2.0]] {
            let model = levinson_durbin(r, 3);
            assert_eq!(model.coefficients, [0.0; 3]);
            assert_eq!((model.error, model.usable_stages), (0.0, 0));
        }
    }

    #[test]
    fn stabilize_moves_the_outermost_pole_to_its_mirror_image() {
        // Poles at 1.25 and 0.5.
        let stable = stabilize(&[1.75, -0.625]);
        assert!(is_stable(&stable));
        let pole = 0.8;
        assert!((pole * pole - stable[0] * pole - stable[1]).abs() < 1e-9);
        assert_eq!(stabilize(&[0.5]), [0.5]);
        assert_eq!(stabilize(&[f64::NAN, 1.0]), [0.0, 0.0]);
        assert!(is_stable(&stabilize(&[2.0, -1.0])));
    }
}
