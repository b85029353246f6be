//! The texture model ABI: what every model exports, in the words of C, and the safe traits from
//! which Rust models get those exports.
//!
//! A *model* describes a magnitude spectrum by a few parameters. It is a pure thing with five
//! verbs: describe, fit, magnitude, interpolate, voice ([`Model`], [`Voice`]). Across the ABI
//! parameters travel as one flat array of `f64` laid out by the descriptor's fields: a scalar takes
//! one value, a list its length and then its values ([`Values`]). Spectra are *shapes*: of unit
//! RMS in the asset's band, so that a level in newtons can stand apart from them.
//!
//! A Rust author implements the traits and says [`export_model!`]; the macro makes the table of C
//! functions ([`abi::ModelTable`]) through which every host calls the model, built in or not.
#![cfg_attr(not(feature = "std"), no_std)]
extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

pub mod abi;
#[cfg(feature = "std")]
mod arguments;
mod descriptor;
mod error;
#[cfg(feature = "std")]
mod export;
mod id;
pub mod mix;
mod numbers;
#[cfg(feature = "std")]
pub mod shim;
mod traits;
mod values;
#[cfg(feature = "std")]
mod voices;
pub mod voices_1;

#[cfg(feature = "schemars")]
pub use descriptor::descriptor_schema;
pub use descriptor::{Descriptor, Field, FitOption, Kind, Store};
pub use error::{Error, Status};
pub use id::is_model_id;
pub use numbers::Numbers;
pub use traits::{Band, Fit, FitInput, Model, Voice};
pub use values::{Values, flatten};
