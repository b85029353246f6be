//! The rate and the channels of an open input.

use serde::{Deserialize, Serialize};

use crate::DeviceError;
use crate::abi::{MAX_CHANNELS, MAX_NAME_BYTES, MAX_RATE_HZ, MIN_INPUT_RATE_HZ};
use crate::descriptor::first_twice;

/// The rate and the channels of an open input, which never change. A native library passes them to
/// the host as JSON.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct InputStream {
    /// Frames per second.
    #[cfg_attr(feature = "schemars", schemars(range(min = MIN_INPUT_RATE_HZ, max = MAX_RATE_HZ)))]
    pub rate_hz: f64,
    /// The channels, in the order of the samples within a frame.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1, max = MAX_CHANNELS)))]
    pub channels: Vec<Channel>,
}

/// A channel of an input.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Channel {
    /// Name. The name is the same each time the input is opened with the same settings.
    pub name: String,
    /// Symbol of the unit, such as `V`. Empty if the device does not know the unit.
    #[serde(default)]
    pub unit: String,
}

impl Channel {
    /// Creates a channel from a name and a unit.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

impl InputStream {
    /// Checks the rate, and the number, names and units of the channels.
    ///
    /// # Errors
    /// [`DeviceError::Invalid`] with the first fault.
    pub fn check(&self) -> Result<(), DeviceError> {
        self.first_fault()
            .map_or(Ok(()), |what| Err(DeviceError::Invalid { document: "stream", what }))
    }

    fn first_fault(&self) -> Option<String> {
        let Self { rate_hz, channels } = self;
        if !(MIN_INPUT_RATE_HZ..=MAX_RATE_HZ).contains(rate_hz) {
            return Some(format!(
                "a rate of {rate_hz} Hz; {MIN_INPUT_RATE_HZ} to {MAX_RATE_HZ} Hz are allowed"
            ));
        }
        if !(1..=MAX_CHANNELS).contains(&channels.len()) {
            return Some(format!("{} channels; 1 to {MAX_CHANNELS} are allowed", channels.len()));
        }
        let is_plain =
            |text: &str| text.len() <= MAX_NAME_BYTES && !text.contains(char::is_control);
        let is_sound =
            |c: &Channel| !c.name.trim().is_empty() && is_plain(&c.name) && is_plain(&c.unit);
        if let Some(index) = channels.iter().position(|channel| !is_sound(channel)) {
            return Some(format!(
                "channel {index}: a name has 1 to {MAX_NAME_BYTES} bytes, a unit as many or none, \
                 without control characters"
            ));
        }
        let name = first_twice(channels.iter().map(|c| &c.name[..]))?;
        Some(format!("two channels are named `{name}`"))
    }
}
