//! Settings by name, each defined once: what the command's flags, the Python package's keywords and
//! recipes say, and what provenance keeps.
//!
//! Everything is optional, so that settings for many textures and those of one can be laid over
//! each other ([`ReadingSettings::over`], [`FitSettings::over`], [`Metadata::over`]).

#[cfg(feature = "clap")]
mod choices;
mod error;
mod fit;
mod law;
mod metadata;
mod one_or_more;
mod reading;
mod setting;

pub use error::SettingsError;
pub use fit::{FitSettings, OptionSetting, named_models};
pub use law::GivenLaw;
pub use metadata::Metadata;
pub use one_or_more::{OneOrMore, one_or_more};
pub use reading::ReadingSettings;
