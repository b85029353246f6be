//! Textures of touch: opens texture files and plays them at the speed and force of a finger.
//!
//! ```no_run
//! use htex::{Motion, Texture, VoiceOptions};
//! let texture = Texture::open("sandpaper.htex")?;
//! let mut voice = texture.voice(&VoiceOptions::default())?;
//! let mut block = [0.0f32; 256];
//! voice.set_motion(Motion::new(80.0, 0.4))?; // mm/s and newtons, neither of them negative
//! voice.render(&mut block)?; // in the texture's unit
//! # Ok::<(), htex::Error>(())
//! ```
//!
//! [`Voice::render`] allocates no memory, takes no locks and does not access files, so it may run
//! in an audio thread. A [`Voice`] is [`Send`], so one thread can make the voice and another thread
//! can render it. Call [`Voice::set_motion`] once per block of 1 to 10 ms. Longer blocks lag behind
//! the finger. Shorter blocks need more computation without a benefit, because a voice takes 10 ms
//! to reach a new spectrum and level.
//!
//! # On a sound card
//!
//! Samples are in the texture's unit: a few millinewtons RMS for a force. A sound card expects
//! samples from -1 to 1, so set a gain and a limit:
//!
//! ```no_run
//! use htex::{Texture, VoiceOptions};
//! let texture = Texture::open("sandpaper.htex")?;
//! let options = VoiceOptions::default()
//!     .with_rate_hz(48_000.0) // the card's rate
//!     .with_gain(0.1 / texture.level_rms(None)?) // an RMS of 0.1 at the default condition
//!     .with_limit(0.9);
//! let mut voice = texture.voice(&options)?;
//! # Ok::<(), htex::Error>(())
//! ```
//!
//! The example `live` is a complete program with a sound card and a ring buffer of commands.
//!
//! # Features
//!
//! | feature | default | adds |
//! |---|---|---|
//! | `wasm` | yes | models that are embedded in textures, in a sandbox |
//! | `write` | yes | `format::Asset::write` and `to_bytes` |
//! | `schemas` | yes | JSON Schemas of manifests and scenes: `format::manifest_schema`, `scene::scene_schema` |
//! | `author` | | `author`: makes textures from recordings, and simulates recordings |
//! | `library` | | `library`: files with thousands of textures; `Texture::from_library` |
//! | `storage` | | `library::storage`: files by path or URI; `Library::open_located` |
//! | `cloud` | | web servers and object stores for `storage` |
//! | `scene` | | `Scene` and `scene`: plans and renders scenes; `device`: plays them |
//! | `audio` | | nothing to the library; the example `live` can then use a sound card |
//!
//! A program without the feature `wasm` is smaller, but plays only representations of built-in
//! models.
#![warn(missing_docs)]
#![forbid(unsafe_code)]
#![cfg_attr(docsrs, feature(doc_cfg))]

#[cfg(feature = "author")]
pub use htex_author as author;
#[cfg(feature = "scene")]
pub use htex_device as device;
/// The `.htex` file: types, reading, writing and validation.
pub use htex_format as format;
/// Opens and plays textures. The main types are also at the root of this crate.
pub use htex_play as play;
pub use htex_play::{Error, Motion, Registry, Representation, Texture, Voice, VoiceOptions};
#[cfg(feature = "scene")]
pub use htex_scene as scene;
#[cfg(feature = "scene")]
pub use htex_scene::Scene;

/// Models: finding, loading and calling them ([`Registry`]), and the traits to implement for a
/// model of your own ([`ShapedModel`], [`Model`]).
///
/// [`ShapedModel`]: model::ShapedModel
/// [`Model`]: model::Model
pub mod model {
    pub use htex_host::*;
    pub use htex_model::shaped::{Curve, ShapedModel, ShapedVoice};
    pub use htex_model::{
        Error, FitInput, Model, MotionVoice, Numbers, StaticDescriptor, StaticField, StaticOption,
        Values, Voice, mix,
    };
}

/// Library files (`.htexlib`). One file can hold thousands of textures.
#[cfg(feature = "library")]
pub mod library {
    #[cfg(feature = "storage")]
    pub use htex_base::storage;
    pub use htex_format::library::*;
}
