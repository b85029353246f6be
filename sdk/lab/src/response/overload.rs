//! Finds three properties of a signal: its level at rest, its noise, and the samples that are at
//! the limit of a sensor, amplifier or converter.

use std::ops::Range;

use super::pieces::Reason;
use super::record::{Channel, Record};

/// If this many equal samples follow each other at a channel's highest or lowest value, the channel
/// counts as clipped. The top of a pulse may have two or three equal samples without clipping.
const IN_A_ROW: usize = 4;
/// Fraction of the largest deviation that a clipped value must reach. Without this limit, a signal
/// at rest would count as clipped, because it repeats its lowest value.
const AWAY: f64 = 0.5;
/// A sample counts as being at a given limit if it reaches this fraction of the limit.
const AT_LIMIT: f64 = 0.999;

/// The stretches in which a channel is at its limit, in the order of time.
#[derive(Debug)]
pub(crate) struct Overloads {
    channel: Channel,
    stretches: Vec<Range<usize>>,
}

impl Overloads {
    /// Finds samples at or beyond a given limit. Without a limit, finds four or more equal samples
    /// in a row at the highest or lowest value.
    pub(crate) fn find(record: &Record, channel: Channel, limit: Option<f64>) -> Self {
        let values = record.channel(channel);
        let stretches = match limit {
            Some(limit) => runs(values, 1, |value| value.abs() >= AT_LIMIT * limit),
            None => repeated(values),
        };
        Self { channel, stretches }
    }

    /// Finds only samples at or beyond a given limit.
    pub(crate) fn find_given(record: &Record, channel: Channel, limit: Option<f64>) -> Self {
        match limit {
            Some(_) => Self::find(record, channel, limit),
            None => Self { channel, stretches: Vec::new() },
        }
    }

    /// Returns the first overload within a part of the record.
    pub(crate) fn within(&self, record: &Record, part: &Range<usize>) -> Option<Reason> {
        let next = self.stretches.partition_point(|stretch| stretch.end <= part.start);
        let stretch = self.stretches.get(next).filter(|stretch| stretch.start < part.end)?;
        let at = stretch.start.max(part.start);
        Some(Reason::Overload {
            channel: self.channel,
            at_s: record.second(at),
            value: record.channel(self.channel)[at],
        })
    }
}

fn repeated(values: &[f64]) -> Vec<Range<usize>> {
    let baseline = Baseline::find(values);
    let high = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let low = values.iter().copied().fold(f64::INFINITY, f64::min);
    let is_away = |value: f64| (value - baseline.level).abs() >= AWAY * baseline.largest;
    let runs_at = |extreme: f64| {
        if is_away(extreme) { runs(values, IN_A_ROW, |value| value == extreme) } else { Vec::new() }
    };
    let mut stretches = runs_at(high);
    stretches.extend(runs_at(low));
    stretches.sort_unstable_by_key(|stretch| stretch.start);
    stretches
}

/// Returns the stretches of at least `fewest` samples for which `is_so` holds.
fn runs(values: &[f64], fewest: usize, is_so: impl Fn(f64) -> bool) -> Vec<Range<usize>> {
    let mut found = Vec::new();
    let mut start = None;
    // The added element ends a run that lasts until the last sample.
    for (at, value) in values.iter().map(|value| Some(*value)).chain([None]).enumerate() {
        match (start, value.is_some_and(&is_so)) {
            (None, true) => start = Some(at),
            (Some(from), false) => {
                if at - from >= fewest {
                    found.push(from..at);
                }
                start = None;
            }
            _ => {}
        }
    }
    found
}

/// Ratio of the standard deviation of normal noise to its median absolute deviation.
const NORMAL: f64 = 1.482_602_218_505_602;

/// A signal's level at rest and its noise.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Baseline {
    /// Level at rest: the median.
    pub(crate) level: f64,
    /// RMS of the noise, from the median absolute deviation. Hits do not influence this value if
    /// they fill less than half of the recording.
    pub(crate) noise: f64,
    /// Largest distance from the level.
    pub(crate) largest: f64,
}

impl Baseline {
    /// Finds the baseline of a signal. Without samples, all values are zero.
    pub(crate) fn find(values: &[f64]) -> Self {
        let level = median(values.to_vec());
        let deviations: Vec<f64> = values.iter().map(|value| (value - level).abs()).collect();
        let largest = deviations.iter().copied().fold(0.0, f64::max);
        let noise = NORMAL * median(deviations);
        Self { level, noise, largest }
    }
}

/// The upper median.
fn median(mut values: Vec<f64>) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = values.len() / 2;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}
