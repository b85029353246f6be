//! Presets: named groups of settings.

use serde::{Deserialize, Serialize};

use crate::{Averaging, Level, SegmentChoice};

/// A name for several settings. Settings that the user gives take precedence over the preset.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schemars", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Preset {
    /// The paper's choices (Balasubramanian & Vardar 2026) wherever they differ from htex's
    /// defaults: the paper's five models, sweeps, averaged magnitudes, and the options in
    /// [`Preset::options`].
    Paper,
}

impl Preset {
    /// All presets.
    pub const ALL: &[Self] = &[Self::Paper];

    /// Returns the name used in recipes and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Paper => "paper",
        }
    }

    /// Returns the short names of the models that the preset fits.
    pub const fn models(self) -> &'static [&'static str] {
        match self {
            Self::Paper => &["ar", "mfcc", "speak", "sbeta", "sslope"],
        }
    }

    /// Returns the options that differ from the models' defaults: model, option, value. Some values
    /// are assumptions, because the paper does not state them; `docs/paper.md` marks these values
    /// as "open".
    pub const fn options(self) -> &'static [(&'static str, &'static str, &'static str)] {
        match self {
            Self::Paper => &[
                ("speak", "frequency", "bin"),
                ("speak", "phase", "zero"),
                ("sbeta", "error", "magnitude"),
                ("sbeta", "lower_bound", "1"),
                ("sbeta", "bins", "0"),
                ("sbeta", "refit", "never"),
                ("sslope", "rounding_db_per_decade", "20"),
            ],
        }
    }

    /// Returns which segments of a recording are read.
    pub const fn segments(self) -> SegmentChoice {
        match self {
            Self::Paper => SegmentChoice::Sweeps,
        }
    }

    /// Returns where the level of each representation comes from.
    pub const fn level(self) -> Level {
        match self {
            Self::Paper => Level::Fitted,
        }
    }

    /// Returns whether models are fitted to the recorded conditions only, without computed extra
    /// conditions.
    pub const fn recorded_only(self) -> bool {
        match self {
            Self::Paper => true,
        }
    }

    /// Returns how segments are averaged.
    pub const fn averaging(self) -> Averaging {
        match self {
            Self::Paper => Averaging::Magnitude,
        }
    }
}
