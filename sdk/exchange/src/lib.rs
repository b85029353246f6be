//! Formats of neighbouring systems: what others have comes in, what people own can play it.
//!
//! **In.** [`recording_of`] reads a file of Meta, Apple or MPEG as a recording, once it is told what the format does not say; the author SDK fits it.
//! **Out.** [`export`] plays an asset at a condition or along a stroke, reduces it to what an actuator can do (its [`Profile`]), writes it, reads the
//! file again, plays it through the profile and compares that with the asset's own samples. [`FORMATS`] is the table of formats, of which commands, help
//! and documents are made.
//!
//! ```no_run
//! use htex_exchange::{Export, Format, export};
//! let asset = htex_play::Asset::open("sandpaper.htex")?;
//! if let Some(format) = Format::named("ahap") {
//!     let exported = export(&asset, &Export::new(format))?;
//!     println!("{} bytes, felt difference {} dB", exported.bytes.len(), exported.lost.difference.felt.error.error_rms_db);
//! }
//! # Ok::<(), htex_exchange::ExchangeError>(())
//! ```
#![cfg_attr(not(test), warn(clippy::disallowed_methods))]
#![forbid(unsafe_code)]

pub mod ahap;
pub mod android;
mod curve;
mod error;
mod export;
mod formats;
pub mod haptic;
pub mod hatt;
mod heard;
pub mod hjif;
mod import;
mod json;
mod loss;
mod pattern;
mod profile;
mod reduce;
mod stroke;
mod wav;
mod writers;

pub use ahap::Ahap;
pub use android::Android;
pub use curve::{Point, simplified, value_at};
pub use error::{ExchangeError, Fault, Missing};
pub use export::{Coding, Export, Exported, Job, Written, export, profile_names};
pub use formats::{
    Context, FORMATS, Format, Reads, Signal, Writes, exported, formats_table, imported,
    profiles_table,
};
pub use haptic::Haptic;
pub use heard::Path;
pub use hjif::Hjif;
pub use import::{Fitting, ImportError, Physical, RATE_HZ, imported_asset, recording_of};
pub use json::MOST_BYTES;
pub use loss::Loss;
pub use pattern::{MOST_S, Pattern, Transient, combined, rendered};
pub use profile::{Kind, PROFILES, Profile, Sourced};
pub use stroke::Stroke;
