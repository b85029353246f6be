//! Formats of neighbouring systems: what others have comes in, what people own can play it.
//!
//! [`FORMATS`] is the table of formats, of which commands, help and documents are made. **In.** [`import`] reads a file as an asset, if it states
//! units, speeds and forces or has an asset in it, else as a signal to which models are fitted, once it is told what the file does not say. **Out.** [`export`] plays an
//! asset at a condition or along a stroke, reduces it to what an actuator can do (its [`Profile`]), writes it, reads the file again, plays it
//! through the profile and compares that with the asset's own samples.
//!
//! ```no_run
//! use htex_exchange::{Export, Format, export};
//! let asset = htex_play::Asset::open("sandpaper.htex")?;
//! if let Some(format) = Format::named("ahap") {
//!     let exported = export(&asset, &Export::new(format))?;
//!     println!("{} bytes, loses {}", exported.bytes.len(), exported.loses);
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
mod format;
mod formats;
pub mod gltf;
pub mod haptic;
pub mod hatt;
mod heard;
pub mod hjif;
mod import;
mod job;
mod json;
mod loss;
pub mod map;
mod pattern;
mod profile;
mod reduce;
mod settings;
mod stroke;
mod wav;
mod writers;

pub use ahap::Ahap;
pub use android::Android;
pub use curve::{Point, simplified, value_at};
pub use error::{ExchangeError, Fault, Missing};
pub use export::{Export, Exported, Played, export, export_scene, profile_names};
pub use format::{
    Format, Held, Naming, ReadAsset, ReadPositions, ReadSignal, Reads, Sampling, Signal,
    WriteAsset, WriteSignal, Writes,
};
pub use formats::{FORMATS, exported, formats_table, imported, imported_signals};
pub use haptic::Haptic;
pub use heard::{Path, SceneSound};
pub use hjif::Hjif;
pub use import::{
    Import, ImportError, Imported, Physical, RATE_HZ, fit_signals, import, recording_of,
};
pub use job::{AssetJob, Coding, Job, Written};
pub use json::MOST_BYTES;
pub use loss::Loss;
pub use pattern::{MOST_S, Pattern, Transient, combined, rendered};
pub use profile::{Kind, PROFILES, Profile, Sourced, profiles_table};
pub use settings::SignalSettings;
pub use stroke::Stroke;
