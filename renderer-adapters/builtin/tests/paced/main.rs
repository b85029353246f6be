//! Tests of devices that keep a clock. Their threads must be woken in time, so this program has no
//! tests with long computations.
#![allow(unreachable_pub, clippy::unwrap_used, unsafe_code, reason = "a failed test may panic")]

mod channels;
mod motor;
#[cfg(feature = "openxr")]
mod parametric_envelopes;
#[cfg(feature = "openxr")]
mod parametric_mock;
#[cfg(feature = "openxr")]
mod parametric_points;
#[cfg(feature = "openxr")]
mod parametric_rules;
#[cfg(target_os = "linux")]
mod sdl;
#[cfg(all(not(feature = "audio"), target_os = "linux"))]
mod with_alsa;
