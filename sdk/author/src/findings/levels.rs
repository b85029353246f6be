//! Samples that share their values: clipping, and converters of few steps.

use htex_format::Findings;

use super::rules::{RECORDING_CLIPPED, RECORDING_COARSE};
use super::{axis_words, pointer};
use crate::{Recording, segment_len};

/// Values of a signal below which it is its converter's steps: a texture of 4 bits has a quantisation
/// noise 26 dB below a full swing (6.02 · 4 + 1.76), hardly more than the spectrum's own scatter.
const FEWEST_LEVELS: usize = 16;
/// Part of all samples on an extreme value that counts as clipping. Noise that is cut as often, at 2.3
/// times its RMS, is distorted by -24 dB; what is cut less is not worth a recording.
const CLIPPED: f64 = 0.01;
/// The extreme value holds this many times the samples of the range next to it ([`BESIDE`]); at the top
/// of a sine in steps it holds twice as many.
const OVER_BESIDE: usize = 4;
/// Width of that range, as a part of the whole; at least one step of the converter. A texture on a plateau is
/// a few percent of the whole, and dense: it must not be taken for one value.
const BESIDE: f64 = 0.001;
/// A clipping signal comes back to its limit; one that came once or twice has stuck there.
const FEWEST_VISITS: usize = 3;
/// A limit lies this far from zero, as a part of the mean magnitude: nearer to it lies rest.
const REST: f64 = 0.5;

/// What the values of an axis are like.
pub(super) enum Levels {
    /// Too few to judge anything else by.
    Coarse,
    /// Many; these are the ones that the axis is clipped at.
    ClippedAt(Vec<f64>),
}

/// Finds coarse steps and clipping; what is shorter than a segment is not judged.
pub(super) fn judge(recording: &Recording, axis: usize, findings: &mut Findings) -> Levels {
    let values = &recording.axes[axis];
    let (name, words) = (recording.axis_name(axis), axis_words(recording, axis));
    if values.len() < segment_len(recording.rate_hz) {
        return Levels::ClippedAt(Vec::new());
    }
    match count_levels(values) {
        1 => return Levels::ClippedAt(Vec::new()),
        FEWEST_LEVELS => {}
        levels => {
            findings.add(RECORDING_COARSE, format!("/{name}"), format!(
                "the {words} takes {levels} different values in {} samples; raise the gain or write more digits",
                values.len()
            ));
            return Levels::Coarse;
        }
    }
    let mut clips: Vec<Clip> = [1.0, -1.0]
        .into_iter()
        .filter_map(|side| clip(values, side))
        .collect();
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
            "{:.1} % of the samples of the {words} lie on {}, first at {:.3} s; record with a larger range",
            100.0 * count as f64 / values.len() as f64,
            limits.join(" or "),
            recording.second(first)
        ));
    }
    Levels::ClippedAt(clips.iter().map(|clip| clip.level).collect())
}

/// How many different values there are, as far as [`FEWEST_LEVELS`].
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
    /// Stretches on the level.
    visits: usize,
    first: usize,
}

/// What looks like clipping at the highest value (`side` 1) or the lowest (-1).
fn clip(values: &[f64], side: f64) -> Option<Clip> {
    let (mut top, mut second, mut bottom) = (f64::NEG_INFINITY, f64::NEG_INFINITY, f64::INFINITY);
    let mut magnitude = 0.0;
    for value in values.iter().map(|value| side * value) {
        magnitude += value.abs();
        bottom = bottom.min(value);
        if value > top {
            (top, second) = (value, top);
        } else if value < top {
            second = second.max(value);
        }
    }
    if top.abs() < REST * magnitude / values.len() as f64 {
        return None;
    }
    let beside = second.min(top - BESIDE * (top - bottom));
    let (mut count, mut near, mut visits, mut first, mut before) = (0, 0, 0, None, false);
    for (at, value) in values.iter().map(|value| side * value).enumerate() {
        let on = value == top;
        if on {
            count += 1;
            visits += usize::from(!before);
            first = first.or(Some(at));
        } else if value >= beside {
            near += 1;
        }
        before = on;
    }
    let clipped = count as f64 >= CLIPPED * values.len() as f64 && count >= OVER_BESIDE * near;
    clipped.then_some(Clip {
        level: side * top,
        count,
        visits,
        first: first?,
    })
}
