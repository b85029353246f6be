//! The traits of input sources.

use std::time::Duration;

use serde::{Deserialize, Serialize};

use crate::{Descriptor, DeviceError, Endpoint, Settings};

/// A family of input sources, such as the analog inputs of a driver's cards. Implement this trait
/// to add an input.
///
/// A source adapter describes its sources and opens them. The open [`Source`] then delivers the
/// samples, e.g. to a recording.
///
/// # How the host calls it
///
/// A program creates the adapter once and shares it between threads, so the methods take `&self`
/// and may run at the same time. `NAME:VALUE` on the command line (e.g. `daq:Dev1/ai0`) opens the
/// adapter `NAME` with `VALUE` for the setting that [`Self::target`] names. As for an output device
/// ([`Adapter`](crate::Adapter)), the settings are complete when they arrive.
///
/// To build a native library from an adapter, derive `Default` and call
/// [`export_source!`](crate::export_source). The macro turns errors into status codes and catches
/// panics.
///
/// # Example
///
/// An adapter of counters, with a setting for the first number. [`Source`] shows the implementation
/// of `Counter`.
///
/// ```
/// # use std::time::Duration;
/// use std::collections::BTreeMap;
/// use std::sync::LazyLock;
/// use htex_device::{
///     Channel, Delivered, Descriptor, DeviceError, Endpoint, FromScene, Setting, SettingKind,
///     Settings, Source, SourceAdapter,
/// };
///
/// static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
///     id: "org.example.counter".to_owned(),
///     name: "Counter".to_owned(),
///     version: "1.0.0".to_owned(),
///     summary: "Counts up from a number.".to_owned(),
///     settings: vec![Setting {
///         name: "first".to_owned(),
///         kind: SettingKind::Number { min: 0.0, max: 1_000.0 },
///         default: Some("0".to_owned()),
///         live_default: None,
///         from_scene: FromScene::Never,
///         description: "The first number.".to_owned(),
///     }],
///     profiles: vec![],
///     mapping: None,
/// });
///
/// # struct Counter { channels: Vec<Channel>, next: f64 }
/// # impl Source for Counter {
/// #     fn channels(&self) -> &[Channel] { &self.channels }
/// #     fn rate_hz(&self) -> f64 { 1000.0 }
/// #     fn start(&mut self) -> Result<(), DeviceError> { Ok(()) }
/// #     fn read(&mut self, samples: &mut [f64], _: Duration) -> Result<Delivered, DeviceError> {
/// #         for sample in samples.iter_mut() {
/// #             *sample = self.next;
/// #             self.next += 1.0;
/// #         }
/// #         Ok(Delivered::Frames(samples.len()))
/// #     }
/// #     fn stop(&mut self) -> Result<(), DeviceError> { Ok(()) }
/// # }
/// #
/// struct Counters;
///
/// impl SourceAdapter for Counters {
///     fn descriptor(&self) -> &Descriptor {
///         &DESCRIPTOR
///     }
///
///     fn target(&self) -> &str {
///         "first"
///     }
///
///     fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
///         Ok(vec![])
///     }
///
///     fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError> {
///         let channels = vec![Channel::new("count", "")];
///         Ok(Box::new(Counter { channels, next: settings.number("first") }))
///     }
/// }
///
/// let given = BTreeMap::from([("first".to_owned(), "5".to_owned())]);
/// let mut source = Counters.open(&Settings::resolve(&DESCRIPTOR, None, &given)?)?;
/// source.start()?;
/// let mut samples = [0.0; 2];
/// assert_eq!(source.read(&mut samples, Duration::ZERO)?, Delivered::Frames(2));
/// assert_eq!(samples, [5.0, 6.0]);
/// # Ok::<(), DeviceError>(())
/// ```
///
/// # Limits
///
/// The host checks the rate, channels, counts and samples of a native library
/// ([`NativeSource`](crate::NativeSource)). It trusts a built-in source. `htex source check` tests
/// each guarantee of the ABI on either.
pub trait SourceAdapter: Send + Sync {
    /// Describes the adapter: id, name, settings and profiles. Returns the same at each call.
    /// `[any thread]`
    fn descriptor(&self) -> &Descriptor;

    /// Returns the name of the setting that chooses a source of the family, e.g. `channels` or
    /// `path`. `[any thread]`
    fn target(&self) -> &str;

    /// Lists the sources that are connected now. An empty list is not an error. `[any thread]`
    ///
    /// # Errors
    /// When a driver is missing: the message says what to install.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError>;

    /// Opens a source. It does not sample before [`Source::start`]. `[any thread]`
    ///
    /// # Errors
    /// When a setting is not usable, or the source is not connected.
    fn open(&self, settings: &Settings) -> Result<Box<dyn Source>, DeviceError>;
}

/// An open input source, which delivers frames of samples. Dropping it stops it.
///
/// The host asks for the channels and the rate, which never change, and calls [`Self::start`] once.
/// It then calls [`Self::read`] in a loop until it has enough or gets [`Delivered::End`], and calls
/// [`Self::stop`] or drops the source. Calls never overlap, but they may come from different
/// threads.
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
    /// Returns the channels, in the order of the samples within a frame. There is at least one.
    /// `[one thread at a time]`
    fn channels(&self) -> &[Channel];

    /// Returns the rate in frames per second, greater than 0. `[one thread at a time]`
    fn rate_hz(&self) -> f64;

    /// Starts sampling. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// When the source is in use or gone, or was stopped before.
    fn start(&mut self) -> Result<(), DeviceError>;

    /// Writes the available frames to `samples`, interleaved: one sample of each channel in turn.
    /// Waits up to `timeout` for the first frame. The length of `samples` is a multiple of the
    /// number of channels. No frame is lost between two calls. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// [`DeviceError::Overrun`] when frames were lost because they were read too late. Also when
    /// the source is gone, was not started, or has been stopped. After an error it delivers nothing
    /// more.
    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<Delivered, DeviceError>;

    /// Stops sampling for good. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// When stopping failed. The source delivers nothing more even then.
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
    /// Creates a channel from a name and a unit.
    #[must_use]
    pub fn new(name: impl Into<String>, unit: impl Into<String>) -> Self {
        Self { name: name.into(), unit: unit.into() }
    }
}

/// The result of reading from a source.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Delivered {
    /// The number of frames written to the buffer; 0 if none arrived within the timeout.
    Frames(usize),
    /// The source has ended, as a file does; there are no more frames.
    End,
}
