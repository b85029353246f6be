//! Sound cards: their outputs play textures as sound, and their inputs record. In the samples, 1 is
//! full scale.
//!
//! The adapters need the feature `audio`. On Linux, building this feature needs ALSA
//! (`libasound2-dev`). Without the feature, the rest of the crate builds without ALSA, and the
//! buffers of this module can still be tested.
//!
//! Samples for an output wait in a ring buffer of `buffer_ms`. The sound card's own thread takes
//! the samples from this buffer (`player.rs`). The thread does not lock, allocate or wait. If the
//! ring buffer is empty, the thread counts an underrun and fades to silence. Playback continues as
//! soon as new samples arrive.
//!
//! For an input, the card's thread puts samples into a ring buffer of `buffer_s` (`listener.rs`). A
//! full ring buffer is an overrun. After an overrun, the input delivers nothing more.
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
