//! Finds the hits of an impact hammer in the input of a record.

use std::ops::Range;

use super::overload::{Baseline, Overloads};
use super::pieces::{Cut, Piece, Reason};
use super::record::{Channel, Record};
use super::settings::{HitSettings, ResponseSettings};

/// Hits and second contacts must exceed the noise by at least this factor. At a sample rate of 1
/// GHz, normally distributed noise exceeds its RMS by this factor less than once a day.
pub(crate) const ABOVE_NOISE: f64 = 8.0;

/// Finds the hits of a record, with windows of `len` samples. Finds none if the largest input is
/// within the noise.
///
/// A hit begins where the input first reaches the trigger level. The search for the next hit
/// continues after its window.
pub(crate) fn hits(
    record: &Record,
    len: usize,
    hit: &HitSettings,
    settings: &ResponseSettings,
) -> Vec<Cut> {
    let input = record.channel(Channel::Input);
    let rest = Baseline::find(input);
    let least = ABOVE_NOISE * rest.noise;
    let level = (hit.trigger * rest.largest).max(least);
    let before = (hit.pre_trigger_s * record.rate_hz()).round() as usize;
    let overloads = [
        Overloads::find(record, Channel::Input, settings.input_limit),
        Overloads::find(record, Channel::Output, settings.output_limit),
    ];
    let mut found = Vec::new();
    let mut from = 0;
    while let Some(after) = trigger(&input[from..], rest.level, level) {
        let trigger = from + after;
        // A hit at the very start has too few samples before its trigger, but its window still has
        // the usual length.
        let start = trigger.saturating_sub(before);
        let samples = start..start + len;
        let inside = start..samples.end.min(input.len());
        let peak = peak(&input[inside.clone()], rest.level);
        let window = Window { record, trigger, before, samples: &samples, inside: &inside };
        let rise = (hit.double * peak.abs()).max(least);
        let thrown_out = window
            .cut_off()
            .or_else(|| overloads.iter().find_map(|all| all.within(record, &inside)))
            .or_else(|| window.double(rest.level, peak, rise));
        // The search advances by at least one sample, so that it ends.
        from = inside.end.max(trigger + 1);
        let (file, time_s) = (record.file().to_owned(), record.second(trigger));
        let piece = Piece { file, time_s, peak, thrown_out };
        found.push(Cut { samples, trigger, piece });
    }
    found
}

/// Returns the first sample that is at least `level` away from rest.
fn trigger(input: &[f64], rest: f64, level: f64) -> Option<usize> {
    input.iter().position(|value| (value - rest).abs() >= level && *value != rest)
}

/// Returns the largest deviation from rest, with its sign.
fn peak(input: &[f64], rest: f64) -> f64 {
    let farther = |peak: f64, value: &f64| {
        if (value - rest).abs() > peak.abs() { value - rest } else { peak }
    };
    input.iter().fold(0.0, farther)
}

/// The window of a hit.
struct Window<'a> {
    record: &'a Record,
    trigger: usize,
    /// Number of samples that the window should have before the trigger.
    before: usize,
    samples: &'a Range<usize>,
    /// The part of `samples` that lies inside the record.
    inside: &'a Range<usize>,
}

impl Window<'_> {
    fn cut_off(&self) -> Option<Reason> {
        if self.trigger < self.before {
            return Some(Reason::StartsLate);
        }
        let missing = self.samples.end - self.inside.end;
        let missing_s = missing as f64 / self.record.rate_hz();
        (missing > 0).then_some(Reason::EndsEarly { missing_s })
    }

    fn double(&self, rest: f64, peak: f64, rise: f64) -> Option<Reason> {
        let input = &self.record.channel(Channel::Input)[self.inside.clone()];
        let pulse = input.iter().map(|value| peak.signum() * (value - rest));
        let second = *contacts(pulse, rise).get(1)?;
        let second_s = self.record.second(self.inside.start + second);
        Some(Reason::DoubleHit { second_s })
    }
}

/// Returns the indices of the samples at which contacts begin. A contact begins when the signal has
/// risen by at least `rise` above its lowest value since the last contact, and is also at least
/// `rise` above rest. Between the last contact and a new one, the signal must have fallen by at
/// least `rise`. `pulse` is the signal relative to its level at rest, with the hit in the positive
/// direction.
pub(crate) fn contacts(pulse: impl Iterator<Item = f64>, rise: f64) -> Vec<usize> {
    let mut found = Vec::new();
    let (mut lowest, mut highest, mut is_in_contact) = (0.0_f64, 0.0_f64, false);
    for (at, value) in pulse.enumerate() {
        if is_in_contact {
            highest = highest.max(value);
            if value <= highest - rise {
                (is_in_contact, lowest) = (false, value);
            }
        } else {
            lowest = lowest.min(value);
            if value >= (lowest + rise).max(rise) {
                (is_in_contact, highest) = (true, value);
                found.push(at);
            }
        }
    }
    found
}
