//! Settings by name, each defined once, for the command's flags, the Python package's keywords,
//! recipes, and provenance.
//!
//! Every setting is optional, so that the settings of one texture can be laid over the settings of
//! many ([`ReadingSettings::over`], [`FitSettings::over`], [`Metadata::over`]).

#[cfg(feature = "clap")]
mod choices;
mod fit;
mod law;
mod metadata;
mod one_or_more;
mod reading;
mod setting;

pub use fit::{FitSettings, OptionSetting, named_models};
pub use law::GivenLaw;
pub use metadata::Metadata;
pub use one_or_more::{OneOrMore, one_or_more};
pub use reading::ReadingSettings;
