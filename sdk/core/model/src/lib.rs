//! The texture model ABI: the traits that a model written in Rust implements, and the C functions
//! that every model exports.
//!
//! A *model* describes a magnitude spectrum by a few parameters. A model has five tasks. It states
//! its own descriptor, fits parameters to a spectrum, computes the spectrum of given parameters,
//! and interpolates parameters. It also makes voices, which render samples. In Rust, a model
//! implements the trait [`Model`], which covers these five tasks, and a voice implements the trait
//! [`Voice`].
//!
//! To write a model in Rust, implement both traits and call [`export_model!`]. The macro generates
//! the model's table of C functions ([`abi::ModelTable`]). Hosts call native libraries and built-in
//! models through this table. A WASM module exports the same functions.
//!
//! The ABI passes parameters as one flat array of `f64`, in the order of the descriptor's fields. A
//! scalar is one value; a list is its length followed by its values ([`Values`]). A model's spectra
//! are *shapes*: their RMS in the asset's band is 1. The asset stores the level of each spectrum
//! separately, in the unit of the asset's quantity.
#![warn(missing_docs)]
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![cfg_attr(not(feature = "std"), no_std)]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

pub mod abi;
#[cfg(any(test, all(target_family = "wasm", not(feature = "std"))))]
mod arena;
#[cfg(any(feature = "std", target_family = "wasm"))]
pub mod arguments;
#[cfg(not(any(feature = "std", target_family = "wasm")))]
mod bare;
mod decimal;
#[cfg(feature = "host")]
mod descriptor;
mod error;
mod exact;
#[cfg(any(feature = "std", target_family = "wasm"))]
mod export;
pub mod filtered;
pub mod json;
pub mod mix;
#[cfg(all(target_family = "wasm", not(feature = "std")))]
mod module;
mod motion;
pub mod motion_1;
mod numbers;
#[cfg(any(feature = "std", target_family = "wasm"))]
mod platform;
pub mod shaped;
#[cfg(any(feature = "std", target_family = "wasm"))]
pub mod shim;
mod static_descriptor;
mod store;
pub mod text;
mod traits;
mod usual;
mod values;
#[cfg(any(feature = "std", target_family = "wasm"))]
mod voices;
pub mod voices_1;

#[cfg(not(any(feature = "std", target_family = "wasm")))]
pub use bare::Lock;
#[cfg(feature = "schemars")]
pub use descriptor::descriptor_schema;
#[cfg(feature = "host")]
pub use descriptor::{Descriptor, Field, FitOption};
pub use error::{Error, Status};
pub use htex_dsp::Band;
pub use motion::{FitCondition, Motion, MotionVoice};
pub use numbers::Numbers;
#[cfg(any(feature = "std", target_family = "wasm"))]
pub use platform::Lock;
pub use static_descriptor::{StaticDescriptor, StaticField, StaticOption, is_model_id};
pub use store::{Kind, Store};
pub use traits::{Fit, FitInput, Model, Voice};
pub use usual::{Scale, UsualRange};
pub use values::{Fields, Range, Values, flatten};
