//! Devices that cannot play samples: motors and interfaces that take a strength and a frequency
//! about a hundred times per second.
//!
//! An adapter implements [`Motor`], and [`PacedOutput`] turns this implementation into an open
//! device. The device takes samples of sound and keeps them in a buffer. The device's own thread
//! passes the samples to the motor in real time, in blocks. Each block comes with its level and
//! mean frequency. The device measures level and mean frequency from the samples
//! ([`htex_dsp::envelope`]), so the device needs no model.
//!
//! The motor is at rest before the first block and after the last block. The thread also stops the
//! motor after every error, when the device is dropped, and when samples come too late. The motor
//! stops even if the thread that writes the samples hangs.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod paced;
mod plan;
mod worker;

pub use paced::PacedOutput;
#[cfg(feature = "openxr")]
pub(crate) use plan::DEFAULT_GAIN;
pub use plan::{Plan, buffer_setting, has_usual_buffer, rate_error, reducing_settings};

use htex_dsp::envelope::Measurement;

/// A motor or interface that plays blocks. Implement this trait to add a device that cannot play
/// samples.
pub trait Motor: Send {
    /// Starts to play a block. htex calls this function again when the duration of the block is
    /// over.
    ///
    /// # Errors
    /// The reason, as a sentence. The motor is then stopped.
    fn play(&mut self, block: &Block<'_>) -> Result<(), String>;

    /// Stops the motor after the last block. When the device makes this call, the duration of the
    /// last block is already over. Waits until the motor is at rest.
    ///
    /// # Errors
    /// The reason, as a sentence.
    fn end(&mut self) -> Result<(), String>;

    /// Stops at once.
    ///
    /// # Errors
    /// The reason, as a sentence.
    fn stop(&mut self) -> Result<(), String>;

    /// Returns the time from the call of [`Self::play`] until the motor plays the block, seconds.
    fn delay_s(&self) -> f64 {
        0.0
    }
}

/// A block of samples with its measurements.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// The samples, at most 1 in magnitude. The last block may be shorter than the others.
    pub samples: &'a [f32],
    /// The level and the mean frequency of the samples.
    pub measured: Measurement,
}
