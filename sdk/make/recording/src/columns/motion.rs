//! Sliding speed, computed from the finger's position.

use crate::sums::Sums;

/// Length of two windows, seconds: of the moving average of the position, and of the difference
/// that gives the speed. Trackers are slow (60 Hz is common). With shorter windows, each new
/// position of the tracker would show as a step in the speed.
const WINDOW_S: f64 = 0.05;

/// Returns the speed at each sample, mm/s, computed from one or two coordinates of the position,
/// mm. Both coordinates must have the same number of samples.
///
/// The position is first averaged over 50 ms. The speed at a sample is the change of this average
/// over a window of 50 ms around the sample, divided by the length of the window. Near the ends of
/// the recording, both windows are shorter.
pub fn speed_mm_s(coordinates_mm: &[&[f64]], rate_hz: f64) -> Vec<f64> {
    let [first, others @ ..] = coordinates_mm else {
        return Vec::new();
    };
    let half = ((WINDOW_S * rate_hz / 2.0).round() as usize).max(1);
    let mut speed: Vec<f64> = velocity(first, half, rate_hz).map(f64::abs).collect();
    for other in others {
        for (speed, velocity) in speed.iter_mut().zip(velocity(other, half, rate_hz)) {
            *speed = libm::hypot(*speed, velocity);
        }
    }
    speed
}

/// Returns the velocity: the change of the averaged position over `2 half` samples around each
/// sample, divided by the time. At the ends it covers fewer samples.
fn velocity(position: &[f64], half: usize, rate_hz: f64) -> impl Iterator<Item = f64> {
    let position = moving_average(position, half);
    let last = position.len().saturating_sub(1);
    (0..position.len()).map(move |at| {
        let (from, to) = (at.saturating_sub(half), (at + half).min(last));
        (position[to] - position[from]) * rate_hz / (to - from).max(1) as f64
    })
}

/// Returns the mean over `2 half + 1` samples. At the ends it covers fewer samples, but stays
/// symmetric around the sample.
fn moving_average(values: &[f64], half: usize) -> Vec<f64> {
    let sums = Sums::new(values.iter().copied());
    let mean = |at: usize| {
        let reach = half.min(at).min(values.len() - 1 - at);
        sums.mean(at - reach, at + reach + 1)
    };
    (0..values.len()).map(mean).collect()
}
