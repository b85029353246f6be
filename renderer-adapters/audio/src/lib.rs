//! Sound cards: texture as sound, 1 is full scale.
//!
//! The adapter needs the feature `cpal`, which on Linux is built against ALSA (`libasound2-dev`).
//! Without it this crate is empty, so that a machine without ALSA builds all other crates.
//!
//! Samples wait in a ring of `buffer_ms`, and the sound card's own thread takes them from there
//! (`player.rs`): it takes no lock, does not allocate and does not wait. A ring that runs dry is
//! counted and fades to silence; playback goes on when samples come again.
#![forbid(unsafe_code)]

#[cfg(feature = "cpal")]
mod adapter;
#[cfg(feature = "cpal")]
mod card;
#[cfg(any(test, feature = "cpal"))]
mod player;
#[cfg(feature = "cpal")]
mod sound;

#[cfg(feature = "cpal")]
pub use adapter::Audio;
