//! Opens and plays texture assets. Apps should depend on the crate `htex`, which re-exports this
//! crate. The other crates of the project, such as `htex-scene`, use this crate directly.
//!
//! ```no_run
//! use htex::{Motion, Texture, VoiceOptions};
//! let texture = Texture::open("sandpaper.htex")?;
//! let mut voice = texture.voice(&VoiceOptions::default())?;
//! let mut block = [0.0f32; 256];
//! voice.set_motion(Motion::new(80.0, 0.4))?; // mm/s, newtons
//! voice.render(&mut block)?; // in the asset's unit
//! # Ok::<(), htex::Error>(())
//! ```
//!
//! [`Voice::render`] allocates no memory, takes no locks and does not access files, so it may run
//! in an audio thread.
//!
//! The code of this crate is not part of `htex`, because `htex` re-exports `htex-scene`, and
//! `htex-scene` needs this code. If `htex` contained this code, `htex` and `htex-scene` would
//! depend on each other.
#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

#[cfg(feature = "bake")]
#[allow(missing_docs, reason = "fields and variants name what they hold")]
// Blocks are measured against the asset when they are made, so their last digits may differ.
#[allow(clippy::disallowed_methods)]
pub mod bake;
mod conditions;
pub mod envelope;
mod error;
pub mod exploration;
mod follow;
mod mesh;
mod motion;
mod options;
mod output;
mod parameter;
mod playable;
mod representation;
mod source;
mod spectrum;
mod texture;
mod travel;
mod voice;

pub use conditions::Conditions;
pub use envelope::Envelope;
pub use error::{Error, ErrorKind};
pub use exploration::{Coverage, Effects, Interval, Reach, RecordedRange, Scaling};
pub use htex_host::{Registry, Synthesis};
pub use mesh::{Mesh, Weights};
pub use motion::Motion;
pub use options::VoiceOptions;
pub use parameter::Parameter;
pub use playable::{field_order, model_of};
pub use representation::Representation;
pub use source::SampleSource;
pub use texture::Texture;
pub use voice::Voice;
