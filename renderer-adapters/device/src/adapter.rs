//! The traits that a device implements.

use std::time::Duration;

use crate::abi::{
    STATUS_FRAMES_PLAYED, STATUS_FRAMES_WRITTEN, STATUS_LATENCY_S, STATUS_NUMBERS, STATUS_PEAK,
    STATUS_UNDERRUNS,
};
use crate::{Capabilities, Descriptor, DeviceError, Direction, Endpoint, InputStream, Settings};

/// A family of devices, such as all sound cards. Implement this trait to add a device.
///
/// An adapter describes its devices and opens them. All devices of an adapter have the same
/// direction ([`Descriptor::direction`]). An adapter has either outputs, which play samples, or
/// inputs, which record samples. An adapter implements the methods of its direction. By default,
/// the methods of the other direction return [`DeviceError::Direction`].
///
/// | direction | implement, besides [`Self::descriptor`] and [`Self::endpoints`] |
/// |---|---|
/// | output | [`Self::capabilities`] and [`Self::open_output`], which returns an [`Output`] |
/// | input | [`Self::open_input`], which returns an [`Input`] |
///
/// # How the host calls it
///
/// - A program creates the adapter once and shares it between threads, so the methods take `&self`
///   and may run at the same time.
/// - [`Self::descriptor`] is called first. In later calls, the host passes only settings that this
///   descriptor lists.
/// - The host calls [`Self::endpoints`] to list the hardware, e.g. in `htex device list`.
/// - The host calls [`Self::capabilities`] before it opens an output. From the capabilities, the
///   host chooses the rate and the block size.
/// - The host calls [`Self::open_output`] or [`Self::open_input`] last. The open device may move to
///   another thread.
///
/// An adapter receives complete [`Settings`]: the host has applied the profile and the defaults,
/// and has checked each value against its [`SettingKind`](crate::SettingKind). An adapter has to
/// check only conditions that depend on several settings or on the hardware. On the command line,
/// `NAME:TARGET` (e.g. `daq:Dev1/ai0`) selects one device: `TARGET` becomes the value of the
/// setting that [`Descriptor::target`] names.
///
/// To build a native library from an adapter, derive `Default` and call
/// [`export_device!`](crate::export_device). The macro turns errors into status codes and catches
/// panics.
///
/// # Example: an output
///
/// A meter that plays nothing and remembers the largest force:
///
/// ```
/// use std::collections::BTreeMap;
/// use std::sync::LazyLock;
/// use std::time::Duration;
/// use htex_device::{
///     Adapter, Capabilities, Descriptor, DeviceError, Endpoint, Output, Quantity, Rates, Settings,
///     Status, StreamFormat,
/// };
///
/// static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
///     id: "org.example.meter".to_owned(),
///     name: "Meter".to_owned(),
///     version: "1.0.0".to_owned(),
///     summary: "Keeps the largest force.".to_owned(),
///     ..Descriptor::default()
/// });
///
/// struct Meter;
///
/// impl Adapter for Meter {
///     fn descriptor(&self) -> &Descriptor {
///         &DESCRIPTOR
///     }
///
///     fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
///         Ok(vec![])
///     }
///
///     fn capabilities(&self, _: &Settings) -> Result<Capabilities, DeviceError> {
///         Ok(Capabilities {
///             quantity: Quantity::LateralForce,
///             rates: Rates::Range { min_hz: 1_000.0, max_hz: 50_000.0 },
///             default_rate_hz: 20_000.0,
///             limit: Some(2.0),
///             step: None,
///             carrier_hz: None,
///             paced: false,
///             block_frames: 256,
///         })
///     }
///
///     fn open_output(
///         &self,
///         settings: &Settings,
///         format: &StreamFormat,
///     ) -> Result<Box<dyn Output>, DeviceError> {
///         let capabilities = self.capabilities(settings)?;
///         if !capabilities.has_rate(format.rate_hz) {
///             return Err(DeviceError::Rate {
///                 device: "meter".to_owned(),
///                 rate_hz: format.rate_hz,
///                 rates: capabilities.rates_text(),
///             });
///         }
///         Ok(Box::new(OpenMeter { capabilities, status: Status::default(), is_open: true }))
///     }
/// }
///
/// struct OpenMeter {
///     capabilities: Capabilities,
///     status: Status,
///     is_open: bool,
/// }
///
/// impl OpenMeter {
///     fn check_open(&self) -> Result<(), DeviceError> {
///         if self.is_open { Ok(()) } else { Err(DeviceError::Closed("meter".to_owned())) }
///     }
/// }
///
/// impl Output for OpenMeter {
///     fn write(&mut self, samples: &[f32], _: Duration) -> Result<usize, DeviceError> {
///         self.check_open()?;
///         // All samples are checked before any is taken. After an error the device stays closed.
///         let checked = self.capabilities.check_samples(samples, self.status.frames_written);
///         self.is_open = checked.is_ok();
///         checked?;
///         for sample in samples {
///             self.status.peak = self.status.peak.max(f64::from(sample.abs()));
///         }
///         self.status.frames_written += samples.len() as u64;
///         self.status.frames_played = self.status.frames_written;
///         Ok(samples.len())
///     }
///
///     fn status(&self) -> Status {
///         self.status
///     }
///
///     fn finish(&mut self) -> Result<(), DeviceError> {
///         self.check_open()?;
///         self.is_open = false;
///         Ok(())
///     }
/// }
///
/// let settings = Settings::resolve(&DESCRIPTOR, None, &BTreeMap::new())?;
/// let format = StreamFormat { rate_hz: 20_000.0, block_frames: 256 };
/// let mut output = Meter.open_output(&settings, &format)?;
/// assert_eq!(output.write(&[0.5, -1.5], Duration::ZERO)?, 2);
/// assert!(output.write(&[2.5], Duration::ZERO).is_err());
/// assert_eq!(output.status().peak, 1.5);
/// # Ok::<(), DeviceError>(())
/// ```
///
/// # Example: an input
///
/// A counter, with a setting for the first number:
///
/// ```
/// use std::collections::BTreeMap;
/// use std::sync::LazyLock;
/// use std::time::Duration;
/// use htex_device::{
///     Adapter, Channel, Descriptor, DeviceError, Direction, Endpoint, Input, InputFrames,
///     InputStream, Setting, SettingKind, Settings,
/// };
///
/// static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| {
///     let numbers = SettingKind::Number { min: 0.0, max: 1_000.0 };
///     Descriptor {
///         id: "org.example.counter".to_owned(),
///         name: "Counter".to_owned(),
///         version: "1.0.0".to_owned(),
///         summary: "Counts up from a number.".to_owned(),
///         direction: Direction::Input,
///         target: Some("first".to_owned()),
///         settings: vec![Setting::new("first", numbers, "The first number.").with_default("0")],
///         ..Descriptor::default()
///     }
/// });
///
/// struct Counter;
///
/// impl Adapter for Counter {
///     fn descriptor(&self) -> &Descriptor {
///         &DESCRIPTOR
///     }
///
///     fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError> {
///         Ok(vec![])
///     }
///
///     fn open_input(&self, settings: &Settings) -> Result<Box<dyn Input>, DeviceError> {
///         let stream = InputStream { rate_hz: 1_000.0, channels: vec![Channel::new("count", "")] };
///         let next = settings.number("first");
///         Ok(Box::new(OpenCounter { stream, next, is_started: false }))
///     }
/// }
///
/// struct OpenCounter {
///     stream: InputStream,
///     next: f64,
///     is_started: bool,
/// }
///
/// impl Input for OpenCounter {
///     fn stream(&self) -> &InputStream {
///         &self.stream
///     }
///
///     fn start(&mut self) -> Result<(), DeviceError> {
///         self.is_started = true;
///         Ok(())
///     }
///
///     fn read(&mut self, samples: &mut [f64], _: Duration) -> Result<InputFrames, DeviceError> {
///         if !self.is_started {
///             return Err(DeviceError::Closed("counter".to_owned()));
///         }
///         for sample in samples.iter_mut() {
///             *sample = self.next;
///             self.next += 1.0;
///         }
///         Ok(InputFrames::Count(samples.len()))
///     }
///
///     fn finish(&mut self) -> Result<(), DeviceError> {
///         self.is_started = false;
///         Ok(())
///     }
/// }
///
/// let given = BTreeMap::from([("first".to_owned(), "5".to_owned())]);
/// let mut input = Counter.open_input(&Settings::resolve(&DESCRIPTOR, None, &given)?)?;
/// input.start()?;
/// let mut samples = [0.0; 2];
/// assert_eq!(input.read(&mut samples, Duration::ZERO)?, InputFrames::Count(2));
/// assert_eq!(samples, [5.0, 6.0]);
/// # Ok::<(), DeviceError>(())
/// ```
///
/// # Limits
///
/// - An output has one stream of samples of one quantity at one rate. If a device has several
///   channels, its adapter needs a setting that determines what each channel plays.
/// - An output that plays display voltages at the pace of a clock must keep their mean within
///   [`DirectVoltage`](crate::DirectVoltage). For a native library, the host checks the mean
///   voltage. A built-in adapter must itself check the mean voltage.
/// - The host checks the rate, channels, counts and samples of an input from a native library
///   ([`NativeInput`](crate::NativeInput)). The host does not check a built-in input.
/// - The adapter must check everything else. `htex device check` tests each guarantee of the ABI on
///   a native library or a built-in adapter.
pub trait Adapter: Send + Sync {
    /// Describes the adapter: id, name, direction, settings and profiles. Every call returns the
    /// same descriptor. `[any thread]`
    fn descriptor(&self) -> &Descriptor;

    /// Lists the devices that are connected now. An empty list is not an error. `[any thread]`
    ///
    /// # Errors
    /// Returns an error if a driver is missing. The message names the software to install.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError>;

    /// Reports what an output with these settings can do, without opening it. `[any thread]`
    ///
    /// # Errors
    /// Returns an error if a setting is not usable, or the device is not connected. Returns
    /// [`DeviceError::Direction`] if the adapter has inputs.
    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError> {
        let _ = settings;
        Err(is_not(self.descriptor(), Direction::Output))
    }

    /// Opens an output. The output is silent and at zero until the first write. `[any thread]`
    ///
    /// # Errors
    /// Returns the same errors as [`Self::capabilities`]. Also returns an error if the device does
    /// not support the rate.
    fn open_output(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Output>, DeviceError> {
        let _ = (settings, format);
        Err(is_not(self.descriptor(), Direction::Output))
    }

    /// Opens an input. The input does not sample before [`Input::start`]. `[any thread]`
    ///
    /// # Errors
    /// Returns an error if a setting is not usable, or the device is not connected. Returns
    /// [`DeviceError::Direction`] if the adapter has outputs.
    fn open_input(&self, settings: &Settings) -> Result<Box<dyn Input>, DeviceError> {
        let _ = settings;
        Err(is_not(self.descriptor(), Direction::Input))
    }
}

fn is_not(descriptor: &Descriptor, wanted: Direction) -> DeviceError {
    DeviceError::Direction { device: descriptor.name.clone(), wanted }
}

/// An open output, which takes samples and plays them.
///
/// The host calls [`Self::write`] in a loop, usually with blocks of [`StreamFormat::block_frames`].
/// If the output takes only a part of a block, the host passes the rest of the block in the next
/// call. At the end, the host calls [`Self::finish`]. Calls never overlap, but they may come from
/// different threads.
///
/// An output that is dropped without [`Self::finish`] aborts: it goes to zero at once, and removes
/// an unfinished file. The drop may happen at any time, even after an error.
///
/// An output with a clock needs its own thread or driver, because the output must go to zero even
/// if the host hangs and writes no more samples.
///
/// # Known doubts
///
/// - [`Status::latency_s`] is the device's own estimate. The host does not measure it.
/// - If samples come too late, an electrovibration display must return [`DeviceError::Underflow`]
///   and stay at zero. Other outputs may continue. For example, the built-in sound card fades to
///   silence and counts an underrun. A host sees this underrun only in [`Status::underruns`].
///
/// [`Adapter`] has a complete example.
pub trait Output: Send {
    /// Takes as many samples as the output has space for within `timeout`, and returns their
    /// number. With a timeout of zero, it takes only as many samples as it has space for now, and
    /// does not wait. The host may pass any number of samples, including none. The first samples
    /// start the output. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// Returns an error if a sample is over the limit or not a number, if the output ran out of
    /// samples, or if the device is gone. After an error the output is at zero and stays there.
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError>;

    /// Returns the counts since the device was opened. Works after an error.
    /// `[one thread at a time]`
    fn status(&self) -> Status;

    /// Plays all written samples, goes to zero and keeps the result (e.g. gives a file its final
    /// name). Nothing can be written afterwards. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// Returns an error if one of these steps failed. The output is at zero even then.
    fn finish(&mut self) -> Result<(), DeviceError>;
}

/// An open input, which delivers frames of samples. Dropping an input stops it.
///
/// The host reads [`Self::stream`] and calls [`Self::start`] once. The host then calls
/// [`Self::read`] in a loop until it has enough frames or receives [`InputFrames::End`]. Finally,
/// the host calls [`Self::finish`] or drops the input. Calls never overlap, but they may come from
/// different threads.
///
/// [`Adapter`] has a complete example.
pub trait Input: Send {
    /// Returns the rate and the channels, in the order of the samples within a frame. Rate and
    /// channels never change. `[one thread at a time]`
    fn stream(&self) -> &InputStream;

    /// Starts sampling. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// Returns an error if the device is in use or gone, or was finished before.
    fn start(&mut self) -> Result<(), DeviceError>;

    /// Writes the available frames to `samples`, interleaved: one sample of each channel in turn.
    /// Waits up to `timeout` for the first frame. The length of `samples` is a multiple of the
    /// number of channels. No frame is lost between two calls. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// Returns [`DeviceError::Overrun`] if the input lost frames because the host read them too
    /// late. Also returns an error if the device is gone, was not started, or has been finished.
    /// After an error the input delivers nothing more.
    fn read(&mut self, samples: &mut [f64], timeout: Duration) -> Result<InputFrames, DeviceError>;

    /// Stops sampling for good. The input may already have stopped. `[one thread at a time; may
    /// wait]`
    ///
    /// # Errors
    /// Returns an error if stopping failed. The input delivers nothing more even then.
    fn finish(&mut self) -> Result<(), DeviceError>;
}

/// The result of reading from an input.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum InputFrames {
    /// The number of frames written to the buffer; 0 if no frame arrived within the timeout.
    Count(usize),
    /// The input has ended (e.g. at the end of a file); there are no more frames.
    End,
}

/// The sample rate and block size with which an output is opened. The stream has one channel. A
/// device with several channels plays the stream on all channels, unless its settings select
/// channels.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamFormat {
    /// Sample rate, hertz.
    pub rate_hz: f64,
    /// Usual number of frames in a write.
    pub block_frames: u32,
}

/// Counts since an output was opened.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Status {
    /// Number of frames that the output has accepted.
    pub frames_written: u64,
    /// Number of frames that have been played.
    pub frames_played: u64,
    /// Number of underruns, i.e. how often the output ran out of samples.
    pub underruns: u64,
    /// Latency from writing a sample to playing it, seconds.
    pub latency_s: f64,
    /// Largest magnitude of a sample that the output has accepted, in the device's unit.
    pub peak: f64,
}

/// Converts a status to the numbers of the ABI. Counts are exact below 2⁵³.
impl From<Status> for [f64; STATUS_NUMBERS] {
    fn from(status: Status) -> Self {
        let mut numbers = [0.0; STATUS_NUMBERS];
        numbers[STATUS_FRAMES_WRITTEN] = status.frames_written as f64;
        numbers[STATUS_FRAMES_PLAYED] = status.frames_played as f64;
        numbers[STATUS_UNDERRUNS] = status.underruns as f64;
        numbers[STATUS_LATENCY_S] = status.latency_s;
        numbers[STATUS_PEAK] = status.peak;
        numbers
    }
}

impl From<[f64; STATUS_NUMBERS]> for Status {
    fn from(numbers: [f64; STATUS_NUMBERS]) -> Self {
        Self {
            // `as` turns NaN and negative numbers of a faulty library into 0.
            frames_written: numbers[STATUS_FRAMES_WRITTEN] as u64,
            frames_played: numbers[STATUS_FRAMES_PLAYED] as u64,
            underruns: numbers[STATUS_UNDERRUNS] as u64,
            latency_s: numbers[STATUS_LATENCY_S],
            peak: numbers[STATUS_PEAK],
        }
    }
}
