//! The two traits.

use std::time::Duration;

use crate::abi::{
    STATUS_FRAMES_PLAYED, STATUS_FRAMES_WRITTEN, STATUS_LATENCY_S, STATUS_NUMBERS, STATUS_PEAK,
    STATUS_UNDERRUNS,
};
use crate::{Capabilities, Descriptor, DeviceError, Endpoint, Settings};

/// A family of devices.
pub trait Adapter: Send + Sync {
    /// The adapter's descriptor; the same at each call. `[any thread]`
    fn descriptor(&self) -> &Descriptor;

    /// The devices that are connected now; an empty list is not an error. `[any thread]`
    ///
    /// # Errors
    /// When a driver is missing: the message says what to install.
    fn endpoints(&self) -> Result<Vec<Endpoint>, DeviceError>;

    /// The capabilities of a device with these settings. Opens nothing. `[any thread]`
    ///
    /// # Errors
    /// When a setting is not usable, or the device is not connected.
    fn capabilities(&self, settings: &Settings) -> Result<Capabilities, DeviceError>;

    /// Opens a device, silent and at zero. `[any thread]`
    ///
    /// # Errors
    /// As [`Self::capabilities`], and when the device does not have the rate.
    fn open(
        &self,
        settings: &Settings,
        format: &StreamFormat,
    ) -> Result<Box<dyn Device>, DeviceError>;
}

/// An open device. Dropping it without [`Device::finish`] aborts: the output goes to zero, and a
/// file that was being written is not left behind.
pub trait Device: Send {
    /// Takes samples of the device's quantity, as many as fit within `timeout` (zero:
    /// those that fit now); returns their number. The first samples start the device.
    /// `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// When a sample is over the limit or not a number, when the device ran dry or is gone. The
    /// output is then at zero, and stays there.
    fn write(&mut self, samples: &[f32], timeout: Duration) -> Result<usize, DeviceError>;

    /// The counts so far. `[one thread at a time]`
    fn status(&self) -> Status;

    /// Plays what was written to its end, goes to zero, and keeps the result (a file appears under
    /// its name). Nothing can be written afterwards. `[one thread at a time; may wait]`
    ///
    /// # Errors
    /// When that failed; the output is at zero even then.
    fn finish(&mut self) -> Result<(), DeviceError>;
}

/// The stream a device is opened for: one channel; a device with several channels plays it on all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StreamFormat {
    /// Samples a second.
    pub rate_hz: f64,
    /// The size of the blocks that will be written, frames.
    pub block_frames: u32,
}

/// Counts since a device was opened.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Status {
    /// Frames taken.
    pub frames_written: u64,
    /// Frames that came out.
    pub frames_played: u64,
    /// Times the device ran dry.
    pub underruns: u64,
    /// Latency from writing a sample to its output, seconds.
    pub latency_s: f64,
    /// Largest magnitude written, in the device's unit.
    pub peak: f64,
}

/// The status as the ABI's numbers; counts are exact below 2⁵³.
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
            frames_written: numbers[STATUS_FRAMES_WRITTEN] as u64,
            frames_played: numbers[STATUS_FRAMES_PLAYED] as u64,
            underruns: numbers[STATUS_UNDERRUNS] as u64,
            latency_s: numbers[STATUS_LATENCY_S],
            peak: numbers[STATUS_PEAK],
        }
    }
}
