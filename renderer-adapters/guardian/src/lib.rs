//! A second process that holds the output of a display which a finger touches, so that no end of
//! the first one leaves a voltage there.
//!
//! A signal that kills, stops or hangs the app reaches only the app: the guardian is in a process
//! group of its own, receives no signals of the terminal's keys, and ends when its pipe does. It
//! then plays what it has (at most the device's buffer), sets the output to zero, and exits; a
//! device whose buffer runs dry sets its output to zero itself.
//!
//! If the guardian ends first, is stopped or hangs, the app kills it and starts a second helper
//! process, which sets the output to zero. When and how is decided in [`decision`].
//!
//! An app opens a device as [`Guarded`] where [`is_wanted`] says so. The helper program is
//! [`htex`], or one of the app's own, which calls [`hold`]: it is needed for devices that `htex`
//! does not have.
//!
//! ```no_run
//! use std::time::Duration;
//! use htex_device::{Device, DeviceError, KnownDevice, Settings, StreamFormat};
//! use htex_device_guardian::{Guarded, htex, is_wanted};
//!
//! fn open(known: &KnownDevice, settings: &Settings) -> Result<Box<dyn Device>, DeviceError> {
//!     let format = StreamFormat { rate_hz: 20_000.0, block_frames: 256 };
//!     Ok(match is_wanted(&known.adapter.capabilities(settings)?) {
//!         true => Box::new(Guarded::open(known, settings, &format, htex())?),
//!         false => known.adapter.open(settings, &format)?,
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

pub use guarded::{Guarded, htex, is_wanted, not_started};
pub use hold::hold;
pub use worker::{NOT_ZERO, is_unconfirmed};
