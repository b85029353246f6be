//! Tests of devices on simulated drivers, in one program.
#![allow(unreachable_pub, clippy::unwrap_used, unsafe_code, reason = "a failed test may panic")]

#[cfg(feature = "daq")]
mod daq;
#[cfg(feature = "daq")]
mod daq_faults;
#[cfg(feature = "daq")]
mod daq_input;
#[cfg(feature = "daq")]
mod daq_simulated;
mod file;
