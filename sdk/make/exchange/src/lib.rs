//! Imports haptic files of other systems as assets, and exports assets to files that other devices
//! can play.
//!
//! [`FORMATS`] is the table of formats. Commands, help and documents use it. **Import.** If a file
//! contains units, speeds and forces, or if it contains an asset, [`import`] converts the file to
//! an asset. From all other files, [`import`] reads a signal and fits models to it. The user gives
//! the values that a file does not contain. **Export.** [`export`] plays an asset at a condition or
//! along a stroke, reduces the vibration to what an actuator can play (its [`Profile`]), and writes
//! the file. [`export`] then reads the file back, simulates how the actuator plays the file, and
//! compares the result with the asset's own samples.
//!
//! ```no_run
//! use htex_exchange::{Export, Format, export};
//! let asset = htex_play::Texture::open("sandpaper.htex")?;
//! if let Some(format) = Format::find("ahap") {
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
mod physical;
mod profile;
mod reduce;
mod rights;
mod settings;
mod stroke;
mod wav;
mod writers;

pub use ahap::Ahap;
pub use android::Android;
pub use curve::{Point, simplified, value_at};
pub use error::{ExchangeError, Fault, Missing};
pub use export::{ActuatorPlay, Export, ExportedFile, export, export_scene};
pub use format::{
    Format, Naming, RATE_HZ, ReadPositions, ReadSignal, Reads, Sampling, Signal, WriteSignal,
    Writes,
};
pub use formats::{FORMATS, exported, formats_table, imported, imported_signals};
pub use haptic::Haptic;
pub use heard::{Path, SceneSound};
pub use hjif::Hjif;
pub use import::{Import, ImportedAsset, fit_signals, import, recording_of};
pub use job::{Coding, Job, WrittenSignal};
pub use json::MOST_BYTES;
pub use loss::Loss;
pub use pattern::{MOST_S, Pattern, Transient, combined, rendered};
pub use physical::{Physical, missing};
pub use profile::{Kind, PROFILES, Profile, SourcedValue, profile_names, profiles_table};
pub use rights::RightsPlace;
pub use settings::SignalSettings;
pub use stroke::Stroke;
