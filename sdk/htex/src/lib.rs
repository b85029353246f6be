//! Opens and plays texture assets.
//!
//! ```no_run
//! use htex::{Texture, Motion, VoiceOptions};
//! let asset = Texture::open("sandpaper.htex")?;
//! let mut voice = asset.voice(&VoiceOptions::default())?;
//! let mut block = [0.0f32; 256];
//! voice.set_motion(Motion::new(80.0, 0.4))?; // mm/s, newtons
//! voice.render(&mut block)?; // in the asset's unit
//! # Ok::<(), htex::Error>(())
//! ```
//!
//! [`Voice::render`] does not allocate, lock or access files, so it may run in an audio thread.
//!
//! # Features
//! - `wasm` (default): runs models that are embedded in assets, in a sandbox. Without it the
//!   program is smaller and can only play representations of built-in models.
//! - `write` (default): `format::Asset::write` and `to_bytes`.
//! - `author`: `htex::author` reads recordings and makes assets, and `htex::simulate` simulates
//!   recordings.
//! - `library`: `htex::Library`, a file with thousands of textures. `Texture::from_library` opens one
//!   of them; `htex::library` has the full interface.
//! - `storage`: `htex::storage`, which opens files by path or URI, and `Library::open_located`. The
//!   feature `cloud` adds web servers and object stores.
//! - `scene`: `htex::scene`, which plans and renders scenes, and `htex::device`, the devices that
//!   play them.
#![warn(missing_docs)]
#![forbid(unsafe_code)]

#[cfg(feature = "author")]
pub use htex_author as author;
#[cfg(feature = "author")]
pub use htex_author::simulate;
#[cfg(feature = "storage")]
pub use htex_base::storage;
#[cfg(feature = "scene")]
pub use htex_device as device;
/// The container: its types, reading, writing and validation.
pub use htex_format as format;
/// Library files, which hold thousands of textures.
#[cfg(feature = "library")]
pub use htex_format::library;
#[cfg(feature = "library")]
pub use htex_format::library::Library;
/// The models: registry, loaders, calls.
pub use htex_host as host;
pub use htex_play::*;
#[cfg(feature = "scene")]
pub use htex_scene as scene;
