//! The destination of the frames.

use std::path::PathBuf;

use crate::motor::{has_usual_buffer, rate_error};
use htex_device::{
    Capabilities, DeviceError, Endpoint, Output, Quantity, Rates, Settings, StreamFormat,
};

use crate::channels::nowhere;

/// The values of the setting `to`.
pub(crate) const NAMES: [&str; 3] = ["sound", "file", "null"];
pub(crate) const DEFAULT_CARD: &str = "default";

/// Sample rates for outputs without a sound card, hertz. A DualSense uses 48 kHz.
const RATES_HZ: [f64; 6] = [8_000.0, 16_000.0, 32_000.0, 44_100.0, 48_000.0, 96_000.0];
const DEFAULT_RATE_HZ: f64 = 48_000.0;
const BLOCK_FRAMES: u32 = 480;

#[derive(Debug, Clone, PartialEq)]
pub(crate) enum To {
    Sound { card: String, buffer_s: f64 },
    File(PathBuf),
    Null { buffer_s: f64 },
}

impl To {
    /// Reads the settings.
    ///
    /// # Errors
    /// Returns an error if a setting would have no effect in combination with the other settings.
    pub(crate) fn new(settings: &Settings) -> Result<Self, DeviceError> {
        let to = settings.text("to");
        let (card, path) = (settings.text("device"), settings.text("path"));
        // The settings do not show whether the user gave a value. So a value is refused only if it
        // differs from the default.
        if to != "sound" && card != DEFAULT_CARD {
            return refuse("device", format!("it is for to=sound, and to={to}"));
        }
        if to != "file" && !path.is_empty() {
            return refuse("path", format!("it is for to=file, and to={to}"));
        }
        if to == "file" && !has_usual_buffer(settings) {
            return refuse("buffer_ms", "a file has no buffer that keeps samples ready".to_owned());
        }
        let buffer_s = settings.number("buffer_ms") / 1e3;
        match to {
            "sound" => Ok(Self::Sound { card: card.to_owned(), buffer_s }),
            "file" if path.is_empty() => {
                refuse("path", "to=file writes a file; name it".to_owned())
            }
            "file" => Ok(Self::File(path.into())),
            _ => Ok(Self::Null { buffer_s }),
        }
    }

    pub(crate) fn capabilities(&self, factors: &[f32]) -> Result<Capabilities, DeviceError> {
        match self {
            Self::Sound { card, .. } => sound::capabilities(card, factors.len() as u16),
            Self::File(_) => Ok(free(false)),
            Self::Null { .. } => Ok(free(true)),
        }
    }

    pub(crate) fn open(
        &self,
        factors: &[f32],
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let can = self.capabilities(factors)?;
        if !can.has_rate(format.rate_hz) {
            return Err(rate_error("Channels", format.rate_hz, &can));
        }
        match self {
            Self::Sound { card, buffer_s } => sound::open(card, factors, *buffer_s, format),
            Self::File(path) => crate::file::open_channels(path.clone(), factors, format.rate_hz),
            Self::Null { buffer_s } => nowhere::open(*buffer_s, can, format),
        }
    }
}

/// Returns the capabilities of an output without a sound card.
fn free(paced: bool) -> Capabilities {
    Capabilities {
        quantity: Quantity::Sound,
        rates: Rates::List(RATES_HZ.to_vec()),
        default_rate_hz: DEFAULT_RATE_HZ,
        limit: Some(1.0),
        step: None,
        carrier_hz: None,
        paced,
        block_frames: BLOCK_FRAMES,
    }
}

/// Lists the connected sound cards. Empty in a build without sound.
pub(crate) fn cards() -> Vec<Endpoint> {
    sound::cards()
}

fn refuse<T>(name: &str, what: String) -> Result<T, DeviceError> {
    Err(DeviceError::setting(name, what))
}

#[cfg(feature = "audio")]
mod sound {
    pub(super) use crate::audio::{
        capabilities_of_channels as capabilities, open_channels as open,
    };

    pub(super) fn cards() -> Vec<htex_device::Endpoint> {
        crate::audio::outputs().unwrap_or_default()
    }
}

#[cfg(not(feature = "audio"))]
mod sound {
    use htex_device::{Capabilities, DeviceError, Endpoint, Output, StreamFormat};

    fn absent<T>() -> Result<T, DeviceError> {
        Err(DeviceError::Missing(
            "this htex is built without sound, the feature `audio`; to=file and to=null need none"
                .to_owned(),
        ))
    }

    pub(super) fn cards() -> Vec<Endpoint> {
        Vec::new()
    }

    pub(super) fn capabilities(_card: &str, _channels: u16) -> Result<Capabilities, DeviceError> {
        absent()
    }

    pub(super) fn open(
        _card: &str,
        _factors: &[f32],
        _buffer_s: f64,
        _format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        absent()
    }
}
