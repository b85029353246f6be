//! Detection of forces and speeds that a finger cannot have.

use htex_base::finding::Findings;

use super::quantile::{median, quantile};
use crate::Recording;
use htex_recording::rules::{
    RECORDING_FRICTION_IMPLAUSIBLE, RECORDING_SPEED_IMPLAUSIBLE, RECORDING_SPEED_ZERO,
};

/// Largest plausible ratio of lateral to normal force. Fingers on smooth, wet glass reach 3 to 5 at
/// a light touch, where adhesion dominates. The limit is twice as high, to allow for offsets of the
/// sensors.
const LARGEST_FRICTION: f64 = 10.0;
/// Speed below which the finger counts as standing still, mm/s. The skin can stretch by a
/// millimetre, which takes a quarter of an hour at this speed.
const STILL_MM_S: f64 = 1e-3;
/// Range of exploration speeds, mm/s. The slowest tribometers for fingers run at 1 mm/s. If a
/// person swings the whole arm, the hand reaches 2 m/s.
const HANDS_MM_S: [f64; 2] = [1.0, 2000.0];
/// The quantile of the speed that is checked. Slower samples may belong to turns and pauses.
const SLIDING: f64 = 0.75;

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    let [slowest, largest] = HANDS_MM_S;
    format!(
        "- `RECORDING_FRICTION_IMPLAUSIBLE`: the median magnitude of the lateral force, the root of the sum of the squares of its axes, exceeds {LARGEST_FRICTION} times the median normal \
         force, or 0 where that is negative.\n\
         - `RECORDING_SPEED_ZERO`: no speed reaches {STILL_MM_S} mm/s. Else `RECORDING_SPEED_IMPLAUSIBLE`: the {SLIDING} quantile of the magnitude of the speed is \
         outside {slowest} to {largest} mm/s.\n"
    )
}

/// Checks the ratio of the medians of lateral and normal force.
pub(super) fn judge_friction(recording: &Recording, findings: &mut Findings) {
    let Some(normal) = recording.normal_n.as_deref().and_then(median) else {
        return;
    };
    let magnitude = |at| recording.magnitude_at(at);
    let lateral = quantile(0.5, recording.samples(), magnitude).unwrap_or(0.0);
    if lateral > LARGEST_FRICTION * normal.max(0.0) {
        findings.add(RECORDING_FRICTION_IMPLAUSIBLE, "/normal", format!(
            "the lateral force is {lateral:.4} N (median) at a normal force of {normal:.4} N; correct the scale of one of \
             them"
        ));
    }
}

/// Checks the upper quartile of the speed.
pub(super) fn judge_speed(recording: &Recording, findings: &mut Findings) {
    let Some(speed) = &recording.speed_mm_s else {
        return;
    };
    let fastest = speed.iter().fold(0.0, |most: f64, speed| most.max(speed.abs()));
    if fastest < STILL_MM_S {
        findings.add(RECORDING_SPEED_ZERO, "/speed", format!(
            "the speed does not exceed {fastest} mm/s in {:.2} s; remove the column, or give the speed",
            recording.duration_s()
        ));
        return;
    }
    let sliding = quantile(SLIDING, speed.len(), |at| speed[at].abs()).unwrap_or(0.0);
    let [slowest, largest] = HANDS_MM_S;
    if !(slowest..=largest).contains(&sliding) {
        let guess = match sliding {
            low if low < slowest => format!(
                "if it is in m/s ({:.4} mm/s), map it with a scale: speed=COLUMN:1000",
                1e3 * low
            ),
            high => format!(
                "if it is in um/s ({:.4} mm/s), map it with a scale: speed=COLUMN:0.001",
                1e-3 * high
            ),
        };
        findings.add(RECORDING_SPEED_IMPLAUSIBLE, "/speed", format!(
            "the upper quartile of the speed is {sliding:.4} mm/s, and hands explore at {slowest} to {largest} mm/s; \
             {guess}"
        ));
    }
}
