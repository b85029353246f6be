//! Measures a frequency response from records: the response itself, its largest magnitude, and
//! warnings about its accuracy.
//!
//! The largest magnitude may lie between two frequencies of the grid. To find it, the code
//! interpolates 1/magnitude², which is a parabola near a resonance. The response file contains only
//! the values on the grid, because the programs that read the file interpolate.

use htex_author::recording::SetupResponse;
use htex_base::finding::Hint;
use serde::Serialize;

use super::average::{Spectra, average, count_used, cut, scale_of};
use super::estimator::{Bin, Estimator};
use super::pieces::{Cut, Piece};
use super::record::{Channel, Record};
use super::settings::ResponseSettings;
use crate::error::LabError;

/// Measures the frequency response of a setup from records of its input and output.
///
/// # Errors
/// - A setting is out of range.
/// - There are no records, the records have different sample rates, or a record is shorter than a
///   window.
/// - There are no hits, or fewer than two usable hits.
/// - A magnitude is out of the range that a response file may contain.
pub fn measure(
    records: &[Record],
    settings: &ResponseSettings,
) -> Result<MeasuredResponse, LabError> {
    let rate_hz = common_rate(records)?;
    let len = settings.check(rate_hz)?;
    let cuts: Vec<Vec<Cut>> =
        records.iter().map(|record| cut(record, len, settings)).collect::<Result<_, _>>()?;
    let without_hits = without_hits(records, &cuts);
    let used = count_used(records, &cuts, settings)?;
    let (spectra, outlasting) = average(records, &cuts, len, settings);
    let resolution_hz = rate_hz / len as f64;
    let bins = band(settings, resolution_hz, spectra.gxx.len())?;
    // `average` has divided both channels by their scales. This factor undoes the division.
    let scale = scale_of(records, Channel::Output) / scale_of(records, Channel::Input);
    let in_band = in_band(&spectra, &bins);
    let mut measured = MeasuredResponse {
        estimator: settings.estimator,
        rate_hz,
        window_s: len as f64 / rate_hz,
        resolution_hz,
        averages: used,
        pieces: cuts.into_iter().flatten().map(|cut| cut.piece).collect(),
        frequency_hz: bins.clone().map(|bin| bin as f64 * resolution_hz).collect(),
        magnitude: in_band.iter().map(|bin| scale * bin.magnitude(settings.estimator)).collect(),
        phase_rad: unwrapped(in_band.iter().map(Bin::phase_rad)),
        coherence: in_band.iter().map(Bin::coherence).collect(),
        relative_error: Vec::new(),
        peak: None,
        warnings: Vec::new(),
    };
    measured.finish(settings)?;
    measured.warnings = notices(&measured, settings, outlasting);
    measured.warnings.extend(without_hits);
    Ok(measured)
}

fn common_rate(records: &[Record]) -> Result<f64, LabError> {
    let first = records.first().ok_or(LabError::NoRecord)?;
    match records.iter().find(|record| record.rate_hz() != first.rate_hz()) {
        None => Ok(first.rate_hz()),
        Some(other) => Err(LabError::Rates {
            first: first.file().to_owned(),
            first_hz: first.rate_hz(),
            file: other.file().to_owned(),
            rate_hz: other.rate_hz(),
        }),
    }
}

/// Returns the range of frequency bins in the band.
fn band(
    settings: &ResponseSettings,
    resolution_hz: f64,
    bins: usize,
) -> Result<std::ops::Range<usize>, LabError> {
    // A bin at an edge of the band belongs to the band even if the quotient was rounded.
    let low = (settings.low_hz / resolution_hz * (1.0 - 1e-12)).ceil() as usize;
    let high = (settings.high_hz / resolution_hz * (1.0 + 1e-12)).floor() as usize;
    let range = low..high.saturating_add(1).min(bins);
    if range.len() < 2 {
        return Err(LabError::Option {
            option: "the highest frequency (Hz)",
            hint: Hint::new(&["high"]),
            value: settings.high_hz,
            problem: format!(
                "there must be two points of the grid of {resolution_hz} Hz from {} Hz to it; widen the band or lengthen the window",
                settings.low_hz
            ),
        });
    }
    Ok(range)
}

fn in_band(spectra: &Spectra, bins: &std::ops::Range<usize>) -> Vec<Bin> {
    let power = |values: &[f64]| values[bins.clone()].iter().sum::<f64>();
    let (input_power, output_power) = (power(&spectra.gxx), power(&spectra.gyy));
    let bin = |bin: usize| Bin {
        gxx: spectra.gxx[bin],
        gyy: spectra.gyy[bin],
        gxy: spectra.gxy[bin],
        input_power,
        output_power,
    };
    bins.clone().map(bin).collect()
}

/// Removes jumps of more than half a turn from phases.
fn unwrapped(phases: impl Iterator<Item = f64>) -> Vec<f64> {
    let turn = 2.0 * std::f64::consts::PI;
    let mut previous = None;
    let mut follow = |phase: f64| {
        let before = *previous.get_or_insert(phase);
        let phase = phase - turn * libm::round((phase - before) / turn);
        previous = Some(phase);
        phase
    };
    phases.map(&mut follow).collect()
}

/// Smallest and largest magnitude that a response file may contain.
const SMALLEST: f64 = 1e-9;
const LARGEST: f64 = 1e9;

/// A measured frequency response. The vectors have one entry for each frequency.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct MeasuredResponse {
    pub estimator: Estimator,
    /// Sample rate of the recordings, hertz.
    pub rate_hz: f64,
    /// Length of a window, seconds.
    pub window_s: f64,
    /// Distance between the frequencies, hertz: the inverse of the window's length.
    pub resolution_hz: f64,
    /// Number of hits or windows that were averaged.
    pub averages: usize,
    /// All hits or windows, including those that were thrown out.
    pub pieces: Vec<Piece>,
    /// Frequencies, hertz: multiples of the resolution.
    pub frequency_hz: Vec<f64>,
    /// Magnitude, in the output's unit per unit of the input. It is 0 at frequencies without input.
    pub magnitude: Vec<f64>,
    /// Phase of the output relative to the input, radians, unwrapped.
    pub phase_rad: Vec<f64>,
    /// Coherence, 0 to 1.
    pub coherence: Vec<f64>,
    /// Relative standard deviation of the magnitude, at most 1: `sqrt(1 - coherence) / sqrt(2
    /// coherence averages)` (Bendat & Piersol, chapter 9). This value covers only random errors.
    pub relative_error: Vec<f64>,
    /// The largest magnitude and its frequency. `None` if the largest magnitude lies at an edge of
    /// the band.
    pub peak: Option<Peak>,
    /// Warnings about the accuracy of the result, as full sentences.
    pub warnings: Vec<String>,
}

impl MeasuredResponse {
    /// Converts the response to a [`SetupResponse`]. Programs use this response to remove the
    /// effect of the rig from recordings, or the effect of the display from scenes.
    /// [`write_csv`](SetupResponse::write_csv) writes the file that recordings and scenes use.
    #[must_use]
    pub fn setup_response(&self) -> SetupResponse {
        SetupResponse {
            frequency_hz: self.frequency_hz.clone(),
            magnitude: self.magnitude.clone(),
            phase_rad: self.phase_rad.clone(),
        }
    }

    /// Checks the magnitudes, and adds the values that are computed from them.
    pub(crate) fn finish(&mut self, settings: &ResponseSettings) -> Result<(), LabError> {
        let is_valid =
            |magnitude: f64| magnitude == 0.0 || (SMALLEST..=LARGEST).contains(&magnitude);
        if let Some(at) = self.magnitude.iter().position(|magnitude| !is_valid(*magnitude)) {
            let (frequency_hz, magnitude) = (self.frequency_hz[at], self.magnitude[at]);
            return Err(LabError::Magnitude { frequency_hz, magnitude });
        }
        let averages = independent(settings, self.averages);
        let error =
            |coherence: &f64| ((1.0 - coherence) / (2.0 * coherence * averages)).sqrt().min(1.0);
        self.relative_error = self.coherence.iter().map(error).collect();
        self.peak = Peak::find(&self.frequency_hz, &self.magnitude);
        Ok(())
    }
}

/// Returns the number of independent averages. Hann windows with half overlap share a part of their
/// power (Welch 1967).
fn independent(settings: &ResponseSettings, used: usize) -> f64 {
    let used = used as f64;
    if settings.continuous { used / (1.0 + (used - 1.0) / (18.0 * used)) } else { used }
}

/// The largest magnitude of a response.
///
/// The peak is interpolated: a parabola is put through `1 / magnitude²` at the largest point of the
/// grid and its two neighbours. For a lightly damped resonance, `1 / magnitude²` is a parabola.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Peak {
    pub frequency_hz: f64,
    /// Magnitude, output over input.
    pub magnitude: f64,
    /// The magnitude in decibels.
    pub magnitude_db: f64,
}

impl Peak {
    /// Finds the peak. Returns `None` if the largest magnitude is at the first or the last
    /// frequency, or if a magnitude next to it is zero.
    pub(crate) fn find(frequency_hz: &[f64], magnitude: &[f64]) -> Option<Self> {
        let larger = |best: usize, at: usize| {
            if magnitude[at] > magnitude[best] { at } else { best }
        };
        let top = (0..magnitude.len()).reduce(larger)?;
        let (before, after) = (top.checked_sub(1)?, top + 1);
        let step_hz = frequency_hz.get(after)? - frequency_hz[top];
        let [y0, y1, y2] = [before, top, after].map(|at| 1.0 / (magnitude[at] * magnitude[at]));
        if ![y0, y1, y2].iter().all(|y| y.is_finite()) {
            return None;
        }
        let bend = y0 - 2.0 * y1 + y2;
        let shift = if bend > 0.0 { 0.5 * (y0 - y2) / bend } else { 0.0 };
        let least = y1 - 0.25 * (y0 - y2) * shift;
        // If the points do not belong to one resonance, the parabola may fall below 0.
        let magnitude = if least > 0.0 { 1.0 / least.sqrt() } else { magnitude[top] };
        Some(Self {
            frequency_hz: frequency_hz[top] + shift * step_hz,
            magnitude,
            magnitude_db: 20.0 * libm::log10(magnitude),
        })
    }
}

/// With fewer averages than this, the coherence is not meaningful.
const FEW: usize = 5;
/// Coherence below which the response is uncertain.
const COHERENT: f64 = 0.9;
/// Two stretches of low coherence are reported as one if their distance, relative to their
/// frequency, is at most this number.
const NEAR: f64 = 0.1;

/// Returns the warnings about a measured response. `outlasting` is the number of hits whose
/// response has not died out at the end of its window.
pub(crate) fn notices(
    measured: &MeasuredResponse,
    settings: &ResponseSettings,
    outlasting: usize,
) -> Vec<String> {
    let mut found = Vec::new();
    if measured.averages < FEW {
        found.push(format!(
            "Only {} are averaged; the coherence of fewer than {FEW} is high by chance.",
            measured.averages
        ));
    }
    if let Some(stretches) = incoherent(measured) {
        found.push(format!(
            "The coherence falls below {COHERENT} {stretches}; the response is uncertain there."
        ));
    }
    if let Some(hit) = settings.hits() {
        if outlasting > 0 {
            found.push(format!(
                "The response of {outlasting} of {} hits has not died out at the end of its window of {} s; lengthen the \
                 window, or give an exponential one.",
                measured.averages, measured.window_s
            ));
        }
        if let Some(tau_s) = hit.exponential_s {
            found.push(format!(
                "The exponential window raises the damping of every resonance by {:.4} 1/s: peaks are lower and wider.",
                1.0 / tau_s
            ));
        }
    }
    found
}

/// Returns a warning for each record in which no hit or window was found.
pub(crate) fn without_hits(records: &[Record], cuts: &[Vec<Cut>]) -> Vec<String> {
    let both = records.iter().zip(cuts);
    let empty = both.filter(|(_, cuts)| cuts.is_empty());
    empty.map(|(record, _)| format!("{}: no hit found.", record.file())).collect()
}

/// Describes the stretches of low coherence. Stretches that are closer to each other than a tenth
/// of their frequency are merged.
fn incoherent(measured: &MeasuredResponse) -> Option<String> {
    let mut stretches: Vec<(f64, f64)> = Vec::new();
    let both = measured.frequency_hz.iter().zip(&measured.coherence);
    for (hz, _) in both.filter(|(_, coherence)| **coherence < COHERENT) {
        match stretches.last_mut() {
            Some(last) if hz - last.1 <= NEAR * hz => last.1 = *hz,
            _ => stretches.push((*hz, *hz)),
        }
    }
    let words: Vec<String> = stretches.into_iter().map(words).collect();
    (!words.is_empty()).then(|| words.join(", "))
}

fn words((low_hz, high_hz): (f64, f64)) -> String {
    if low_hz == high_hz {
        format!("at {low_hz:.1} Hz")
    } else {
        format!("between {low_hz:.1} and {high_hz:.1} Hz")
    }
}
