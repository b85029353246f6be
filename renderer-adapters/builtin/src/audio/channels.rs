//! Sound cards whose channels play different signals. The devices of the module `channels` use such
//! cards.

use htex_device::{Capabilities, DeviceError, Direction, Endpoint, Output, StreamFormat};

use crate::audio::card::{self, Card};
use crate::audio::sound::{Channels, Sound};

/// Lists the connected outputs. The setting `device` selects one of them.
///
/// # Errors
/// Returns an error if the system's sound service does not respond.
pub fn outputs() -> Result<Vec<Endpoint>, DeviceError> {
    card::endpoints(Direction::Output)
}

/// Returns the capabilities of an output with this number of channels.
///
/// # Errors
/// Returns an error if the output is not connected, or does not support this number of channels.
pub fn capabilities_of_channels(device: &str, channels: u16) -> Result<Capabilities, DeviceError> {
    Card::find(device, Direction::Output)?.with_channels(channels)?.capabilities()
}

/// Opens an output with one channel for each factor in `factors`. A channel plays the samples
/// multiplied by the channel's factor.
///
/// # Errors
/// Returns the same errors as [`capabilities_of_channels`]. Also returns an error if the output
/// does not support the rate.
pub fn open_channels(
    device: &str,
    factors: &[f32],
    buffer_s: f64,
    format: &StreamFormat,
) -> Result<Box<dyn Output>, DeviceError> {
    let card = Card::find(device, Direction::Output)?.with_channels(factors.len() as u16)?;
    let sound = Sound::open(&card, buffer_s, format, Channels::Factors(factors))?;
    Ok(Box::new(sound))
}
