//! Devices that cannot play samples: motors and interfaces that are told a strength and a frequency
//! some hundred times a second.
//!
//! An adapter implements [`Motor`], and [`Paced`] makes an open device of it: it takes samples of
//! sound, keeps them in a buffer, and a thread of its own hands them over by blocks at the pace of
//! the clock, each with its level and mean frequency. They are measured by [`htex_dsp::envelope`],
//! as those of `Voice::envelope` are, so that a device needs no model.
//!
//! The motor is at rest before the first block, after the last one, after every error, when the
//! device is dropped, and when samples come too late: the thread stops it even if the writer hangs.
#![forbid(unsafe_code)]
#![warn(missing_docs)]

mod paced;
mod plan;
mod worker;

pub use paced::Paced;
pub use plan::{
    DEFAULT_GAIN, Plan, buffer_setting, has_usual_buffer, number, rate_error, reducing_settings,
    setting,
};

use htex_dsp::envelope::Measured;

/// What plays blocks.
pub trait Motor: Send {
    /// Plays a block from now on; the next one comes when it is over.
    ///
    /// # Errors
    /// The reason, as a sentence; the motor is then stopped.
    fn play(&mut self, block: &Block<'_>) -> Result<(), String>;

    /// Comes to rest after the last block, whose time is over; waits until that is so.
    ///
    /// # Errors
    /// The reason, as a sentence.
    fn end(&mut self) -> Result<(), String>;

    /// Comes to rest at once.
    ///
    /// # Errors
    /// The reason, as a sentence.
    fn stop(&mut self) -> Result<(), String>;

    /// Time from [`Self::play`] until a block comes out, seconds.
    fn delay_s(&self) -> f64 {
        0.0
    }
}

/// A block of samples, and what was measured of it.
#[derive(Debug, Clone, Copy)]
pub struct Block<'a> {
    /// The samples, at most 1 in magnitude; the last block may be shorter than the others.
    pub samples: &'a [f32],
    /// Their level and mean frequency.
    pub measured: Measured,
}
