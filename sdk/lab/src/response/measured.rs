//! A measured response.

use htex_author::recording::SetupResponse;
use serde::Serialize;

use super::error::ResponseError;
use super::estimator::Estimator;
use super::options::{Excitation, ResponseOptions};
use super::peak::Peak;
use super::pieces::Piece;

/// Smallest and largest magnitude that a response file may hold.
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
    /// Every hit or window, whether it was used or thrown out.
    pub pieces: Vec<Piece>,
    /// Frequencies, hertz: multiples of the resolution.
    pub frequency_hz: Vec<f64>,
    /// Magnitude, output's unit per input's unit; 0 where there is no input.
    pub magnitude: Vec<f64>,
    /// Phase of the output relative to the input, radians, unwrapped.
    pub phase_rad: Vec<f64>,
    /// Coherence, 0 to 1.
    pub coherence: Vec<f64>,
    /// Relative standard deviation of the magnitude, at most 1:
    /// `sqrt(1 - coherence) / sqrt(2 coherence averages)` (Bendat & Piersol, chapter 9). It only
    /// covers random errors.
    pub relative_error: Vec<f64>,
    /// The largest magnitude; `None` if it is at an edge of the band.
    pub peak: Option<Peak>,
    /// What limits the result, as full sentences.
    pub warnings: Vec<String>,
}

impl MeasuredResponse {
    /// Converts the response to the form in which recordings are divided by it and scenes
    /// compensate for it. Its [`write_csv`](SetupResponse::write_csv) writes the file that both
    /// read.
    #[must_use]
    pub fn setup_response(&self) -> SetupResponse {
        SetupResponse {
            frequency_hz: self.frequency_hz.clone(),
            magnitude: self.magnitude.clone(),
            phase_rad: self.phase_rad.clone(),
        }
    }

    /// Checks the magnitudes and adds what follows from them.
    pub(crate) fn finish(&mut self, options: &ResponseOptions) -> Result<(), ResponseError> {
        let is_valid =
            |magnitude: f64| magnitude == 0.0 || (SMALLEST..=LARGEST).contains(&magnitude);
        if let Some(at) = self.magnitude.iter().position(|magnitude| !is_valid(*magnitude)) {
            let (frequency_hz, magnitude) = (self.frequency_hz[at], self.magnitude[at]);
            return Err(ResponseError::Magnitude { frequency_hz, magnitude });
        }
        let averages = independent(options, self.averages);
        let error =
            |coherence: &f64| ((1.0 - coherence) / (2.0 * coherence * averages)).sqrt().min(1.0);
        self.relative_error = self.coherence.iter().map(error).collect();
        self.peak = Peak::of(&self.frequency_hz, &self.magnitude);
        Ok(())
    }
}

/// Returns the number of independent averages. Hann windows with half overlap share a part of their
/// power (Welch 1967).
fn independent(options: &ResponseOptions, used: usize) -> f64 {
    let used = used as f64;
    match options.excitation {
        Excitation::Hits(_) => used,
        Excitation::Continuous => used / (1.0 + (used - 1.0) / (18.0 * used)),
    }
}
