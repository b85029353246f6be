//! Sound cards as devices and sources: outputs play texture as sound, inputs are recorded. 1 is
//! full scale.
//!
//! The adapter needs the feature `cpal`, which on Linux is built against ALSA (`libasound2-dev`).
//! Without the feature this crate is empty, so that a machine without ALSA can build all other
//! crates.
//!
//! Samples wait in a ring buffer of `buffer_ms`. The sound card's own thread takes them from there
//! (`player.rs`). It takes no lock, does not allocate and does not wait. If the ring is empty, it
//! counts an underrun and fades to silence. Playback continues with the next samples.
//!
//! An input works the other way round (`listener.rs`): the card's thread puts samples into a ring
//! buffer of `buffer_s`. If the ring is full, that is an overrun, after which nothing is delivered.
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
