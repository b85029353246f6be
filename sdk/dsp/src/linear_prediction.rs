//! Linear prediction: `x[t] = Σ A_i x[t-i] + e[t]`, so `H(z) = 1 / (1 - Σ A_i z⁻ⁱ)` (paper,
//! Autoregressive model). A model of order p is p coefficients, or equally p reflection
//! coefficients; it is stable exactly when all of these lie inside (-1, 1).
//!
//! The sign of reflection coefficients is that of the last prediction coefficient of each stage:
//! `k_m = A_m` of the model of order m.

use alloc::vec::Vec;
use core::f64::consts::PI;

/// Largest reflection coefficient an estimate is given, in size. A stage that would exceed it sees
/// a signal predicted completely (a pure line, or rounding): a resonance of 10¹⁰ samples is left.
pub const MAX_REFLECTION: f64 = 1.0 - 1e-10;

/// An all-pole model, always stable.
#[derive(Debug, Clone, PartialEq)]
pub struct LinearPrediction {
    /// `A_1 ..= A_p`.
    pub coefficients: Vec<f64>,
    /// Reflection coefficients, each inside (-1, 1).
    pub reflection: Vec<f64>,
    /// Power of the prediction error, in the squared unit of the signal.
    pub error: f64,
    /// Stages the data determined. Fewer than p where the signal was predicted completely before:
    /// the last usable one was limited to [`MAX_REFLECTION`], the later ones are zero.
    pub usable_stages: usize,
    /// Whether the estimate was changed to be stable (see `usable_stages`, and
    /// [`stabilize`] for the covariance method).
    pub adjusted: bool,
}

impl LinearPrediction {
    /// The model of a signal without power: no prediction, no error.
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

/// Grows a model stage by stage, and stops before it becomes unstable.
pub(crate) struct Stages {
    model: LinearPrediction,
    open: bool,
}

impl Stages {
    /// Starts from a signal of mean square `power`.
    pub(crate) fn new(order: usize, power: f64) -> Self {
        let mut model = LinearPrediction::silent(order);
        let open = power > 0.0 && power.is_finite();
        if open {
            model.error = power;
        }
        Self { model, open }
    }

    /// Power of the error so far.
    pub(crate) fn error(&self) -> f64 {
        self.model.error
    }

    /// The coefficients so far, one a stage.
    pub(crate) fn coefficients(&self) -> &[f64] {
        &self.model.coefficients[..self.model.usable_stages]
    }

    /// Whether another stage may follow.
    pub(crate) fn is_open(&self) -> bool {
        self.open && self.model.usable_stages < self.model.coefficients.len()
    }

    /// Adds a stage; what is too close to ±1 is limited and closes the model.
    pub(crate) fn push(&mut self, reflection: f64) {
        if !self.is_open() || reflection.is_nan() {
            self.open = false;
            return;
        }
        let k = reflection.clamp(-MAX_REFLECTION, MAX_REFLECTION);
        self.open = k == reflection;
        let stage = self.model.usable_stages;
        step_up(&mut self.model.coefficients[..=stage], k);
        self.model.reflection[stage] = k;
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
/// Missing lags count as zero. Any autocorrelation gives a stable model; one without power, or
/// with a lag that is not finite, gives zeros from there on.
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

/// Autocorrelation lags `0..=order` from the power in equally spaced bins from 0 Hz to Nyquist,
/// both included: `r[m] = Σ P_k cos(π k m / (bins - 1))`.
///
/// The power is one-sided (a bin holds what its negative frequency has too), so `r[0]` is the
/// total power. Bins of zero power, as outside the band, are what the model then sees there.
pub fn autocorrelation_from_power(power: &[f64], order: usize) -> Vec<f64> {
    let nyquist = power.len().saturating_sub(1).max(1);
    let cosine =
        |turn: usize| crate::trig::cos(PI * (turn % (2 * nyquist)) as f64 / nyquist as f64);
    (0..=order)
        .map(|m| {
            power
                .iter()
                .enumerate()
                .map(|(k, p)| p * cosine(k * m))
                .sum()
        })
        .collect()
}

/// Prediction coefficients from reflection coefficients.
pub fn reflection_to_coefficients(reflection: &[f64]) -> Vec<f64> {
    let mut coefficients = alloc::vec![0.0; reflection.len()];
    for (stage, &k) in reflection.iter().enumerate() {
        step_up(&mut coefficients[..=stage], k);
    }
    coefficients
}

/// Reflection coefficients of a stable model; `None` if it is unstable or not finite.
///
/// Each stage divides by `1 - k` and `1 + k`: with several poles very near the unit circle digits are
/// lost.
pub fn coefficients_to_reflection(coefficients: &[f64]) -> Option<Vec<f64>> {
    let mut a = coefficients.to_vec();
    step_down_in_place(&mut a).then_some(a)
}

/// As [`coefficients_to_reflection`], in place and without allocating; `false` if the model is
/// unstable or not finite, and `a` is then of no use.
pub fn step_down_in_place(a: &mut [f64]) -> bool {
    for m in (0..a.len()).rev() {
        let k = a[m];
        if k.is_nan() || k.abs() >= 1.0 {
            return false;
        }
        // Each stage leaves its own reflection coefficient at its place.
        step_down(&mut a[..m], k);
    }
    true
}

/// Whether all poles lie inside the unit circle.
pub fn is_stable(coefficients: &[f64]) -> bool {
    coefficients_to_reflection(coefficients).is_some()
}

/// Draws the poles of an unstable model inside: `A_i g^i` with the g that sets the outermost pole
/// to its mirror image in the unit circle, where its magnitude peaks alike. A stable model comes
/// back as it is; one that is not finite becomes zeros.
pub fn stabilize(coefficients: &[f64]) -> Vec<f64> {
    if is_stable(coefficients) {
        return coefficients.to_vec();
    }
    if coefficients.iter().any(|a| !a.is_finite()) {
        return alloc::vec![0.0; coefficients.len()];
    }
    let stable = largest_stable_factor(coefficients, 1.0);
    let mirrored = scale_poles(coefficients, stable * stable);
    if is_stable(&mirrored) {
        mirrored
    } else {
        // Poles on the circle itself: their mirror image is no better.
        scale_poles(coefficients, stable * stable * (1.0 - 1e-6))
    }
}

/// Holds every pole's radius to `radius` (below 1): the model as it is if none lies farther out, else
/// `A_i g^i` with the g that sets the outermost one there. Also mends what rounding of the
/// coefficients has put outside the unit circle. One that is not finite becomes zeros.
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

/// The largest factor of the poles up to `unstable` that is stable, 1 / outermost radius, by
/// bisection: 0 always is.
fn largest_stable_factor(coefficients: &[f64], mut unstable: f64) -> f64 {
    let mut stable = 0.0;
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

/// Multiplies every pole's radius by `factor` (bandwidth expansion): `A_i factor^i`.
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

/// `|H|` at `f_hz` for a model at the rate `rate_hz`: the magnitude for white noise of unit
/// magnitude. Grows without bound towards a pole on the unit circle.
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

/// RMS of the model's output for white noise of unit RMS; `None` if it is unstable.
pub fn white_noise_gain(coefficients: &[f64]) -> Option<f64> {
    coefficients_to_reflection(coefficients).map(|k| reflection_gain(&k))
}

/// RMS of the model's output for white noise of unit RMS: `sqrt(1 / Π(1 - k²))`.
pub fn reflection_gain(reflection: &[f64]) -> f64 {
    let error: f64 = reflection.iter().map(|k| (1.0 - k) * (1.0 + k)).product();
    1.0 / crate::root::sqrt(error)
}

/// Turns the coefficients of order m - 1 (all but the last element) into those of order m.
pub(crate) fn step_up(a: &mut [f64], k: f64) {
    let Some((last, previous)) = a.split_last_mut() else {
        return;
    };
    *last = k;
    let m = previous.len();
    for i in 0..m.div_ceil(2) {
        let (front, back) = (previous[i], previous[m - 1 - i]);
        previous[i] = front - k * back;
        previous[m - 1 - i] = back - k * front;
    }
}

/// Inverse of [`step_up`] on all but the last coefficient: `(front + k back) / (1 - k²)`, by way of sum
/// and difference, neither of which loses digits where |k| is nearly 1.
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
        let power: Vec<f64> = (0..201).map(|k| if k == 40 { 1.0 } else { 0.0 }).collect();
        let model = levinson_durbin(&autocorrelation_from_power(&power, 6), 6);
        assert_eq!(model.usable_stages, 2);
        assert!(model.adjusted && is_stable(&model.coefficients));
        let loudest = (1..200).max_by(|&a, &b| {
            let magnitude = |k: usize| ar_magnitude(&model.coefficients, 5.0 * k as f64, 2000.0);
            magnitude(a).total_cmp(&magnitude(b))
        });
        assert_eq!(loudest, Some(40));
    }

    #[test]
    fn silence_and_nonsense_predict_nothing() {
        for r in [&[0.0, 0.0][..], &[], &[f64::NAN, 1.0], &[-1.0, 2.0]] {
            let model = levinson_durbin(r, 3);
            assert_eq!(model.coefficients, [0.0; 3]);
            assert_eq!((model.error, model.usable_stages), (0.0, 0));
        }
    }

    #[test]
    fn the_outermost_pole_lands_on_its_mirror_image() {
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
