//! A measured response.

use htex_author::recording::SetupResponse;
use htex_finding::Hint;
use serde::Serialize;

use super::average::{average, count_used, cut, scale_of};
use super::error::{Channel, ResponseError};
use super::estimator::{Bin, Estimator};
use super::notices::{notices, without_hits};
use super::options::{Excitation, ResponseOptions};
use super::peak::Peak;
use super::pieces::{Cut, Piece};
use super::record::Record;
use super::spectra::Spectra;

/// Magnitudes that a response file may hold.
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
    /// Distance of the frequencies, hertz: the inverse of the window.
    pub resolution_hz: f64,
    /// Number of hits or windows that were averaged.
    pub averages: usize,
    /// Every hit or window, used or thrown out.
    pub pieces: Vec<Piece>,
    /// Frequencies, hertz: multiples of the resolution.
    pub frequency_hz: Vec<f64>,
    /// Magnitude, in the output's unit over the input's; 0 where there is no input.
    pub magnitude: Vec<f64>,
    /// Phase of output against input, radians, unwrapped.
    pub phase_rad: Vec<f64>,
    /// Coherence, 0 to 1.
    pub coherence: Vec<f64>,
    /// Standard deviation of the magnitude relative to it, at most 1:
    /// `sqrt(1 - coherence) / sqrt(2 coherence averages)` (Bendat & Piersol, chapter 9). It counts random errors alone.
    pub relative_error: Vec<f64>,
    /// The largest magnitude; none if it is at an edge of the band.
    pub peak: Option<Peak>,
    /// What limits the result, each a full sentence.
    pub warnings: Vec<String>,
}

/// Measures the response of a setup from records of its input and output.
///
/// # Errors
/// Options out of range; no records, or records of different rates; a record shorter than a window; no hits, or fewer
/// than two that can be used; a magnitude that no response file may hold.
pub fn measure(
    records: &[Record],
    options: &ResponseOptions,
) -> Result<MeasuredResponse, ResponseError> {
    let rate_hz = common_rate(records)?;
    let len = options.check(rate_hz)?;
    let cuts: Vec<Vec<Cut>> = records
        .iter()
        .map(|record| cut(record, len, options))
        .collect::<Result<_, _>>()?;
    let without_hits = without_hits(records, &cuts);
    let used = count_used(records, &cuts, options)?;
    let (spectra, outlasting) = average(records, &cuts, len, options);
    let resolution_hz = rate_hz / len as f64;
    let bins = band(options, resolution_hz, spectra.gxx.len())?;
    let scale = scale_of(records, Channel::Output) / scale_of(records, Channel::Input);
    let in_band = in_band(&spectra, &bins);
    let mut measured = MeasuredResponse {
        estimator: options.estimator,
        rate_hz,
        window_s: len as f64 / rate_hz,
        resolution_hz,
        averages: used,
        pieces: cuts.into_iter().flatten().map(|cut| cut.piece).collect(),
        frequency_hz: bins.clone().map(|bin| bin as f64 * resolution_hz).collect(),
        magnitude: in_band
            .iter()
            .map(|bin| scale * bin.magnitude(options.estimator))
            .collect(),
        phase_rad: unwrapped(in_band.iter().map(Bin::phase_rad)),
        coherence: in_band.iter().map(Bin::coherence).collect(),
        relative_error: Vec::new(),
        peak: None,
        warnings: Vec::new(),
    };
    measured.finish(options, outlasting)?;
    measured.warnings.extend(without_hits);
    Ok(measured)
}

impl MeasuredResponse {
    /// Returns the response as recordings are divided by and scenes compensate it; its
    /// [`write_csv`](SetupResponse::write_csv) writes the file that they read.
    #[must_use]
    pub fn setup_response(&self) -> SetupResponse {
        SetupResponse {
            frequency_hz: self.frequency_hz.clone(),
            magnitude: self.magnitude.clone(),
            phase_rad: self.phase_rad.clone(),
        }
    }

    fn finish(
        &mut self,
        options: &ResponseOptions,
        outlasting: usize,
    ) -> Result<(), ResponseError> {
        let is_valid =
            |magnitude: f64| magnitude == 0.0 || (SMALLEST..=LARGEST).contains(&magnitude);
        if let Some(at) = self
            .magnitude
            .iter()
            .position(|magnitude| !is_valid(*magnitude))
        {
            let (frequency_hz, magnitude) = (self.frequency_hz[at], self.magnitude[at]);
            return Err(ResponseError::Magnitude {
                frequency_hz,
                magnitude,
            });
        }
        let averages = independent(options, self.averages);
        let error = |coherence: &f64| {
            ((1.0 - coherence) / (2.0 * coherence * averages))
                .sqrt()
                .min(1.0)
        };
        self.relative_error = self.coherence.iter().map(error).collect();
        self.peak = Peak::of(&self.frequency_hz, &self.magnitude);
        self.warnings = notices(self, options, outlasting);
        Ok(())
    }
}

fn common_rate(records: &[Record]) -> Result<f64, ResponseError> {
    let first = records.first().ok_or(ResponseError::Nothing)?;
    match records
        .iter()
        .find(|record| record.rate_hz() != first.rate_hz())
    {
        None => Ok(first.rate_hz()),
        Some(other) => Err(ResponseError::Rates {
            first: first.file().to_owned(),
            first_hz: first.rate_hz(),
            file: other.file().to_owned(),
            rate_hz: other.rate_hz(),
        }),
    }
}

/// The bins of the band.
fn band(
    options: &ResponseOptions,
    resolution_hz: f64,
    bins: usize,
) -> Result<std::ops::Range<usize>, ResponseError> {
    // A bin at an edge of the band belongs to it, whatever the rounding of the quotient.
    let low = (options.low_hz / resolution_hz * (1.0 - 1e-12)).ceil() as usize;
    let high = (options.high_hz / resolution_hz * (1.0 + 1e-12)).floor() as usize;
    let range = low..high.saturating_add(1).min(bins);
    if range.len() < 2 {
        return Err(ResponseError::Option {
            option: "the highest frequency (Hz)",
            hint: Hint::new(&["high"]),
            value: options.high_hz,
            problem: format!(
                "there must be two points of the grid of {resolution_hz} Hz from {} Hz to it; widen the band or lengthen the window",
                options.low_hz
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

/// Number of independent averages: Hann windows with half overlap share a part of their power (Welch 1967).
fn independent(options: &ResponseOptions, used: usize) -> f64 {
    let used = used as f64;
    match options.excitation {
        Excitation::Hits(_) => used,
        Excitation::Continuous => used / (1.0 + (used - 1.0) / (18.0 * used)),
    }
}

/// Removes jumps of more than half a turn.
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
