//! Detection of recordings whose values are friction coefficients although the file declares
//! forces.

use htex_base::finding::Findings;

use crate::Recording;
use crate::segments::{segment_len, sliding};
use htex_recording::Sums;
use htex_recording::rules::RECORDING_FRICTION_COEFFICIENT;

/// Fewest 0.2 s windows of sliding needed to judge how the lateral force depends on the normal
/// force.
const FEWEST: usize = 20;
/// Smallest standard deviation of the logarithm of the normal force: 5 %. If a person tries to keep
/// the force constant, the deviation is 2 to 3 %.
const LEAST_SPREAD: f64 = 0.05;
/// If the exponent of the normal force plus two standard errors is at most this, the lateral force
/// counts as independent of the normal force. For forces on simulated surfaces and in three free
/// motions of a finger, the exponent is 0.97 to 1.03. For the friction coefficients of the same
/// recordings it is -0.03 to 0.03. For a finger whose friction follows its area of contact it is
/// 2/3.
const LARGEST_EXPONENT: f64 = 0.25;

/// Defines the finding of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "- `RECORDING_FRICTION_COEFFICIENT`: of the consecutive segments from the first sample on in which the finger slides at every sample (the last whole \
         segment is left out if it ends with the recording), *x* is the logarithm of the mean normal force and *y* that of the mean length; segments whose means are not both \
         above 0 are left out. There are at least {FEWEST}, and the standard deviation of *x* (over their number) is at least {LEAST_SPREAD}. With *k* the slope of the line of least squares, and its \
         standard error *e*, the root of the mean squared residual over `(n - 2)` times the variance of *x*, `abs(k) + 2 e` is at most {LARGEST_EXPONENT}.\n"
    )
}

/// Fits the logarithm of the lateral force against the logarithm of the normal force, over windows
/// in which the finger slides.
pub(super) fn judge(recording: &Recording, findings: &mut Findings) {
    let Some(line) = logarithms(recording).and_then(|windows| Line::through(&windows)) else {
        return;
    };
    // The error is included, so that an uncertain slope does not cause a finding.
    if line.slope.abs() + 2.0 * line.error > LARGEST_EXPONENT {
        return;
    }
    let axis = format!("/{}", recording.axis_name(0));
    findings.add(RECORDING_FRICTION_COEFFICIENT, axis, format!(
        "the lateral force does not change with the normal force, of which it is the power {:.2} (standard error {:.2}) while the normal force \
         varies by {:.0} %; a friction coefficient does so: multiply it by the force, as in lateral=friction*force,normal=force",
        line.slope,
        line.error,
        100.0 * line.spread
    ));
}

/// Returns the logarithms of normal and lateral force for each window of sliding.
fn logarithms(recording: &Recording) -> Option<Vec<[f64; 2]>> {
    let normal = recording.normal_n.as_ref()?;
    let slides = sliding(recording);
    let normal = Sums::new(normal.iter().copied());
    let lateral = Sums::new((0..recording.samples()).map(|at| recording.magnitude_at(at)));
    let len = segment_len(recording.rate_hz);
    let starts = (0..recording.samples().saturating_sub(len)).step_by(len);
    let windows = starts.filter(|from| slides[*from..from + len].iter().all(|slides| *slides));
    let means = windows.map(|from| [&normal, &lateral].map(|of| of.mean(from, from + len)));
    let positive = means.filter(|means| means.iter().all(|mean| *mean > 0.0));
    Some(positive.map(|means| means.map(libm::log)).collect())
}

/// A least-squares line.
struct Line {
    slope: f64,
    /// Standard error of the slope.
    error: f64,
    /// Standard deviation of the x values.
    spread: f64,
}

impl Line {
    /// Returns the least-squares line through points; `None` if there are too few points or they
    /// are too close together.
    fn through(points: &[[f64; 2]]) -> Option<Self> {
        let count = points.len() as f64;
        let mean = |of: &dyn Fn(&[f64; 2]) -> f64| points.iter().map(of).sum::<f64>() / count;
        let [mx, my] = [mean(&|p| p[0]), mean(&|p| p[1])];
        let xx = mean(&|p| (p[0] - mx).powi(2));
        let slope = mean(&|p| (p[0] - mx) * (p[1] - my)) / xx;
        let rest = mean(&|p| (p[1] - my - slope * (p[0] - mx)).powi(2));
        let spread = xx.sqrt();
        (points.len() >= FEWEST && spread >= LEAST_SPREAD).then(|| Self {
            slope,
            error: (rest / (xx * (count - 2.0))).sqrt(),
            spread,
        })
    }
}
