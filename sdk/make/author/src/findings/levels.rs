//! Detection of clipping and of coarse quantisation.

use htex_base::finding::Findings;

use super::stuck::mean_size;
use super::{axis_words, lanes, pointer};
use crate::{Recording, segment_len};
use htex_recording::rules::{RECORDING_CLIPPED, RECORDING_COARSE};

/// A signal with fewer different values than this counts as coarsely quantised. At 4 bits the
/// quantisation noise is 26 dB below full scale (6.02 · 4 + 1.76), close to the scatter of the
/// spectrum itself.
const FEWEST_LEVELS: usize = 16;
/// A signal counts as clipped if at least this fraction of all samples is at an extreme value.
/// Noise clipped at 2.3 times its RMS reaches this fraction, with a distortion of -24 dB. Less
/// clipping does not justify another recording.
const CLIPPED: f64 = 0.01;
/// The number of samples at the extreme value must be at least this many times the number of
/// samples in the range next to it ([`BESIDE`]). At the top of a quantised sine the ratio is two.
const OVER_BESIDE: usize = 4;
/// Width of the range next to the extreme value, relative to the whole range; at least one step of
/// the converter. A texture on a plateau fills a few percent of the whole range densely and must
/// not count as one value.
const BESIDE: f64 = 0.001;
/// Fewest separate visits to the limit. If a signal reaches the limit only once or twice, it counts
/// as stuck and not as clipped.
const FEWEST_VISITS: usize = 3;
/// Smallest distance of a limit from zero, relative to the mean magnitude. If a value is closer to
/// zero, the finger is at rest.
const REST: f64 = 0.5;

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "- `RECORDING_COARSE`: an axis of at least one segment (0.2 s) has 2 to {} different values. Nothing else is then checked of it.\n\
         - `RECORDING_CLIPPED`: on either side let *t* be the extreme value, and *b* the next value or *t* less {BESIDE} of the range from \
         lowest to highest, whichever is further from *t*. The side is clipped if \\|*t*\\| is at least {REST} of the mean magnitude, at least \
         {CLIPPED} of all samples have the value *t*, and these are at least {OVER_BESIDE} times as many as those from *b* to *t*, without *t*. \
         The finding needs at least {FEWEST_VISITS} separate stretches at *t*, on both clipped sides together. An axis shorter than a segment, or of \
         one value, is not checked.\n",
        FEWEST_LEVELS - 1
    )
}

/// Result of checking the values of an axis.
pub(super) enum Levels {
    /// The axis has too few different values for any other check.
    Coarse,
    /// The axis has enough different values. The list contains the values at which the signal is
    /// clipped; it is empty if the signal is not clipped.
    ClippedAt(Vec<f64>),
}

/// Finds coarse quantisation and clipping in recordings of at least one segment.
pub(super) fn judge(recording: &Recording, axis: usize, findings: &mut Findings) -> Levels {
    let values = &recording.axes[axis];
    let (name, words) = (recording.axis_name(axis), axis_words(recording, axis));
    if values.len() < segment_len(recording.rate_hz) {
        return Levels::ClippedAt(Vec::new());
    }
    match count_levels(values) {
        1 => return Levels::ClippedAt(Vec::new()),
        // Counting stops at this number, so the signal has this many or more different values.
        FEWEST_LEVELS => {}
        levels => {
            findings.add(RECORDING_COARSE, format!("/{name}"), format!(
                "the {words} has only {levels} different values in {} samples; raise the gain or write more digits",
                values.len()
            ));
            return Levels::Coarse;
        }
    }
    let magnitude = mean_size(values);
    let mut clips: Vec<Clip> =
        [1.0, -1.0].into_iter().filter_map(|side| clip(values, side, magnitude)).collect();
    if clips.iter().map(|clip| clip.visits).sum::<usize>() < FEWEST_VISITS {
        clips.clear();
    }
    if let Some(first) = clips.iter().map(|clip| clip.first).min() {
        let count: usize = clips.iter().map(|clip| clip.count).sum();
        let limits: Vec<String> = clips
            .iter()
            .map(|clip| format!("{:.4} {}", clip.level, recording.quantity.unit()))
            .collect();
        findings.add(RECORDING_CLIPPED, pointer(recording, name, first), format!(
            "{:.1} % of the samples of the {words} are at {}, first at {:.3} s; record with a larger range",
            100.0 * count as f64 / values.len() as f64,
            limits.join(" or "),
            recording.second(first)
        ));
    }
    Levels::ClippedAt(clips.iter().map(|clip| clip.level).collect())
}

/// Counts different values, up to [`FEWEST_LEVELS`].
fn count_levels(values: &[f64]) -> usize {
    let mut levels: Vec<f64> = Vec::with_capacity(FEWEST_LEVELS);
    for value in values {
        if !levels.contains(value) {
            levels.push(*value);
            if levels.len() == FEWEST_LEVELS {
                break;
            }
        }
    }
    levels.len()
}

struct Clip {
    level: f64,
    count: usize,
    /// Separate visits to the level.
    visits: usize,
    first: usize,
}

/// Finds clipping at the highest value (`side` = 1) or at the lowest value (`side` = -1).
fn clip(values: &[f64], side: f64, magnitude: f64) -> Option<Clip> {
    let top = lanes::largest(values, |value| side * value);
    if top.abs() < REST * magnitude {
        return None;
    }
    let bottom = -lanes::largest(values, |value| -side * value);
    let below_top = |value| if side * value < top { side * value } else { f64::NEG_INFINITY };
    let second = lanes::largest(values, below_top);
    // If the steps of a converter are coarse, no value lies within this fraction. Therefore, the
    // next lower value also counts.
    let beside = second.min(top - BESIDE * (top - bottom));
    let sided = || values.iter().map(|value| side * value);
    let count = sided().filter(|value| *value == top).count();
    let near = sided().filter(|value| *value >= beside).count() - count;
    if (count as f64) < CLIPPED * values.len() as f64 || count < OVER_BESIDE * near {
        return None;
    }
    let level = side * top;
    let begins = |at: &usize| values[*at] == level && (*at == 0 || values[at - 1] != level);
    let begins: Vec<usize> = (0..values.len()).filter(begins).collect();
    Some(Clip { level, count, visits: begins.len(), first: *begins.first()? })
}
