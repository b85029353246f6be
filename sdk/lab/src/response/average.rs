//! Cuts records into hits or windows, counts the usable ones and averages them.

use super::baseline::Baseline;
use super::error::{Channel, RecordProblem, ResponseError};
use super::frames::{Weights, farthest, spread, windows};
use super::hits::hits;
use super::options::{Excitation, ResponseOptions};
use super::pieces::{Cut, Piece};
use super::record::Record;
use super::spectra::Spectra;

/// The final part of a window, relative to its length, that must be quiet.
const END: f64 = 0.05;
/// Limits for a quiet end (RMS): relative to the largest output, and relative to the noise before
/// the trigger.
const QUIET: f64 = 0.01;
const OVER_NOISE: f64 = 3.0;

/// Returns whether a hit's windowed output has not died out at the end of its window. Its end must
/// exceed both 1 % of its largest value and three times the noise of the `before` samples before
/// the trigger (RMS).
fn outlasts(output: &[f64], before: usize) -> bool {
    let end = ((END * output.len() as f64) as usize).max(1);
    let tail = spread(&output[output.len() - end.min(output.len())..]);
    let noise = spread(&output[..before.min(output.len())]);
    tail > QUIET * farthest(output).abs() && tail > OVER_NOISE * noise
}

/// Cuts a record into hits or windows of `len` samples.
pub(crate) fn cut(
    record: &Record,
    len: usize,
    options: &ResponseOptions,
) -> Result<Vec<Cut>, ResponseError> {
    if record.samples() < len {
        return Err(ResponseError::Short {
            file: record.file().to_owned(),
            duration_s: record.samples() as f64 / record.rate_hz(),
            window_s: options.window_s,
        });
    }
    Ok(match &options.excitation {
        Excitation::Hits(hit) => hits(record, len, hit, options),
        Excitation::Continuous => windows(record, len, options),
    })
}

/// Counts the usable hits or windows. Refuses fewer than two.
pub(crate) fn count_used(
    records: &[Record],
    cuts: &[Vec<Cut>],
    options: &ResponseOptions,
) -> Result<usize, ResponseError> {
    let pieces = || cuts.iter().flatten().map(|cut| &cut.piece);
    let (found, is_hits) = (pieces().count(), matches!(options.excitation, Excitation::Hits(_)));
    if let (0, Some(first)) = (found, records.first()) {
        let rest = Baseline::of(first.channel(Channel::Input));
        let (largest, noise) = (rest.largest, rest.noise);
        return Err(RecordProblem::NoHits { largest, noise }.of(first.file()));
    }
    match pieces().filter(|piece| piece.thrown_out.is_none()).count() {
        used if used >= 2 => Ok(used),
        used => Err(ResponseError::TooFew {
            what: if is_hits { "hits" } else { "windows" },
            found,
            used,
            reasons: pieces().filter_map(Piece::place_and_reason).collect(),
        }),
    }
}

/// Averages the usable hits or windows. Also returns how many hits have a response that outlasts
/// the window.
pub(crate) fn average(
    records: &[Record],
    cuts: &[Vec<Cut>],
    len: usize,
    options: &ResponseOptions,
) -> (Spectra, usize) {
    let [x, y] = [Channel::Input, Channel::Output].map(|channel| scale_of(records, channel));
    let mut spectra = Spectra::new(len);
    let mut outlasting = 0;
    for (record, cuts) in records.iter().zip(cuts) {
        let weights = match &options.excitation {
            Excitation::Hits(hit) => Weights::of_hits(len, record.rate_hz(), hit),
            Excitation::Continuous => Weights::hann(len),
        };
        for cut in cuts.iter().filter(|cut| cut.piece.thrown_out.is_none()) {
            let input = weights.apply(record, Channel::Input, cut, x);
            let output = weights.apply(record, Channel::Output, cut, y);
            spectra.add(&input, &output);
            let before = cut.trigger - cut.samples.start;
            outlasting += usize::from(outlasts(&output, before));
        }
    }
    (spectra, outlasting)
}

/// Returns the largest distance from rest. The channel is divided by it so that no power overflows
/// or underflows.
pub(crate) fn scale_of(records: &[Record], channel: Channel) -> f64 {
    let largest = records.iter().map(|record| Baseline::of(record.channel(channel)).largest);
    largest.fold(0.0, f64::max)
}
