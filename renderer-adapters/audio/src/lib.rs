//! Sound cards: texture as sound, 1 is full scale.
//!
//! The adapter needs the feature `cpal`, which on Linux is built against ALSA (`libasound2-dev`).
//! Without it this crate is empty, so that a machine without ALSA builds all other crates.
//!
//! Samples wait in a ring of `buffer_ms`, and the sound card's own thread takes them from there
//! (`player.rs`): it takes no lock, does not allocate and does not wait. An empty ring is
//! counted as an underrun and fades to silence; playback continues with the next samples.
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
