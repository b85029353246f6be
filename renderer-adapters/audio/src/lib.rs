//! Sound cards: texture as sound, and their inputs as a source; 1 is full scale.
//!
//! The adapter needs the feature `cpal`, which on Linux is built against ALSA (`libasound2-dev`).
//! Without it this crate is empty, so that a machine without ALSA builds all other crates.
//!
//! Samples wait in a ring of `buffer_ms`, and the sound card's own thread takes them from there
//! (`player.rs`): it takes no lock, does not allocate and does not wait. An empty ring is
//! counted as an underrun and fades to silence; playback continues with the next samples.
//!
//! An input is the reverse (`listener.rs`): the card's thread puts samples into a ring of
//! `buffer_s`. A full ring is an overrun, after which nothing is delivered.
#![forbid(unsafe_code)]

#[cfg(feature = "cpal")]
mod adapter;
#[cfg(feature = "cpal")]
mod card;
#[cfg(feature = "cpal")]
mod channels;
#[cfg(feature = "cpal")]
mod failure;
#[cfg(feature = "cpal")]
mod input;
#[cfg(any(test, feature = "cpal"))]
mod listener;
#[cfg(any(test, feature = "cpal"))]
mod player;
#[cfg(feature = "cpal")]
mod recorder;
#[cfg(feature = "cpal")]
mod sound;

#[cfg(feature = "cpal")]
pub use adapter::Audio;
#[cfg(feature = "cpal")]
pub use channels::{capabilities_of_channels, open_channels, outputs};
#[cfg(feature = "cpal")]
pub use input::AudioInput;
