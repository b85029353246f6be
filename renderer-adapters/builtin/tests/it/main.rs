//! Integration tests, in one program.
#![allow(unreachable_pub, clippy::unwrap_used, unsafe_code, reason = "a failed test may panic")]

mod channels;
#[cfg(feature = "daq")]
mod daq;
#[cfg(feature = "daq")]
mod daq_faults;
#[cfg(feature = "daq")]
mod daq_input;
#[cfg(feature = "daq")]
mod daq_simulated;
mod file;
mod motor;
mod parametric_envelopes;
mod parametric_mock;
mod parametric_points;
mod parametric_rules;
#[cfg(target_os = "linux")]
mod sdl;
#[cfg(all(not(feature = "audio"), target_os = "linux"))]
mod with_alsa;
