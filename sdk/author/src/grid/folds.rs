//! Blocks of time that are left out in turn: each quarter of the recordings is predicted from the
//! other three.
//!
//! Neighbouring cells share windows, and windows overlap, so a condition that is predicted from its
//! neighbours is predicted from samples that it is compared with. Blocks of time share none. They
//! are long, because a finger and its motion drift: what was felt a second before and after tells
//! more of a block than a recording tells of what will be played.

use std::ops::Range;

use super::paths::{MOST, Window};
use crate::Take;

/// Number of blocks of each recording.
pub(super) const FOLDS: usize = 4;

/// Windows by what they are in one prediction: indices in ascending order.
#[derive(Debug)]
pub(super) struct Fold {
    /// Windows that share no sample with the block that is left out.
    pub(super) known: Vec<usize>,
    /// Windows inside that block.
    pub(super) held: Vec<usize>,
}

/// Leaves out the quarters of all recordings in turn. A window that reaches over the edge of a
/// block, as far as it may be lengthened ([`super::paths`]), is on neither side of it.
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

/// Returns the samples that may be read of a window.
fn reach(window: &Window) -> Range<usize> {
    let middle = window.start + window.len / 2;
    let half = (0.5 * MOST * window.len as f64) as usize + 1;
    middle.saturating_sub(half)..middle + half
}
