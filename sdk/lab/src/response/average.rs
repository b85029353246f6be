//! Cuts records into hits or windows, counts the usable hits or windows, and averages their
//! spectra.

use htex_dsp::fft::RealFft;
use num_complex::Complex;

use super::frames::{Weights, farthest, spread, windows};
use super::hits::hits;
use super::overload::Baseline;
use super::pieces::{Cut, Piece};
use super::record::{Channel, Record};
use super::settings::ResponseSettings;
use crate::error::LabError;

/// The last part of a window must be quiet. This is the length of this part, relative to the
/// window.
const END: f64 = 0.05;
/// Limits for the RMS of a quiet end: the first is relative to the largest output, and the second
/// is relative to the noise before the trigger.
const QUIET: f64 = 0.01;
const OVER_NOISE: f64 = 3.0;

/// Returns whether a hit's windowed output has not died out at the end of its window. This is the
/// case if the RMS of the end exceeds 1 % of the largest value, and also three times the RMS of the
/// noise in the `before` samples before the trigger.
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
    settings: &ResponseSettings,
) -> Result<Vec<Cut>, LabError> {
    if record.samples() < len {
        return Err(LabError::Short {
            file: record.file().to_owned(),
            duration_s: record.samples() as f64 / record.rate_hz(),
            window_s: settings.window_s,
        });
    }
    Ok(match settings.hits() {
        Some(hit) => hits(record, len, &hit, settings),
        None => windows(record, len, settings),
    })
}

/// Counts the usable hits or windows. Returns an error if there are fewer than two.
pub(crate) fn count_used(
    records: &[Record],
    cuts: &[Vec<Cut>],
    settings: &ResponseSettings,
) -> Result<usize, LabError> {
    let pieces = || cuts.iter().flatten().map(|cut| &cut.piece);
    let (found, is_hits) = (pieces().count(), !settings.continuous);
    if let (0, Some(first)) = (found, records.first()) {
        let rest = Baseline::find(first.channel(Channel::Input));
        let (largest, noise) = (rest.largest, rest.noise);
        return Err(LabError::NoHits { file: first.file().to_owned(), largest, noise });
    }
    match pieces().filter(|piece| piece.thrown_out.is_none()).count() {
        used if used >= 2 => Ok(used),
        used => Err(LabError::TooFew {
            what: if is_hits { "hits" } else { "windows" },
            found,
            used,
            reasons: pieces().filter_map(Piece::place_and_reason).collect(),
        }),
    }
}

/// Averages the usable hits or windows. Also returns the number of hits whose response outlasts the
/// window.
pub(crate) fn average(
    records: &[Record],
    cuts: &[Vec<Cut>],
    len: usize,
    settings: &ResponseSettings,
) -> (Spectra, usize) {
    let [x, y] = [Channel::Input, Channel::Output].map(|channel| scale_of(records, channel));
    let mut spectra = Spectra::new(len);
    let mut outlasting = 0;
    for (record, cuts) in records.iter().zip(cuts) {
        let weights = match settings.hits() {
            Some(hit) => Weights::for_hits(len, record.rate_hz(), &hit),
            None => Weights::hann(len),
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

/// Returns the largest deviation of a channel from rest, over all records. The channel is divided
/// by this number, so that no power overflows or underflows.
pub(crate) fn scale_of(records: &[Record], channel: Channel) -> f64 {
    let largest = records.iter().map(|record| Baseline::find(record.channel(channel)).largest);
    largest.fold(0.0, f64::max)
}

/// Averaged auto spectra and cross spectrum of input and output at each bin (Bendat & Piersol,
/// section 11.5). All spectra lack the same factor, because only their ratios are used.
#[derive(Debug)]
pub(crate) struct Spectra {
    fft: RealFft,
    bins: [Vec<Complex<f64>>; 2],
    /// Auto spectrum of the input.
    pub(crate) gxx: Vec<f64>,
    /// Auto spectrum of the output.
    pub(crate) gyy: Vec<f64>,
    /// Cross spectrum: the conjugate of the input times the output, averaged.
    pub(crate) gxy: Vec<Complex<f64>>,
}

impl Spectra {
    /// Creates empty sums for windows of `len` samples.
    pub(crate) fn new(len: usize) -> Self {
        let fft = RealFft::new(len);
        let bins = [fft.make_bins(), fft.make_bins()];
        let count = bins[0].len();
        Self {
            fft,
            bins,
            gxx: vec![0.0; count],
            gyy: vec![0.0; count],
            gxy: vec![Complex::ZERO; count],
        }
    }

    /// Adds a window.
    pub(crate) fn add(&mut self, input: &[f64], output: &[f64]) {
        let [x, y] = &mut self.bins;
        self.fft.forward(input, x);
        self.fft.forward(output, y);
        for (bin, (x, y)) in x.iter().zip(y.iter()).enumerate() {
            self.gxx[bin] += x.norm_sqr();
            self.gyy[bin] += y.norm_sqr();
            self.gxy[bin] += x.conj() * y;
        }
    }
}
