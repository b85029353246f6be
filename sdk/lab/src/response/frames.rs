//! Cuts recordings of hits, or of a continuous drive, into windows, and weights the samples of each
//! window.

use std::f64::consts::PI;

use super::overload::Overloads;
use super::pieces::{Cut, Piece, Reason};
use super::record::Channel;
use super::record::Record;
use super::settings::{HitSettings, ResponseSettings};

/// A window counts as silent if the RMS of its drive, relative to the strongest window, is below
/// this value.
const SILENT: f64 = 0.1;

/// Cuts a continuous drive into windows of `len` samples with half overlap.
pub(crate) fn windows(record: &Record, len: usize, settings: &ResponseSettings) -> Vec<Cut> {
    let input = record.channel(Channel::Input);
    let overloads = [
        // A square wave repeats its extreme values. Therefore, the input counts as overloaded only
        // at a limit that the user gave.
        Overloads::find_given(record, Channel::Input, settings.input_limit),
        Overloads::find(record, Channel::Output, settings.output_limit),
    ];
    // The first start at which a window no longer fits. The range excludes it, so a record with the
    // length of one window gives one window.
    let last = (input.len() + 1).saturating_sub(len);
    let starts = || (0..last).step_by((len / 2).max(1));
    let rms: Vec<f64> = starts().map(|start| spread(&input[start..start + len])).collect();
    let strongest = rms.iter().copied().fold(0.0, f64::max);
    let cut = |(start, rms): (usize, f64)| {
        let samples = start..start + len;
        let overload = overloads.iter().find_map(|all| all.within(record, &samples));
        let silent = (rms < SILENT * strongest).then_some(Reason::Silent);
        let piece = Piece {
            file: record.file().to_owned(),
            time_s: record.second(start),
            peak: farthest(&input[samples.clone()]),
            thrown_out: overload.or(silent),
        };
        Cut { samples, trigger: start, piece }
    };
    starts().zip(rms).map(cut).collect()
}

/// Returns the standard deviation.
pub(crate) fn spread(values: &[f64]) -> f64 {
    let mean = mean(values);
    let squares: f64 = values.iter().map(|value| (value - mean) * (value - mean)).sum();
    (squares / values.len().max(1) as f64).sqrt()
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len().max(1) as f64
}

/// Returns the largest deviation from the mean, with its sign.
pub(crate) fn farthest(values: &[f64]) -> f64 {
    let mean = mean(values);
    let farther = |most: f64, value: &f64| {
        if (value - mean).abs() > most.abs() { value - mean } else { most }
    };
    values.iter().fold(0.0, farther)
}

/// Weights for the samples of a window, for each channel.
pub(crate) struct Weights {
    pub(crate) input: Vec<f64>,
    pub(crate) output: Vec<f64>,
    /// Number of samples at the start whose mean is removed.
    pub(crate) rest: usize,
}

impl Weights {
    /// Weights for a continuous drive: a periodic Hann window. The mean of the whole window is
    /// removed.
    pub(crate) fn hann(len: usize) -> Self {
        let hann = htex_dsp::window::hann_periodic(len);
        Self { input: hann.clone(), output: hann, rest: len }
    }

    /// Weights for hits: a force window and an exponential window. The mean before the trigger is
    /// removed.
    pub(crate) fn for_hits(len: usize, rate_hz: f64, hit: &HitSettings) -> Self {
        let before = (hit.pre_trigger_s * rate_hz).round() as usize;
        let after_s = |at: usize| at.saturating_sub(before) as f64 / rate_hz;
        let exponential =
            |at| hit.exponential_s.map_or(1.0, |tau_s| libm::exp(-after_s(at) / tau_s));
        let force = |at| hit.force_window_s.map_or(1.0, |end_s| force(after_s(at), end_s));
        let output: Vec<f64> = (0..len).map(exponential).collect();
        let input = output.iter().enumerate().map(|(at, weight)| weight * force(at)).collect();
        Self { input, output, rest: before }
    }

    /// Returns the samples of a window, weighted and divided by `scale`.
    pub(crate) fn apply(
        &self,
        record: &Record,
        channel: Channel,
        cut: &Cut,
        scale: f64,
    ) -> Vec<f64> {
        let values = &record.channel(channel)[cut.samples.clone()];
        let weights = match channel {
            Channel::Input => &self.input,
            Channel::Output => &self.output,
        };
        // If there are no samples before the trigger, the first sample is used, which is nearly at
        // rest.
        let rest = mean(&values[..self.rest.clamp(1, values.len())]);
        let weighted = values.iter().zip(weights);
        weighted.map(|(value, weight)| weight * (value - rest) / scale).collect()
    }
}

/// Returns the weight of the force window at a time after the trigger. It is 1 up to `end_s`, and
/// then falls to 0 over a quarter of this time, as half a cosine.
fn force(after_s: f64, end_s: f64) -> f64 {
    let faded = ((after_s - end_s) / (0.25 * end_s)).clamp(0.0, 1.0);
    0.5 + 0.5 * libm::cos(PI * faded)
}
