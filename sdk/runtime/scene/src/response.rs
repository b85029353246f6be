//! The frequency response of the finger on the display, and the compensation of this response.

use std::path::Path;

use htex_dsp::grid::Band;
use htex_play::Texture;
use htex_recording::{RaisedRanges, raised, read_response, response_from_bytes};
use htex_recording::{ReadError, ReadProblem};

pub use htex_recording::SetupResponse as Response;

/// Reads a response from a CSV file with the columns `frequency_hz` and `magnitude` (output over
/// input). The unit does not matter, because only the shape is compensated.
///
/// # Errors
/// Returns the same errors as [`read_response`]. Also returns an error if no magnitude is above 0.
pub(crate) fn open(path: &Path) -> Result<Response, ReadError> {
    let file = path.file_name().unwrap_or(path.as_os_str());
    not_zero(read_response(path)?, &file.to_string_lossy())
}

/// Reads a response like [`open`], from a file in memory. Messages name `file`.
pub(crate) fn from_bytes(file: &str, bytes: &[u8]) -> Result<Response, ReadError> {
    not_zero(response_from_bytes(file, bytes)?, file)
}

fn not_zero(response: Response, file: &str) -> Result<Response, ReadError> {
    if response.magnitude.iter().all(|m| *m == 0.0) {
        let problem = ReadProblem::Option {
            option: "response",
            problem:
                "every magnitude is 0, which cannot be compensated; measure the response again"
                    .into(),
        };
        return Err(problem.in_file(file));
    }
    Ok(response)
}

/// The inverse of a response. Only the response's shape matters: the response is normalised to its
/// largest magnitude in the textures' band. At this magnitude the gain is near 1. Where the
/// response is weaker, the gain is higher, up to a limit.
#[derive(Debug, Clone)]
pub(crate) struct Inverse {
    response: Response,
    band: Band,
    /// Largest magnitude of the response in the band. 0 if the response is 0 there.
    largest: f64,
    /// Depth of the compensation as a magnitude, relative to the largest magnitude.
    floor: f64,
}

impl Inverse {
    /// Makes the inverse of a response for these textures. `pitch` is the factor that multiplies
    /// all frequencies of the textures.
    pub(crate) fn new(response: &Response, assets: &[Texture], pitch: f64, depth_db: f64) -> Self {
        let band = played_band(assets, pitch);
        Self {
            largest: response.largest_in(band),
            response: response.clone(),
            band,
            floor: libm::pow(10.0, -depth_db / 20.0),
        }
    }

    /// Returns the gain at a frequency: |H| / (|H|² + floor²), where H is relative to its largest
    /// magnitude in the band. The gain is near 1/|H| and at most 1/(2 floor). Where the response is
    /// 0, the gain is 0.
    pub(crate) fn gain_at(&self, frequency_hz: f64) -> f64 {
        let (re, im) = self.response.value_at(frequency_hz);
        let part = libm::hypot(re, im) / self.largest;
        let gain = part / (part * part + self.floor * self.floor);
        // If the response is 0 in the whole band, this is 0 / 0.
        if gain.is_finite() { gain } else { 0.0 }
    }

    /// Whether the response is nonzero in the band.
    pub(crate) fn reaches_band(&self) -> bool {
        self.largest > 0.0
    }

    /// Returns which parts of the band the compensation amplifies, and by how much.
    pub(crate) fn raised(&self) -> Option<RaisedRanges> {
        let grid = self.band.grid_hz();
        raised(&grid, grid.iter().map(|&hz| self.gain_at(hz)))
    }

    pub(crate) fn band(&self) -> Band {
        self.band
    }
}

/// Returns the band from the lowest to the highest frequency of the textures.
fn played_band(assets: &[Texture], pitch: f64) -> Band {
    let bands = || assets.iter().map(Texture::band);
    Band {
        low_hz: pitch * bands().map(|b| b.low_hz).fold(f64::INFINITY, f64::min),
        high_hz: pitch * bands().map(|b| b.high_hz).fold(0.0, f64::max),
    }
}
