//! Sound cards: outputs play texture as sound, inputs are recorded. 1 is
//! full scale.
//!
//! The adapters need the feature `audio`, which on Linux is built against ALSA (`libasound2-dev`).
//! Without it a machine without ALSA can build everything else, and test the buffers.
//!
//! Samples wait in a ring buffer of `buffer_ms`. The sound card's own thread takes them from there
//! (`player.rs`). It takes no lock, does not allocate and does not wait. If the ring is empty, it
//! counts an underrun and fades to silence. Playback continues with the next samples.
//!
//! An input works the other way round (`listener.rs`): the card's thread puts samples into a ring
//! buffer of `buffer_s`. If the ring is full, that is an overrun, after which nothing is delivered.
#![forbid(unsafe_code)]

#[cfg(feature = "audio")]
mod adapter;
#[cfg(feature = "audio")]
mod card;
#[cfg(feature = "audio")]
mod channels;
#[cfg(feature = "audio")]
mod failure;
#[cfg(feature = "audio")]
mod input;
mod listener;
mod player;
#[cfg(feature = "audio")]
mod recorder;
#[cfg(feature = "audio")]
mod sound;

#[cfg(feature = "audio")]
pub use adapter::Audio;
#[cfg(feature = "audio")]
pub use channels::{capabilities_of_channels, open_channels, outputs};
#[cfg(feature = "audio")]
pub use input::AudioInput;
