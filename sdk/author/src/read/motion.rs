//! Sliding speed from the finger's position.

/// Length of the moving average over position, and of the step that the speed is taken over, seconds.
/// Trackers are slow (60 Hz is common): a shorter window shows their steps and not the finger.
const WINDOW_S: f64 = 0.05;

/// Speed in mm/s of each sample from one or two coordinates in mm, equally long.
///
/// Position is averaged over 50 ms, and its difference taken over 50 ms round each sample; both
/// windows shrink at the ends.
pub(crate) fn speed_mm_s(coordinates_mm: &[&[f64]], rate_hz: f64) -> Vec<f64> {
    let half = ((WINDOW_S * rate_hz / 2.0).round() as usize).max(1);
    let mut velocities = coordinates_mm
        .iter()
        .map(|position| difference(&moving_average(position, half), half, rate_hz));
    let Some(first) = velocities.next() else {
        return Vec::new();
    };
    velocities.fold(
        first.iter().map(|v| v.abs()).collect(),
        |speed, velocity| {
            speed
                .iter()
                .zip(velocity)
                .map(|(a, b): (&f64, f64)| libm::hypot(*a, b))
                .collect()
        },
    )
}

/// Centred mean over `2 half + 1` samples, fewer at the ends but always as many on either side.
fn moving_average(values: &[f64], half: usize) -> Vec<f64> {
    let mut sums = Vec::with_capacity(values.len() + 1);
    sums.push(0.0);
    let mut sum = 0.0;
    for value in values {
        sum += value;
        sums.push(sum);
    }
    let mean = |at: usize| {
        let reach = half.min(at).min(values.len() - 1 - at);
        (sums[at + reach + 1] - sums[at - reach]) / (2 * reach + 1) as f64
    };
    (0..values.len()).map(mean).collect()
}

fn difference(position: &[f64], half: usize, rate_hz: f64) -> Vec<f64> {
    let last = position.len().saturating_sub(1);
    let slope = |at: usize| {
        let (from, to) = (at.saturating_sub(half), (at + half).min(last));
        (position[to] - position[from]) * rate_hz / (to - from).max(1) as f64
    };
    (0..position.len()).map(slope).collect()
}
