//! The two traits of sources.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::{Descriptor, DeviceError, Endpoint, Settings};

/// A family of sources, such as the analog inputs of a driver's cards.
pub trait SourceAdapter: Send + Sync {
    /// The adapter's descriptor; the same at each call. `[any thread]`
    fn descriptor(&self) -> &Descriptor;

    /// Name of the setting that says which source of the family is meant: `channels`, `path`.
    /// `[any thread]`
    fn target(&self) -> &str;

    /// The sources that are connected now; an empty list is not an error. `[any thread]`
    ///
    /// # Errors
    /// When a driver is missing: the message says what to install.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError>;

    /// Opens a source, which does not sample yet. `[any thread]`
    ///
    /// # Errors
    /// When a setting is not usable, or the source is not connected.
    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError>;
}

/// An open source. Dropping it stops it.
///
/// ```
/// use std::time::Duration;
/// use htex_device::{Channel, Delivered, DeviceError, Source};
///
/// /// Counts: one channel whose samples are 0, 1, 2 …
/// struct Counter { channels: Vec<Channel>, next: f64 }
///
/// impl Source for Counter {
///     fn channels(&self) -> &[Channel] { &self.channels }
///     fn rate_hz(&self) -> f64 { 1000.0 }
///     fn start(&mut self) -> Result<(), DeviceError> { Ok(()) }
///     fn read(&mut self, samples: &mut [f64], _: Duration) -> Result<Delivered, DeviceError> {
///         for sample in samples.iter_mut() {
///             *sample = self.next;
///             self.next += 1.0;
///         }
///         Ok(Delivered::Frames(samples.len()))
///     }
///     fn stop(&mut self) -> Result<(), DeviceError> { Ok(()) }
/// }
///
/// let mut source = Counter { channels: vec![Channel::new("count", "")], next: 0.0 };
/// source.start()?;
/// let mut samples = [0.0; 3];
/// assert_eq!(source.read(&mut samples, Duration::ZERO)?, Delivered::Frames(3));
/// assert_eq!(samples, [0.0, 1.0, 2.0]);
/// # Ok::<(), DeviceError>(())
/// ```
pub trait Source: Send {
    /// The channels, in the order of the samples of a frame; at least one. `[one thread at a time]`
    fn channels(&self) -> &[Channel];

    /// Frames a second, greater than 0. `[one thread at a time]`
    fn rate_hz(&self) -> f64;

    /// Begins to sample. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// When the source is in use or gone, or was stopped before.
    fn start(&mut self) -> Result<(), DeviceError>;

    /// Writes frames to `samples`, a sample of each channel in turn: those that are there, and
    /// waits up to `timeout` for the first. The length of `samples` is a multiple of the number of
    /// channels. No frame is left out between two calls. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// [`DeviceError::Overrun`] when frames were lost because they were read too late; when the
    /// source is gone, was not started or is stopped. After an error it delivers nothing more.
    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<Delivered, DeviceError>;

    /// Stops sampling for good. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// When that failed; the source delivers nothing more even then.
    fn stop(&mut self) -> Result<(), DeviceError>;
}

/// A channel of a source.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
pub struct Channel {
    /// Name, the same at each opening with the same settings.
    pub name: String,
    /// Symbol of the unit, such as `V`; empty if the source does not know it.
    #[serde(default)]
    pub unit: String,
}

impl Channel {
    /// Makes a channel of a name and a unit.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// The result of a read.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delivered {
    /// The number of frames that were written; 0 if none came within the timeout.
    Frames(usize),
    /// The source has ended, as a file does; there are no more frames.
    End,
}
