//! Settings with names. Each setting is defined once. The command's flags, the Python package's
//! keywords, recipes and the provenance all use this definition.
//!
//! Every setting is optional. The settings of one texture can therefore override common settings
//! ([`ReadingSettings::over`], [`FitSettings::over`], [`Metadata::over`]).

#[cfg(feature = "clap")]
mod choices;
mod fit;
mod fluctuation;
mod law;
mod metadata;
mod one_or_more;
mod preset;
mod reading;
mod setting;

pub use fit::{FitSettings, OptionSetting, named_models};
pub use fluctuation::GivenFluctuation;
pub use law::GivenLaw;
pub use metadata::Metadata;
pub use one_or_more::{OneOrMore, one_or_more};
pub use preset::Preset;
pub use reading::ReadingSettings;
