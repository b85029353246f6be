//! Settings by name. Each is defined once, for the flags of the command, the keywords of the Python
//! package, recipes, and provenance.
//!
//! Every setting is optional, so that the settings of one texture can override the settings of many
//! ([`ReadingSettings::over`], [`FitSettings::over`], [`Metadata::over`]).

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
