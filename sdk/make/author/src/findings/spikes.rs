//! Detection of outliers: a few large outliers of any shape, or many outliers of one sample each.
//!
//! A corner is the difference between a sample and the mean of its two neighbours. A texture itself
//! has sharp corners (stick and slip), so a large number of corners does not prove that there are
//! outliers. To repair a sample means to replace it by a value interpolated from its neighbours. A
//! corner of a texture lasts several samples, so it remains if only one sample is repaired. The
//! corner of a single-sample outlier disappears when the outlier is repaired. In each of 240
//! third-party recordings, such repairs remove at most four of the corners that have 12 times the
//! usual size. Corners of five times the usual size disappear at no more than 0.1 % of a
//! recording's samples. The exception is a recording of a motor's current, with 0.62 %.

use std::ops::Range;

use htex_base::finding::Findings;
use htex_format::Quantity;

use super::quantile::{median, quantile};
use super::{axis_words, lanes, pointer};
use crate::Recording;
use htex_recording::rules::{RECORDING_FORCE_OUTLIER, RECORDING_SPIKE};

/// Length of the blocks in which the largest second difference is found, seconds.
const BLOCK_S: f64 = 0.1;
/// A sample is a spike if its second difference exceeds the usual one by this factor. Such a sample
/// has 100 times the usual energy. It raises the highest bands of a segment by about 1.5 dB at a
/// sample rate of 20 kHz, and by 7 dB at 1 kHz.
const SPIKE: f64 = 10.0;
/// The usual second difference is this quantile over the blocks. It is high because the finger may
/// rest for three quarters of a recording.
const USUAL: f64 = 0.75;
/// Largest fraction of blocks with spikes. If more blocks have spikes, the spikes belong to the
/// texture (stick and slip).
const RARE: f64 = 0.1;
/// This many spikes or fewer are always reported.
const FEW: usize = 3;
/// A step of the normal force smaller than this, relative to its median, is not a spike: quantised
/// forces are often constant except for single steps.
const FORCE_STEP: f64 = 0.05;
/// Spikes within this many samples of each other count as one.
const NEIGHBOURS: usize = 2;
/// A sample is a single-sample outlier if its corner is at least this many times the corners that
/// remain after the sample is repaired.
const REPAIRED: f64 = 2.0;
/// Ratio of the standard deviation of normally distributed numbers to the median of their
/// magnitudes.
const NORMAL: f64 = 1.4826;
/// Two limits for small single-sample outliers. A corner counts from this number of standard
/// deviations on. There are too many outliers if at least this fraction of all samples are
/// outliers. An outlier of six standard deviations of white noise makes a corner of five standard
/// deviations. If 0.75 % of the samples are such outliers, they raise the noise's level by 1 dB.
const SMALL: (f64, f64) = (5.0, 0.0075);
/// Large single-sample outliers: the same two limits as in [`SMALL`], but with a number of samples
/// instead of a fraction.
const LARGE: (f64, usize) = (12.0, 6);
/// Largest number of places named in a message.
const NAMED: usize = 5;

/// Defines the findings of this module, for `spec/recording-findings.md`.
pub(super) fn definition() -> String {
    format!(
        "- `RECORDING_SPIKE` and `RECORDING_FORCE_OUTLIER`: the *corner* of a sample is the magnitude of its difference from the mean of both neighbours. Of each \
         block of {BLOCK_S} s (at least 8 samples) the first sample of the largest corner is a spike if this exceeds {SPIKE} times the {USUAL} quantile of the blocks' \
         largest corners; for the normal force, {SPIKE} times {FORCE_STEP} of its median too. A shorter last block is searched too. Spikes of neighbouring blocks within {NEIGHBOURS} samples are one, the larger. \
         With more spikes than {RARE} of the whole blocks, rounded down, these count only if they are at most {FEW}.\n  \
         Many spikes are found one by one. The *usual* corner is {NORMAL} times the {USUAL} quantile of the medians of blocks as long of corners, from the second sample's on; a shorter last block is left out. A sample with three samples on either side, whose corner is not below the one before it and above the one after it, is *single* if its corner is more than {REPAIRED} times all corners of itself and \
         two samples on either side after it is replaced by `(4 (a + b) - (c + d)) / 6`, with *a* and *b* its neighbours and *c* and *d* the next ones. Single samples are spikes if at least {} of them have corners above {} times the usual one, or at least {} of all samples have corners above {} times the usual one; for the normal force their corners also exceed {SPIKE} times \
         {FORCE_STEP} of its median. The finding has the single samples of the second kind if there are enough, else of the first, where they are more than the spikes above.\n",
        LARGE.1, LARGE.0, SMALL.1, SMALL.0
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
        findings.add(RECORDING_FORCE_OUTLIER, pointer(recording, "normal", *first), message);
    }
}

/// Returns the spikes. A block's sample with the largest second difference is a spike if this
/// difference exceeds ten times both the usual one and a floor. If there are more single-sample
/// outliers than such spikes, the function returns the outliers instead.
fn spikes(values: &[f64], rate_hz: f64, floor: f64) -> Vec<usize> {
    // At low rates, a block would have too few samples, and its largest corner would not be
    // meaningful.
    let block = ((BLOCK_S * rate_hz) as usize).max(8);
    let blocks = Blocks::new(values, block);
    let usual = quantile(USUAL, blocks.largest.len(), |at| blocks.largest[at].corner);
    let limit = SPIKE * usual.unwrap_or(0.0).max(floor);
    let is_spike = |largest: &&Largest| limit > 0.0 && largest.corner > limit;
    let sample = |largest: &Largest| {
        let at = largest.samples.clone().find(|at| corner_at(values, *at) == largest.corner);
        (at.unwrap_or(largest.samples.start), largest.corner)
    };
    let mut found: Vec<_> = blocks.largest.iter().filter(is_spike).map(sample).collect();
    // If a spike is at the edge of a block, the sample with the largest corner in the next block
    // may be a neighbour of the same spike.
    found.dedup_by(|next, one| {
        let is_one = next.0 - one.0 <= NEIGHBOURS;
        if is_one && next.1 > one.1 {
            *one = *next;
        }
        is_one
    });
    let rare = FEW.max((RARE * (values.len() / block) as f64) as usize);
    if found.len() > rare {
        found.clear();
    }
    let many = many(values, &blocks, SPIKE * floor);
    if many.len() > found.len() { many } else { found.into_iter().map(|(at, _)| at).collect() }
}

/// The corners of a signal, block by block.
struct Blocks {
    largest: Vec<Largest>,
    /// Medians of the corners in whole blocks. Each of these blocks begins one sample later than
    /// the block in `largest`.
    medians: Vec<f64>,
}

/// The largest corner in a block.
struct Largest {
    /// The samples of the block that have two neighbours.
    samples: Range<usize>,
    corner: f64,
}

impl Blocks {
    fn new(values: &[f64], block: usize) -> Self {
        let last = values.len().saturating_sub(1);
        let (mut largest, mut medians) = (Vec::new(), Vec::new());
        let mut corners = Vec::with_capacity(block + 1);
        for start in (0..values.len()).step_by(block) {
            let samples = start.max(1)..(start + block).min(last);
            if samples.is_empty() {
                continue;
            }
            let reach = &values[samples.start - 1..(start + block + 2).min(values.len())];
            corners.clear();
            corners.extend(reach.windows(3).map(corner));
            let corner = lanes::largest(&corners[..samples.len()], |x| x);
            if start + block < last {
                medians.extend(median(&corners[corners.len() - block..]));
            }
            largest.push(Largest { samples, corner });
        }
        Self { largest, medians }
    }
}

/// Returns the single-sample outliers, if there are too many of them.
fn many(values: &[f64], blocks: &Blocks, floor: f64) -> Vec<usize> {
    let medians = &blocks.medians;
    let usual = NORMAL * quantile(USUAL, medians.len(), |at| medians[at]).unwrap_or(0.0);
    if usual == 0.0 {
        return Vec::new();
    }
    let [small, large] = [SMALL.0, LARGE.0].map(|ratio| floor.max(ratio * usual));
    let inner = 3..values.len().saturating_sub(3);
    let blocks = blocks.largest.iter().filter(|block| block.corner > small);
    let mut single: Vec<usize> = blocks
        .flat_map(|block| block.samples.clone())
        .filter(|at| corner_at(values, *at) > small && inner.contains(at))
        .filter(|at| is_single(values, *at))
        .collect();
    if (single.len() as f64) < SMALL.1 * values.len() as f64 {
        single.retain(|at| corner_at(values, *at) > large);
        if single.len() < LARGE.1 {
            single.clear();
        }
    }
    single
}

/// Whether repairing the sample removes its corner. The sample must have at least three samples on
/// either side.
fn is_single(values: &[f64], at: usize) -> bool {
    let own = corner_at(values, at);
    // If neighbouring corners are equal, only the last one counts.
    if own < corner_at(values, at - 1) || own <= corner_at(values, at + 1) {
        return false;
    }
    let mut around: [f64; 7] = core::array::from_fn(|i| values[at + i - 3]);
    // Replaces the sample by the value of the cubic polynomial through the two nearest samples on
    // either side.
    around[3] = (4.0 * (around[2] + around[4]) - (around[1] + around[5])) / 6.0;
    around.windows(3).all(|w| REPAIRED * corner(w) < own)
}

fn corner_at(values: &[f64], at: usize) -> f64 {
    corner(&values[at - 1..=at + 1])
}

/// Absolute difference between a sample and the mean of its neighbours.
fn corner(w: &[f64]) -> f64 {
    (w[1] - 0.5 * (w[0] + w[2])).abs()
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
