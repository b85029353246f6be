//! Detection of single outliers.

use htex_finding::Findings;
use htex_format::Quantity;

use super::quantile::{median, quantile};
use super::{axis_words, pointer};
use crate::Recording;
use htex_recording::rules::{RECORDING_FORCE_OUTLIER, RECORDING_SPIKE};

/// Length of the blocks in which the largest second difference is searched, seconds.
const BLOCK_S: f64 = 0.1;
/// Ratio to the usual second difference above which a sample is a spike. With 100 times the usual energy, one sample
/// raises the highest bands of a segment by about 1.5 dB at 20 kHz and by 7 dB at 1 kHz.
const SPIKE: f64 = 10.0;
/// Quantile of the blocks that counts as usual: three quarters of a recording may be rest.
const USUAL: f64 = 0.75;
/// Largest part of blocks with spikes; more are the texture's own (stick and slip).
const RARE: f64 = 0.1;
/// Number of spikes that are always reported.
const FEW: usize = 3;
/// Step of a normal force, relative to its median, below which it is not a spike: quantised forces are often
/// constant except for single steps.
const FORCE_STEP: f64 = 0.05;
/// Distance in samples within which spikes count as one.
const NEIGHBOURS: usize = 2;
/// Most places in a message.
const NAMED: usize = 5;

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "- `RECORDING_SPIKE` and `RECORDING_FORCE_OUTLIER`: the *corner* of a sample is the magnitude of its difference from the mean of both neighbours. Of each \
         block of {BLOCK_S} s (at least 8 samples) the first sample of the largest corner is a spike if this exceeds {SPIKE} times the {USUAL} quantile of the blocks' \
         largest corners; for the normal force, {SPIKE} times {FORCE_STEP} of its median too. A shorter last block is searched too. Spikes of neighbouring blocks within {NEIGHBOURS} samples are one, the larger. \
         There is no finding with more spikes than {RARE} of the whole blocks, rounded down, unless they are at most {FEW}.\n"
    )
}

/// Reports spikes of an axis.
pub(super) fn judge_axis(recording: &Recording, axis: usize, findings: &mut Findings) {
    let values = &recording.axes[axis];
    let (name, words) = (recording.axis_name(axis), axis_words(recording, axis));
    let spikes = spikes(values, recording.rate_hz, 0.0);
    if let Some(first) = spikes.first() {
        let message = format!(
            "the {words} has {} far from all others: {}; leave them out, or repair them",
            count(spikes.len()),
            places(recording, recording.quantity, values, &spikes)
        );
        findings.add(RECORDING_SPIKE, pointer(recording, name, *first), message);
    }
}

/// Reports outliers of the normal force.
pub(super) fn judge_normal(recording: &Recording, findings: &mut Findings) {
    let Some(values) = &recording.normal_n else {
        return;
    };
    let usual = median(values).unwrap_or(0.0);
    let spikes = spikes(values, recording.rate_hz, FORCE_STEP * usual.abs());
    if let Some(first) = spikes.first() {
        let message = format!(
            "the normal force has {} far from all others: {}; its median is {usual:.4} N (its mean would be \
             {:.4} N), repair them or give the force",
            count(spikes.len()),
            places(recording, Quantity::NormalForce, values, &spikes),
            values.iter().sum::<f64>() / values.len() as f64
        );
        findings.add(
            RECORDING_FORCE_OUTLIER,
            pointer(recording, "normal", *first),
            message,
        );
    }
}

/// Returns the sample with the largest second difference of each block that exceeds both the usual one and a floor.
fn spikes(values: &[f64], rate_hz: f64, floor: f64) -> Vec<usize> {
    let block = ((BLOCK_S * rate_hz) as usize).max(8);
    let sharpest: Vec<(usize, f64)> = (0..values.len())
        .step_by(block)
        .filter_map(|start| sharpest(values, start, block))
        .collect();
    let usual = quantile(USUAL, sharpest.len(), |at| sharpest[at].1).unwrap_or(0.0);
    let limit = SPIKE * usual.max(floor);
    if limit == 0.0 {
        return Vec::new();
    }
    let mut found: Vec<(usize, f64)> = sharpest;
    found.retain(|(_, corner)| *corner > limit);
    // At the edge of a block, a spike's neighbour is the largest of the next block.
    found.dedup_by(|next, one| {
        let is_one = next.0 - one.0 <= NEIGHBOURS;
        if is_one && next.1 > one.1 {
            *one = *next;
        }
        is_one
    });
    let rare = FEW.max((RARE * (values.len() / block) as f64) as usize);
    if found.len() > rare {
        Vec::new()
    } else {
        found.into_iter().map(|(at, _)| at).collect()
    }
}

/// Returns the sample of a block that differs most from the mean of its neighbours, and the difference.
fn sharpest(values: &[f64], start: usize, block: usize) -> Option<(usize, f64)> {
    let from = start.saturating_sub(1);
    let reach = &values[from..(start + block + 1).min(values.len())];
    let corner = |w: &[f64]| (w[1] - 0.5 * (w[0] + w[2])).abs();
    let corners = reach.windows(3).enumerate();
    corners.map(|(at, w)| (from + at + 1, corner(w))).fold(
        None,
        |best: Option<(usize, f64)>, next| match best {
            Some(best) if best.1 >= next.1 => Some(best),
            _ => Some(next),
        },
    )
}

fn count(samples: usize) -> String {
    format!("{samples} sample{}", if samples == 1 { "" } else { "s" })
}

fn places(recording: &Recording, quantity: Quantity, values: &[f64], spikes: &[usize]) -> String {
    let unit = quantity.unit();
    let place = |at: &usize| {
        let second = recording.second(*at);
        format!("{:.4} {unit} at {second:.4} s", values[*at])
    };
    let mut named: Vec<String> = spikes.iter().take(NAMED).map(place).collect();
    if spikes.len() > NAMED {
        named.push(format!("{} more", spikes.len() - NAMED));
    }
    named.join(", ")
}
