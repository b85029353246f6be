//! Open a texture asset and play it.
//!
//! ```no_run
//! use htex::{Asset, Motion, VoiceOptions};
//! let asset = Asset::open("sandpaper.htex")?;
//! let mut voice = asset.voice(&VoiceOptions::default())?;
//! let mut block = [0.0f32; 256];
//! voice.set_motion(Motion::new(80.0, 0.4))?; // mm/s, newtons
//! voice.render(&mut block)?; // in the asset's unit
//! # Ok::<(), htex::Error>(())
//! ```
//!
//! [`Voice::render`] does not allocate, lock or touch files: it may run in an audio thread.
//!
//! # Features
//! - `wasm` (default): runs the models that assets bring along, in a sandbox. Without it the player is smaller, and an
//!   asset plays its representations of built-in models.
//! - `author`: reads recordings and makes assets of them, as `htex::author`.
//! - `scene`: plans and renders scenes, as `htex::scene`, for the devices of `htex::device`.
#![forbid(unsafe_code)]

#[cfg(feature = "author")]
pub use htex_author as author;
#[cfg(feature = "scene")]
pub use htex_device as device;
/// The container: its types, reading, writing, validation.
pub use htex_format as format;
/// The models: registry, loaders, calls.
pub use htex_host as host;
pub use htex_play::*;
#[cfg(feature = "scene")]
pub use htex_scene as scene;
