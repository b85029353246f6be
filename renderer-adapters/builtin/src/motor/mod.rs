//! Devices that cannot play samples: motors and interfaces that take a strength and a frequency
//! some hundred times per second.
//!
//! An adapter implements [`Motor`], and [`PacedOutput`] makes an open device from it. The device takes
//! samples of sound and keeps them in a buffer. Its own thread passes them to the motor in blocks
//! in real time, each with its level and mean frequency. [`htex_dsp::envelope`] measures them in
//! the same way as for `Voice::envelope`, so a device needs no model.
//!
//! The motor is at rest before the first block, after the last one, after every error, when the
//! device is dropped, and when samples come too late. The thread stops the motor even if the writer
//! hangs.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod paced;
mod plan;
mod worker;

pub use paced::PacedOutput;
pub(crate) use plan::DEFAULT_GAIN;
pub use plan::{Plan, buffer_setting, has_usual_buffer, rate_error, reducing_settings};

use htex_dsp::envelope::Measurement;

/// A motor or interface that plays blocks. Implement this trait to add a device that cannot play
/// samples.
pub trait Motor: Send {
    /// Starts playing a block. The next block comes when this one is over.
    ///
    /// # Errors
    /// The reason, as a sentence. The motor is then stopped.
    fn play(&mut self, block: &Block<'_>) -> Result<(), String>;

    /// Stops after the last block, whose time is over. Waits until the motor is at rest.
    ///
    /// # Errors
    /// The reason, as a sentence.
    fn end(&mut self) -> Result<(), String>;

    /// Stops at once.
    ///
    /// # Errors
    /// The reason, as a sentence.
    fn stop(&mut self) -> Result<(), String>;

    /// Returns the time from [`Self::play`] until the block is output, seconds.
    fn delay_s(&self) -> f64 {
        0.0
    }
}

/// A block of samples with its measurements.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// The samples, at most 1 in magnitude. The last block may be shorter than the others.
    pub samples: &'a [f32],
    /// Their level and mean frequency.
    pub measured: Measurement,
}
