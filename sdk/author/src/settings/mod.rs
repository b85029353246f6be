//! Settings by name: what the command's flags, the Python package's keywords and recipes say, as one set of types.
//!
//! Everything is optional, so that settings for many textures and those of one can be laid over each other
//! ([`ReadingSettings::over`], [`FitSettings::over`], [`Metadata::over`]).

mod error;
mod fit;
mod metadata;
mod reading;

pub use error::SettingsError;
pub use fit::{FitSettings, OptionSetting, named_models};
pub use metadata::Metadata;
pub use reading::ReadingSettings;
