//! Detection of stuck sensors.

use std::ops::Range;

use htex_base::finding::Findings;
use htex_format::Quantity;

use super::{axis_words, lanes, pointer};
use crate::Recording;
use htex_recording::rules::{RECORDING_SILENT, RECORDING_STUCK};

/// Shortest constant stretch that counts as a stuck sensor, seconds. It is longer than a turn of
/// the hand (0.1 to 0.3 s), and has the length of two and a half segments.
const STUCK_S: f64 = 0.5;
/// Shortest constant stretch near zero that is reported, seconds. Pauses between sweeps are
/// shorter.
const SILENT_S: f64 = 1.0;
/// A value counts as friction if it is further from zero than this fraction of the mean magnitude.
/// Smaller values are rest.
const FRICTION: f64 = 0.5;
/// The finger is at rest below this fraction of the mean speed.
const RESTS: f64 = 0.1;
/// If the normal force changes at more than this fraction of the samples, the sensor resolves
/// noise, so the force should never be constant. Coarsely quantised forces and set points may stay
/// constant.
const LIVELY: f64 = 0.5;

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "- `RECORDING_STUCK` and `RECORDING_SILENT` of an axis: a stretch of one value for at least {STUCK_S} s (rounded down to samples, \
         at least 2), of a value at which the axis is not clipped. Where the speed is known and its mean magnitude above 0, the stretch is stuck if the mean magnitude of the speed in it exceeds \
         {RESTS} of that of the recording, else it is no finding. Where it is not known, the stretch is stuck if the value exceeds {FRICTION} of the axis' mean \
         magnitude, else silent if it lasts at least {SILENT_S} s.\n\
         - `RECORDING_STUCK` of the normal force: stretches as above, if the force changes from one sample to the next more often than \
         {LIVELY} of the number of samples outside of them.\n"
    )
}

/// Finds stretches in which an axis is constant, except at the values at which it is clipped.
pub(super) fn judge_axis(
    recording: &Recording,
    axis: usize,
    clipped: &[f64],
    findings: &mut Findings,
) {
    let values = &recording.axes[axis];
    let (name, words) = (recording.axis_name(axis), axis_words(recording, axis));
    let shortest = |seconds: f64| ((seconds * recording.rate_hz) as usize).max(2);
    let runs = runs(values, shortest(STUCK_S));
    if runs.is_empty() {
        return;
    }
    let magnitude = mean_size(values);
    let (mut stuck, mut silent) = (Vec::new(), Vec::new());
    for run in runs {
        let value = values[run.start];
        // A clipped signal also stays at its limit, but has its own finding.
        if clipped.contains(&value) {
            continue;
        }
        let is_friction = value.abs() > FRICTION * magnitude;
        match finger(recording, &run) {
            Finger::Moves => stuck.push(run),
            Finger::Unknown if is_friction => stuck.push(run),
            Finger::Unknown if run.len() >= shortest(SILENT_S) => silent.push(run),
            Finger::Rests | Finger::Unknown => {}
        }
    }
    for (rule, runs) in [(RECORDING_STUCK, stuck), (RECORDING_SILENT, silent)] {
        if let Some(first) = runs.first() {
            let message = sentence(recording, &words, recording.quantity, values, &runs);
            findings.add(rule, pointer(recording, name, first.start), message);
        }
    }
}

/// Finds constant stretches of a normal force that otherwise varies.
pub(super) fn judge_normal(recording: &Recording, findings: &mut Findings) {
    let Some(values) = &recording.normal_n else {
        return;
    };
    let runs = runs(values, ((STUCK_S * recording.rate_hz) as usize).max(2));
    let Some(first) = runs.first() else {
        return;
    };
    let held: usize = runs.iter().map(Range::len).sum();
    let changes = values.windows(2).filter(|pair| pair[0] != pair[1]).count();
    if changes as f64 > LIVELY * (values.len() - held) as f64 {
        let message = sentence(recording, "normal force", Quantity::NormalForce, values, &runs);
        findings.add(RECORDING_STUCK, pointer(recording, "normal", first.start), message);
    }
}

/// What the finger does in a stretch of a recording.
enum Finger {
    Moves,
    Rests,
    /// The speed is not known, or 0 in the whole recording.
    Unknown,
}

/// Compares the mean speed of a stretch with the recording's mean speed.
fn finger(recording: &Recording, run: &Range<usize>) -> Finger {
    let Some(speed) = &recording.speed_mm_s else {
        return Finger::Unknown;
    };
    let (usual, here) = (mean_size(speed), mean_size(&speed[run.clone()]));
    if usual > 0.0 {
        if here > RESTS * usual { Finger::Moves } else { Finger::Rests }
    } else {
        Finger::Unknown
    }
}

/// Returns the mean absolute value.
pub(super) fn mean_size(values: &[f64]) -> f64 {
    lanes::sum(values, |_, value| value.abs()) / values.len() as f64
}

/// Returns the constant stretches that have at least `shortest` samples.
fn runs(values: &[f64], shortest: usize) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    // Every such stretch contains at least one of these places. From this place, the stretch is
    // followed in both directions.
    let step = (shortest / 2).max(1);
    let (mut at, mut end) = (0, 0);
    while at < values.len() {
        let same = |value: &&f64| **value == values[at];
        let start = at - values[end..at].iter().rev().take_while(same).count();
        end = at + values[at..].iter().take_while(same).count();
        if end - start >= shortest {
            runs.push(start..end);
        }
        at = end.max(at + step);
    }
    runs
}

fn sentence(
    recording: &Recording,
    words: &str,
    quantity: Quantity,
    values: &[f64],
    runs: &[Range<usize>],
) -> String {
    let held: usize = runs.iter().map(Range::len).sum();
    let longest = runs.iter().max_by_key(|run| run.len()).cloned().unwrap_or_default();
    format!(
        "the {words} is constant for {:.2} of {:.2} s, longest at {:.4} {} from {:.3} to {:.3} s; leave it out, \
         or record again",
        held as f64 / recording.rate_hz,
        recording.duration_s(),
        values[longest.start],
        quantity.unit(),
        recording.second(longest.start),
        recording.second(longest.end),
    )
}
