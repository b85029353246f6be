//! The response of finger and display, which a scene may compensate.

use std::path::Path;

use htex_author::read::ReadError;
use htex_author::response::{Raised, raised, read_response};
use htex_dsp::grid::Band;
use htex_play::Asset;

pub use htex_author::SetupResponse as Response;

/// Reads a response from a CSV with the columns `frequency_hz` and `magnitude`: output over input,
/// in any unit, since only its shape is compensated.
///
/// # Errors
/// As [`read_response`]; and when no magnitude is above 0.
pub fn open(path: &Path) -> Result<Response, ReadError> {
    let response = read_response(path)?;
    if response.magnitude.iter().all(|m| *m == 0.0) {
        let file = path.file_name().unwrap_or(path.as_os_str());
        return Err(ReadError::Option {
            file: file.to_string_lossy().into_owned(),
            problem: "every magnitude is 0, and nothing can make up for that; measure anew".into(),
        });
    }
    Ok(response)
}

/// The inverse of a response, of which only the shape counts: its largest magnitude in the band of the
/// textures stands for 1. There the force is left as it is, elsewhere it is raised.
#[derive(Debug, Clone)]
pub(crate) struct Inverse {
    response: Response,
    band: Band,
    /// Largest magnitude in the band; 0 when there is none.
    largest: f64,
    /// Least part of the largest magnitude that is made up for.
    floor: f64,
}

impl Inverse {
    /// `pitch` is the factor on the frequencies of all textures.
    pub(crate) fn new(response: &Response, assets: &[Asset], pitch: f64, depth_db: f64) -> Self {
        let band = played_band(assets, pitch);
        Self {
            largest: response.largest_in(band),
            response: response.clone(),
            band,
            floor: 10f64.powf(-depth_db / 20.0),
        }
    }

    /// The gain at a frequency, 1/|H| and no more than 1/(2 floor): |H| / (|H|² + floor²), H over its
    /// largest magnitude in the band; 0 where the response has nothing.
    pub(crate) fn at(&self, frequency_hz: f64) -> f64 {
        let (re, im) = self.response.at(frequency_hz);
        let part = re.hypot(im) / self.largest;
        let gain = part / (part * part + self.floor * self.floor);
        if gain.is_finite() { gain } else { 0.0 }
    }

    /// Whether the response has anything in the band.
    pub(crate) fn reaches_band(&self) -> bool {
        self.largest > 0.0
    }

    /// What it raises in the band.
    pub(crate) fn raised(&self) -> Option<Raised> {
        let grid = self.band.grid_hz();
        raised(&grid, grid.iter().map(|&hz| self.at(hz)))
    }

    /// The band, hertz.
    pub(crate) fn band(&self) -> Band {
        self.band
    }
}

/// From the lowest to the highest frequency of any of the textures.
fn played_band(assets: &[Asset], pitch: f64) -> Band {
    let bands = || assets.iter().map(Asset::band);
    Band {
        low_hz: pitch * bands().map(|b| b.low_hz).fold(f64::INFINITY, f64::min),
        high_hz: pitch * bands().map(|b| b.high_hz).fold(0.0, f64::max),
    }
}
