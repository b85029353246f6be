//! Cross-validation over time: each quarter of the recordings is left out in turn and predicted
//! from the other three quarters.
//!
//! Neighbouring cells share windows, and windows overlap. If a condition were predicted from
//! neighbouring cells, the prediction would use some of the samples with which it is then compared.
//! The quarters are blocks of time, which share no samples. The blocks are long because a finger
//! and its motion drift. A short block would be predicted too well by samples that were recorded
//! within a second of it. The error would then be smaller than the error of a later playback.

use std::ops::Range;

use super::paths::{MOST, Window};
use crate::Take;

/// Number of blocks in each recording.
pub(super) const FOLDS: usize = 4;

/// The role of each window in one prediction; indices in ascending order.
#[derive(Debug)]
pub(super) struct Fold {
    /// Windows that share no sample with the left-out block.
    pub(super) known: Vec<usize>,
    /// Windows inside the left-out block.
    pub(super) held: Vec<usize>,
}

/// Leaves out each quarter of all recordings in turn. A window may be lengthened
/// ([`super::paths`]). If its longest form crosses the edge of a block, the window is neither
/// inside nor outside this block.
pub(super) fn folds(takes: &[Take], windows: &[Window]) -> [Fold; FOLDS] {
    std::array::from_fn(|block| {
        let of = |window: &Window| {
            let samples = takes[window.take].recording.samples();
            let left_out = samples * block / FOLDS..samples * (block + 1) / FOLDS;
            (reach(window), left_out)
        };
        let all = || windows.iter().map(of).enumerate();
        let is_known = |(reach, out): &(Range<usize>, Range<usize>)| {
            reach.end <= out.start || reach.start >= out.end
        };
        let is_held = |(reach, out): &(Range<usize>, Range<usize>)| {
            reach.start >= out.start && reach.end <= out.end
        };
        Fold {
            known: all().filter(|(_, of)| is_known(of)).map(|(i, _)| i).collect(),
            held: all().filter(|(_, of)| is_held(of)).map(|(i, _)| i).collect(),
        }
    })
}

/// Returns all samples that may be read for a window.
fn reach(window: &Window) -> Range<usize> {
    let middle = window.start + window.len / 2;
    let half = (0.5 * MOST * window.len as f64) as usize + 1;
    middle.saturating_sub(half)..middle + half
}
