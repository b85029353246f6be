//! The JSON documents of the source ABI: the descriptor of an adapter, and the rate and channels of
//! an open source.

use serde::{Deserialize, Serialize};

use crate::source::Channel;
use crate::source::abi::{MAX_CHANNELS, MAX_NAME_BYTES, MAX_RATE_HZ, MIN_RATE_HZ};
use crate::{Descriptor, DescriptorError};

/// The description of a source adapter.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct SourceDescriptor {
    /// The part that a source has in common with a device.
    #[serde(flatten)]
    pub descriptor: Descriptor,
    /// Name of the setting that chooses a source of the family.
    pub target: String,
}

impl SourceDescriptor {
    /// Checks the descriptor ([`Descriptor::check`]), and that the target is one of the settings.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self) -> Result<(), DescriptorError> {
        self.descriptor.check()?;
        let mut settings = self.descriptor.settings.iter();
        if settings.any(|setting| setting.name == self.target) {
            Ok(())
        } else {
            Err(DescriptorError::Target { target: self.target.clone() })
        }
    }
}

/// The rate and the channels of an open source.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct SourceStream {
    /// Frames per second.
    #[cfg_attr(feature = "schemars", schemars(range(min = MIN_RATE_HZ, max = MAX_RATE_HZ)))]
    pub rate_hz: f64,
    /// The channels, in the order of the samples within a frame.
    #[cfg_attr(feature = "schemars", schemars(length(min = 1, max = MAX_CHANNELS)))]
    pub channels: Vec<Channel>,
}

/// Error: a source's rate or channels are invalid.
#[allow(missing_docs)] // The message says what a field is.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum SourceStreamError {
    /// The rate is not a number within the limits.
    #[error("a rate of {rate_hz} Hz; {MIN_RATE_HZ} to {MAX_RATE_HZ} Hz are allowed")]
    Rate { rate_hz: f64 },
    /// There are too few or too many channels.
    #[error("{count} channels; 1 to {MAX_CHANNELS} are allowed")]
    Count { count: usize },
    /// The name or unit of a channel is too long or has control characters, or the name is empty.
    #[error(
        "channel {index}: a name has 1 to {MAX_NAME_BYTES} bytes, a unit as many or none, without control characters"
    )]
    Name { index: usize },
    /// Two channels have the same name.
    #[error("two channels are named `{name}`")]
    Twice { name: String },
}

impl SourceStream {
    /// Checks the rate, and the number, names and units of the channels.
    ///
    /// # Errors
    /// The first fault.
    pub fn check(&self) -> Result<(), SourceStreamError> {
        let Self { rate_hz, channels } = self;
        if !(MIN_RATE_HZ..=MAX_RATE_HZ).contains(rate_hz) {
            return Err(SourceStreamError::Rate { rate_hz: *rate_hz });
        }
        if !(1..=MAX_CHANNELS).contains(&channels.len()) {
            let count = channels.len();
            return Err(SourceStreamError::Count { count });
        }
        let plain = |text: &str| text.len() <= MAX_NAME_BYTES && !text.contains(char::is_control);
        let sound = |c: &Channel| !c.name.trim().is_empty() && plain(&c.name) && plain(&c.unit);
        if let Some(index) = channels.iter().position(|channel| !sound(channel)) {
            return Err(SourceStreamError::Name { index });
        }
        let mut names: Vec<&str> = channels.iter().map(|c| c.name.as_str()).collect();
        names.sort_unstable();
        match names.windows(2).find(|pair| pair[0] == pair[1]) {
            Some(pair) => Err(SourceStreamError::Twice { name: pair[0].to_owned() }),
            None => Ok(()),
        }
    }
}
