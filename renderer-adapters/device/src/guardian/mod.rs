//! The guardian: a second process that holds the output of a display that a finger touches. The
//! guardian ensures that no voltage stays at the output when the app's process ends, even if the
//! process crashes or is killed.
//!
//! A signal that kills or stops the app does not reach the guardian. The guardian is in its own
//! process group and receives no signals from the terminal's keys. When the pipe from the app
//! closes, the guardian plays the samples that are still in the device's buffer, sets the output to
//! zero, and exits. If the app hangs and the pipe stays open, the device's buffer becomes empty,
//! and the device then sets its output to zero by itself.
//!
//! If the guardian ends before the app, is stopped or hangs, the app kills it and starts another
//! process, which sets the output to zero. The module [`decision`] determines when and how the app
//! does this.
//!
//! An app opens a device as [`GuardedOutput`] if [`is_wanted`] returns true. The program that runs
//! in the guardian's process is the command `htex guard` ([`htex`]), or a program of the app that
//! calls [`hold`]. For devices that the command `htex` does not have, an app needs its own program.
//!
//! ```no_run
//! use std::time::Duration;
//! use htex_device::{AdapterEntry, DeviceError, Output, Settings, StreamFormat};
//! use htex_device::guardian::{GuardedOutput, htex, is_wanted};
//!
//! fn open(known: &AdapterEntry, settings: &Settings) -> Result<Box<dyn Output>, DeviceError> {
//!     let format = StreamFormat { rate_hz: 20_000.0, block_frames: 256 };
//!     Ok(match is_wanted(&known.adapter.capabilities(settings)?) {
//!         true => Box::new(GuardedOutput::open(known, settings, &format, htex())?),
//!         false => known.adapter.open_output(settings, &format)?,
//!     })
//! }
//! ```
#![forbid(unsafe_code)]

mod attempt;
pub mod decision;
mod guarded;
mod hold;
mod message;
mod worker;

pub use guarded::{GuardedOutput, htex, is_wanted, not_started};
pub use hold::hold;
pub use worker::{NOT_ZERO, is_unconfirmed};
