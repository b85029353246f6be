//! The guardian: a second process that holds the output of a display that a finger touches. No
//! voltage stays at the output, however the first process ends.
//!
//! A signal that kills, stops or hangs the app reaches only the app. The guardian is in its own
//! process group and receives no signals from the terminal's keys. When the pipe from the app
//! closes, the guardian plays the samples it still has (at most the device's buffer), sets the
//! output to zero, and exits. A device whose buffer runs dry sets its output to zero by itself.
//!
//! If the guardian ends first, is stopped or hangs, the app kills it and starts a second helper
//! process, which sets the output to zero. [`decision`] decides when and how.
//!
//! An app opens a device as [`GuardedOutput`] if [`is_wanted`] says so. The helper program is the
//! command `htex guard` ([`htex`]), or a program of the app that calls [`hold`]. An app needs its
//! own helper program for devices that the command `htex` does not have.
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
