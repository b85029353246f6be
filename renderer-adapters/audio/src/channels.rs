//! Cards whose channels play different things, for devices that choose them.

use htex_device::{Capabilities, Device, DeviceError, Endpoint, StreamFormat};

use crate::card::{self, Card, Side};
use crate::sound::{Channels, Sound};

/// The connected outputs, each chosen by a setting called `device`.
///
/// # Errors
/// When the system's sound does not answer.
pub fn outputs() -> Result<Vec<Endpoint>, DeviceError> {
    card::endpoints(Side::Output)
}

/// What an output can do with so many channels.
///
/// # Errors
/// When it is not connected, or does not take so many.
pub fn capabilities_of_channels(device: &str, channels: u16) -> Result<Capabilities, DeviceError> {
    Card::find(device, Side::Output)?.with_channels(channels)?.capabilities()
}

/// Opens an output with a channel for each factor: what the channel plays of each sample.
///
/// # Errors
/// As [`capabilities_of_channels`], and when it does not have the rate.
pub fn open_channels(
    device: &str,
    factors: &[f32],
    buffer_s: f64,
    format: &StreamFormat,
) -> Result<Box<dyn Device>, DeviceError> {
    let card = Card::find(device, Side::Output)?.with_channels(factors.len() as u16)?;
    let sound = Sound::open(&card, buffer_s, format, Channels::Factors(factors))?;
    Ok(Box::new(sound))
}
