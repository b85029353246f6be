//! The traits of output devices.

use std::time::Duration;

use crate::abi::{
    STATUS_FRAMES_PLAYED, STATUS_FRAMES_WRITTEN, STATUS_LATENCY_S, STATUS_NUMBERS, STATUS_PEAK,
    STATUS_UNDERRUNS,
};
use crate::{Capabilities, Descriptor, DeviceError, Endpoint, Settings};

/// A family of output devices, such as all sound cards. Implement this trait to add a device.
///
/// An adapter describes its devices and opens them. The open [`Device`] then takes the samples.
///
/// # How the host calls it
///
/// - A program creates the adapter once and shares it between threads, so the methods take `&self`
///   and may run at the same time.
/// - [`Self::descriptor`] is called first: the settings of all other calls follow from it.
/// - [`Self::endpoints`] is called to list the hardware, e.g. by `htex device list`.
/// - [`Self::capabilities`] is called before every opening: the host chooses the rate and the block
///   size from it.
/// - [`Self::open`] is called last. The device that it returns may move to another thread.
///
/// The [`Settings`] are complete when they arrive: profile and defaults are applied, and each value
/// is allowed by its [`SettingKind`](crate::SettingKind). An adapter checks only what depends on
/// several settings or on the hardware.
///
/// To build a native library from an adapter, derive `Default` and call
/// [`export_device!`](crate::export_device). The macro turns errors into status codes and catches
/// panics.
///
/// # Example
///
/// A meter that plays nothing and keeps the largest force:
///
/// ```
/// use std::collections::BTreeMap;
/// use std::sync::LazyLock;
/// use std::time::Duration;
/// use htex_device::{
///     Adapter, Capabilities, Descriptor, Device, DeviceError, Endpoint, Quantity, Rates, Settings,
///     Status, StreamFormat,
/// };
///
/// static DESCRIPTOR: LazyLock<Descriptor> = LazyLock::new(|| Descriptor {
///     id: "org.example.meter".to_owned(),
///     name: "Meter".to_owned(),
///     version: "1.0.0".to_owned(),
///     summary: "Keeps the largest force.".to_owned(),
///     settings: vec![],
///     profiles: vec![],
///     mapping: None,
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
///     fn open(
///         &self,
///         settings: &Settings,
///         format: &StreamFormat,
///     ) -> Result<Box<dyn Device>, DeviceError> {
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
/// impl Device for OpenMeter {
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
/// let mut device = Meter.open(&settings, &format)?;
/// assert_eq!(device.write(&[0.5, -1.5], Duration::ZERO)?, 2);
/// assert!(device.write(&[2.5], Duration::ZERO).is_err());
/// assert_eq!(device.status().peak, 1.5);
/// # Ok::<(), DeviceError>(())
/// ```
///
/// # Limits
///
/// - A device has one stream of samples of one quantity at one rate. Devices with several channels
///   choose what each channel plays by a setting of their own.
/// - A paced device of display voltage must keep its mean voltage within
///   [`DirectVoltage`](crate::DirectVoltage). The host checks this for native libraries; a built-in
///   adapter checks it itself.
/// - Everything else is checked by the adapter: `htex device check` tests each guarantee of the ABI
///   on a native library or a built-in adapter.
pub trait Adapter: Send + Sync {
    /// Describes the adapter: id, name, settings and profiles. Returns the same at each call.
    /// `[any thread]`
    fn descriptor(&self) -> &Descriptor;

    /// Lists the devices that are connected now. An empty list is not an error. `[any thread]`
    ///
    /// # Errors
    /// When a driver is missing: the message says what to install.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError>;

    /// Reports what a device with these settings can do, without opening it. `[any thread]`
    ///
    /// # Errors
    /// When a setting is not usable, or the device is not connected.
    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError>;

    /// Opens a device. Its output is silent and at zero until the first write. `[any thread]`
    ///
    /// # Errors
    /// The errors of [`Self::capabilities`], and when the device does not support the rate.
    fn open(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Device>, DeviceError>;
}

/// An open output device, which takes samples and plays them.
///
/// The host calls [`Self::write`] in a loop, usually with blocks of [`StreamFormat::block_frames`],
/// and offers the rest again when the device takes only a part. It calls [`Self::finish`] at the
/// end. Calls never overlap, but they may come from different threads.
///
/// Dropping a device without [`Device::finish`] aborts: the output goes to zero at once, and an
/// unfinished file is removed. The drop may happen at any time, also after an error.
///
/// A device with a clock needs a thread or a driver of its own, because its output must go to zero
/// even if the host hangs and writes no more samples.
///
/// # Known doubts
///
/// - [`Status::latency_s`] is the device's own estimate. The host does not measure it.
/// - A device that runs dry returns [`DeviceError::Underflow`] and stays at zero, as the ABI
///   demands. The built-in sound card is an exception: it fades to silence, counts an underrun and
///   continues.
///
/// [`Adapter`] has a complete example.
pub trait Device: Send {
    /// Takes as many samples as fit within `timeout` and returns their number. With a timeout of
    /// zero, it takes what fits now and does not wait. Any number of samples may be offered,
    /// including none. The first samples start the device. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// When a sample is over the limit or not a number, and when the device ran dry or is gone. The
    /// output is then at zero, and stays there.
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError>;

    /// Returns the counts since the device was opened. Works after an error.
    /// `[one thread at a time]`
    fn status(&self) -> Status;

    /// Plays all written samples, goes to zero and keeps the result (e.g. a file appears under its
    /// name). Nothing can be written afterwards. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// When one of these steps failed. The output is at zero even then.
    fn finish(&mut self) -> Result<(), DeviceError>;
}

/// The format of the stream that a device is opened for. It has one channel: a device with several
/// channels plays it on all of them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamFormat {
    /// Sample rate, hertz.
    pub rate_hz: f64,
    /// Block size of the writes to come, frames.
    pub block_frames: u32,
}

/// Counts since a device was opened.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Status {
    /// Number of frames the device took.
    pub frames_written: u64,
    /// Number of frames that were output.
    pub frames_played: u64,
    /// How often the device ran dry.
    pub underruns: u64,
    /// Time from writing a sample to its output, seconds.
    pub latency_s: f64,
    /// Largest magnitude written, in the device's unit.
    pub peak: f64,
}

/// The status as the numbers of the ABI. Counts are exact below 2⁵³.
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
